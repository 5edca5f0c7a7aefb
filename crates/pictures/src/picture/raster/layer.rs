//! Flat faces drawn into pixels, where nothing nearer is.

use std::ops::Range;

/// A picture has so many pixels fewer across, and so many fewer down; each is the mean of those here.
pub const FINE: u16 = 2;

/// A corner: pixels from the left and from the top, and the reciprocal of its distance before the eye.
pub type Corner = [f64; 3];

/// Red, green and blue.
pub type Rgb = [u8; 3];

/// Pixels, with the distance of what each shows.
#[derive(Clone, Debug)]
pub struct Layer {
    width: usize,
    height: usize,
    colors: Vec<Rgb>,
    /// Reciprocals of distances, 0 where nothing is.
    nearness: Vec<f32>,
    /// Rows and columns outside of which nothing is.
    drawn: [Range<usize>; 2],
}

impl Layer {
    /// A layer for a picture of that size, of one colour, in which nothing is.
    pub fn new((width, height): (u16, u16), color: Rgb) -> Self {
        let [width, height] = [width, height].map(|length| usize::from(length) * usize::from(FINE));
        Self {
            width,
            height,
            colors: vec![color; width * height],
            nearness: vec![0.0; width * height],
            drawn: [0..0, 0..0],
        }
    }

    /// Draws a convex face.
    pub fn face(&mut self, corners: &[Corner], color: Rgb) {
        let Some((first, rest)) = corners.split_first() else {
            return;
        };
        for pair in rest.windows(2) {
            self.triangle([*first, pair[0], pair[1]], color);
        }
    }

    fn triangle(&mut self, corners: [Corner; 3], color: Rgb) {
        let [a, b, c] = corners;
        let area = cross(&a, &b, [c[0], c[1]]);
        if area.is_nan() || area.abs() < 1e-9 {
            return;
        }
        let share = 1.0 / area;
        let (columns, rows) = (
            pixels(corners.map(|corner| corner[0]), self.width),
            pixels(corners.map(|corner| corner[1]), self.height),
        );
        self.drawn = [
            union(&self.drawn[0], &rows),
            union(&self.drawn[1], &columns),
        ];
        for row in rows {
            for column in columns.clone() {
                let at = [column as f64 + 0.5, row as f64 + 0.5];
                // Most pixels are outside, and often one edge tells so. Those on an edge belong to the faces on both sides, so that no seam is left.
                let of_a = cross(&b, &c, at) * share;
                if of_a < 0.0 {
                    continue;
                }
                let of_b = cross(&c, &a, at) * share;
                if of_b < 0.0 {
                    continue;
                }
                let of_c = cross(&a, &b, at) * share;
                if of_c < 0.0 {
                    continue;
                }
                let nearness = of_a * a[2] + of_b * b[2] + of_c * c[2];
                let place = row * self.width + column;
                if nearness as f32 > self.nearness[place] {
                    self.nearness[place] = nearness as f32;
                    self.colors[place] = color;
                }
            }
        }
    }

    /// Draws what another layer of this size shows over this one, which does not become nearer by that.
    pub fn cover(&mut self, other: &Self, opacity: f64) {
        let [rows, columns] = &other.drawn;
        for row in rows.clone() {
            let places = row * self.width + columns.start..row * self.width + columns.end;
            let shown = other.colors[places.clone()]
                .iter()
                .zip(&other.nearness[places.clone()]);
            for (own, (color, nearness)) in self.colors[places].iter_mut().zip(shown) {
                if *nearness > 0.0 {
                    *own = mixed(*own, *color, opacity);
                }
            }
        }
    }

    /// The pixels of the picture, row by row.
    pub fn reduced(&self) -> Vec<Rgb> {
        let fine = usize::from(FINE);
        let (width, height) = (self.width / fine, self.height / fine);
        let mut reduced = Vec::with_capacity(width * height);
        for row in 0..height {
            for column in 0..width {
                let mut sum = [0_usize; 3];
                for y in 0..fine {
                    let first = (row * fine + y) * self.width + column * fine;
                    for color in &self.colors[first..first + fine] {
                        sum = std::array::from_fn(|part| sum[part] + usize::from(color[part]));
                    }
                }
                let count = fine * fine;
                reduced.push(sum.map(|sum| ((sum + count / 2) / count) as u8));
            }
        }
        reduced
    }
}

/// A colour with another one over it.
fn mixed(under: Rgb, over: Rgb, opacity: f64) -> Rgb {
    std::array::from_fn(|part| {
        let (under, over) = (f64::from(under[part]), f64::from(over[part]));
        (under + opacity * (over - under)).round() as u8
    })
}

/// From the least to the greatest of two ranges.
fn union(a: &Range<usize>, b: &Range<usize>) -> Range<usize> {
    match (a.is_empty(), b.is_empty()) {
        (true, _) => b.clone(),
        (false, true) => a.clone(),
        (false, false) => a.start.min(b.start)..a.end.max(b.end),
    }
}

/// Twice the area of a triangle, positive where its corners go from the first axis to the second.
fn cross(a: &Corner, b: &Corner, c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The pixels whose middles are between the least and the greatest of three coordinates, of so many.
fn pixels(at: [f64; 3], count: usize) -> Range<usize> {
    let least = at.into_iter().fold(f64::INFINITY, f64::min);
    let greatest = at.into_iter().fold(f64::NEG_INFINITY, f64::max);
    // Beyond the picture, `as` gives its ends.
    let (first, end) = ((least - 0.5).ceil(), (greatest - 0.5).floor() + 1.0);
    (first as usize).min(count)..(end as usize).min(count)
}

#[cfg(test)]
mod tests {
    use super::Layer;

    const RED: [u8; 3] = [255, 0, 0];
    const BLUE: [u8; 3] = [0, 0, 255];
    const WHITE: [u8; 3] = [255; 3];

    /// A square from one corner of a picture of ten by ten to its middle, and farther.
    fn square(end: f64, nearness: f64) -> [[f64; 3]; 4] {
        [[0.0, 0.0], [end, 0.0], [end, end], [0.0, end]].map(|[x, y]| [x, y, nearness])
    }

    #[test]
    fn what_is_nearer_hides_what_is_farther_in_any_order() {
        for order in [[0, 1], [1, 0]] {
            let mut layer = Layer::new((10, 10), WHITE);
            let faces = [(square(10.0, 1.0), BLUE), (square(20.0, 0.5), RED)];
            for index in order {
                layer.face(&faces[index].0, faces[index].1);
            }
            let pixels = layer.reduced();
            let count = |color| pixels.iter().filter(|pixel| **pixel == color).count();
            assert_eq!((count(BLUE), count(RED), count(WHITE)), (25, 75, 0));
        }
    }

    #[test]
    fn planes_that_go_through_each_other_are_cut() {
        let mut layer = Layer::new((10, 10), WHITE);
        layer.face(&square(20.0, 0.5), RED);
        let tilted = [
            [0.0, 0.0, 0.2],
            [20.0, 0.0, 0.8],
            [20.0, 20.0, 0.8],
            [0.0, 20.0, 0.2],
        ];
        layer.face(&tilted, BLUE);
        let pixels = layer.reduced();
        assert!(pixels[..5].iter().all(|pixel| *pixel == RED));
        assert!(pixels[5..10].iter().all(|pixel| *pixel == BLUE));
    }

    #[test]
    fn edges_are_smooth_and_what_is_beyond_the_picture_is_left_out() {
        let mut layer = Layer::new((10, 10), WHITE);
        layer.face(&square(11.0, 1.0), BLUE);
        assert_eq!(layer.reduced()[5], [128, 128, 255]);
        let mut far = Layer::new((10, 10), WHITE);
        far.face(&square(1e6, 1.0), BLUE);
        far.face(&square(f64::NAN, 2.0), RED);
        far.face(
            &[[-9.0, -9.0, 1.0], [-1.0, -9.0, 1.0], [-1.0, -1.0, 1.0]],
            RED,
        );
        assert!(far.reduced().iter().all(|pixel| *pixel == BLUE));
    }

    #[test]
    fn a_layer_covers_in_part_what_is_under_it() {
        let mut layer = Layer::new((10, 10), WHITE);
        let mut over = Layer::new((10, 10), RED);
        over.face(&square(10.0, 1.0), BLUE);
        layer.cover(&over, 0.2);
        let pixels = layer.reduced();
        assert_eq!((pixels[0], pixels[9]), ([204, 204, 255], WHITE));
    }
}
