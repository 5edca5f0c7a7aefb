//! The picture as SVG.

use super::Instant;
use super::colors::{Color, named, written};
use super::order::ordered;
use super::scenery::Scenery;
use super::solid::Solid;
use super::view::{Ball, View, across};
use nalgebra::{Vector2, Vector3};
use std::fmt::Write;

/// By which a picture is known.
pub const FIRST_LINE: &str = "<!-- hamel simulate, picture -->";

/// Size of the picture, and of the unit of its coordinates, pixels.
const SIZE: (f64, f64) = (960.0, 640.0);
const UNIT: f64 = 0.1;

/// Squares of the grid from its middle to its end.
const REACH: i32 = 16;

/// What is drawn, and from where.
struct Canvas {
    view: View,
    up: Vector3<f64>,
    /// Of the mechanism at the last instant.
    size: f64,
    text: String,
}

/// The picture of all `instants`, of which the last is shown in full, and those before it paler.
pub fn picture(name: &str, scenery: &Scenery, instants: &[Instant]) -> String {
    let balls: Vec<Ball> = instants
        .iter()
        .flat_map(|instant| scenery.balls(instant))
        .collect();
    let up = scenery.up;
    let mut canvas = Canvas {
        view: View::on(&balls, &up, SIZE.0 / SIZE.1),
        size: instants
            .last()
            .map_or(1.0, |last| radius(&scenery.balls(last))),
        up,
        text: String::new(),
    };
    canvas.head(name);
    let ground = ground(&balls, &up, canvas.size);
    if let Some(ground) = ground {
        canvas.grid(ground);
    }
    let Some((last, earlier)) = instants.split_last() else {
        canvas.text.push_str("</svg>\n");
        return canvas.text;
    };
    let solids = scenery.solids(last, canvas.size, true);
    if let Some(ground) = ground {
        canvas.shadow(&solids, ground);
    }
    for (index, instant) in earlier.iter().enumerate() {
        let part = (index + 1) as f64 / (earlier.len() + 1) as f64;
        canvas.ghost(
            &scenery.solids(instant, canvas.size, false),
            0.12 + 0.3 * part,
        );
    }
    canvas.solids(solids);
    canvas.text.push_str("</svg>\n");
    canvas.text
}

/// Radius of a ball about the middle of balls.
fn radius(balls: &[Ball]) -> f64 {
    let middle = balls.iter().map(|ball| ball.0).sum::<Vector3<f64>>() / balls.len() as f64;
    let reach = balls
        .iter()
        .map(|(place, radius)| (place - middle).norm() + radius);
    reach.fold(1e-9, f64::max)
}

/// Height of the ground as on the page: that of the origin, or below everything; none where that is far below.
fn ground(balls: &[Ball], up: &Vector3<f64>, size: f64) -> Option<f64> {
    let heights = balls.iter().map(|(place, radius)| up.dot(place) - radius);
    let lowest = heights.fold(f64::INFINITY, f64::min);
    let ground = if lowest < -0.02 * size { lowest } else { 0.0 };
    (lowest - ground <= 6.0 * size).then_some(ground)
}

impl Canvas {
    fn head(&mut self, name: &str) {
        let (width, height) = SIZE;
        let (wide, high) = (width / UNIT, height / UNIT);
        let name = name.replace('&', "&amp;").replace('<', "&lt;");
        let sky = written(named("sky"));
        self.text = format!(
            "{FIRST_LINE}\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {wide} {high}\" stroke-linejoin=\"round\">\n\
             <title>{name}</title>\n<rect width=\"{wide}\" height=\"{high}\" fill=\"{sky}\"/>\n"
        );
    }

    /// Where a point is drawn, in units.
    fn at(&self, place: &Vector3<f64>) -> Vector2<f64> {
        let seen = self.view.seen(place) * (SIZE.1 / 2.0);
        let middle = Vector2::new(SIZE.0 / 2.0, SIZE.1 / 2.0);
        ((middle + Vector2::new(seen.x, -seen.y)) / UNIT).map(f64::round)
    }

    /// A closed path of points; none where they fall together.
    fn closed(&self, corners: impl IntoIterator<Item = Vector2<f64>>) -> Option<String> {
        let mut points: Vec<Vector2<f64>> = corners.into_iter().collect();
        points.dedup();
        if points.len() < 3 {
            return None;
        }
        let mut path = format!("M{} {}", points[0].x, points[0].y);
        for pair in points.windows(2) {
            let step = pair[1] - pair[0];
            let _ = write!(
                path,
                "{}{} {}",
                if pair[0] == points[0] { "l" } else { " " },
                step.x,
                step.y
            );
        }
        path.push('z');
        Some(path)
    }

    /// The faces of solids that look to the eye.
    fn solids(&mut self, solids: Vec<Solid>) {
        let (eye, light) = (self.view.eye, self.view.light(&self.up));
        // Strokes close the seams between faces.
        self.text.push_str("<g stroke-width=\"6\">\n");
        for solid in ordered(solids, &eye, self.size) {
            let mut last = None;
            for face in &solid.faces {
                if face.normal.dot(&(eye - face.corners[0])) <= 0.0 {
                    continue;
                }
                let lit = 0.68
                    + 0.14 * face.normal.dot(&self.up)
                    + 0.34 * face.normal.dot(&light).max(0.0);
                let color = written(face.color.map(|part| part * lit));
                let Some(path) = self.closed(face.corners.iter().map(|corner| self.at(corner)))
                else {
                    continue;
                };
                // Faces of one colour are one path.
                if last.as_ref() == Some(&color) {
                    self.text.push_str(&path);
                    continue;
                }
                self.end_path(last.is_some());
                let _ = write!(
                    self.text,
                    "<path fill=\"{color}\" stroke=\"{color}\" d=\"{path}"
                );
                last = Some(color);
            }
            self.end_path(last.is_some());
        }
        self.text.push_str("</g>\n");
    }

    fn end_path(&mut self, is_open: bool) {
        if is_open {
            self.text.push_str("\"/>\n");
        }
    }

    /// The outlines of solids at an earlier instant, the nearest last.
    fn ghost(&mut self, solids: &[Solid], opacity: f64) {
        let mut outlines: Vec<(f64, String)> = vec![];
        for solid in solids {
            let outline = hull(solid.corners().map(|corner| self.at(corner)).collect());
            let Some(path) = self.closed(outline) else {
                continue;
            };
            let color: Color = solid.faces[0].color;
            let (fill, edge) = (written(color), written(color.map(|part| 0.7 * part)));
            let depth = self.view.depth(&solid.centre());
            outlines.push((
                depth,
                format!("<path fill=\"{fill}\" stroke=\"{edge}\" d=\"{path}\"/>\n"),
            ));
        }
        outlines.sort_by(|a, b| b.0.total_cmp(&a.0));
        let _ = writeln!(self.text, "<g stroke-width=\"6\" opacity=\"{opacity:.2}\">");
        self.text.extend(outlines.into_iter().map(|(_, path)| path));
        self.text.push_str("</g>\n");
    }

    /// The shadow of solids on the ground.
    fn shadow(&mut self, solids: &[Solid], ground: f64) {
        let light = self.view.light(&self.up);
        let _ = writeln!(self.text, "<g opacity=\"0.16\">");
        for solid in solids {
            let corners = solid.corners().map(|corner| {
                let height = (self.up.dot(corner) - ground).max(0.0);
                self.at(&(corner - light * (height / light.dot(&self.up))))
            });
            if let Some(path) = self.closed(hull(corners.collect())) {
                let _ = writeln!(self.text, "<path d=\"{path}\"/>");
            }
        }
        self.text.push_str("</g>\n");
    }

    /// Squares on the ground, 1, 2 or 5 times a power of ten wide, paler towards their end.
    fn grid(&mut self, ground: f64) {
        let wide = 0.12 * self.view.distance();
        let power = 10.0_f64.powf(wide.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
        let step = step.into_iter().find(|step| *step >= wide).unwrap_or(wide);
        let front = across(&self.up);
        let left = self.up.cross(&front);
        let axes = [front, left];
        let middle = axes.map(|axis| (self.view.target.dot(&axis) / step).round());
        let grid = written(named("grid"));
        let _ = writeln!(
            self.text,
            "<g stroke=\"{grid}\" stroke-width=\"9\" opacity=\"0.75\">"
        );
        for reach in [1.0, 0.75, 0.5] {
            let mut path = String::new();
            for line in -REACH..=REACH {
                let across = f64::from(line);
                let half = (f64::from(REACH) * reach).powi(2) - across * across;
                if half <= 0.0 {
                    continue;
                }
                for axis in 0..2 {
                    let end = |along: f64| {
                        let mut at = [middle[0], middle[1]];
                        at[axis] += along;
                        at[1 - axis] += across;
                        (axes[0] * at[0] + axes[1] * at[1]) * step + self.up * ground
                    };
                    self.segment(&mut path, end(-half.sqrt()), end(half.sqrt()));
                }
            }
            let _ = writeln!(self.text, "<path opacity=\"0.4\" d=\"{path}\"/>");
        }
        self.text.push_str("</g>\n");
    }

    /// The part of a segment that is before the eye.
    fn segment(&self, path: &mut String, mut a: Vector3<f64>, mut b: Vector3<f64>) {
        let near = 0.1 * self.view.distance();
        let depths = (self.view.depth(&a), self.view.depth(&b));
        if depths.0 < near && depths.1 < near {
            return;
        }
        let cut = a + (b - a) * ((near - depths.0) / (depths.1 - depths.0));
        if depths.0 < near {
            a = cut;
        } else if depths.1 < near {
            b = cut;
        }
        let (a, b) = (self.at(&a), self.at(&b));
        let _ = write!(path, "M{} {}L{} {}", a.x, a.y, b.x, b.y);
    }
}

/// The convex hull of points, in the order around it.
fn hull(mut points: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let half = |points: &mut dyn Iterator<Item = Vector2<f64>>| {
        let mut chain: Vec<Vector2<f64>> = vec![];
        for point in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp(&(point - a)) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut points.iter().copied());
    hull.extend(half(&mut points.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use super::hull;
    use nalgebra::Vector2;

    #[test]
    fn a_hull_leaves_out_what_is_inside() {
        let at = |x: f64, y: f64| Vector2::new(x, y);
        let points = vec![
            at(0.0, 0.0),
            at(2.0, 0.0),
            at(1.0, 1.0),
            at(2.0, 2.0),
            at(0.0, 2.0),
            at(1.0, 0.0),
        ];
        assert_eq!(
            hull(points),
            [at(0.0, 0.0), at(2.0, 0.0), at(2.0, 2.0), at(0.0, 2.0)]
        );
    }
}
