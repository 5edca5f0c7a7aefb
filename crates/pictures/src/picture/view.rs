//! The first view of the page: where the eye is, and where points are seen.

use nalgebra::{Vector2, Vector3};

/// Angle from the top to the bottom of the picture, direction and height of the view: those of `camera.js`.
const ANGLE: f64 = 35.0;
const AZIMUTH: f64 = 0.9;
const ELEVATION: f64 = 0.35;

/// Part of the picture that is filled.
const FILLED: f64 = 0.92;

/// A ball that is to be seen: its centre and its radius.
pub type Ball = (Vector3<f64>, f64);

/// A view along −`back`.
#[derive(Clone, Debug)]
pub struct View {
    pub eye: Vector3<f64>,
    pub back: Vector3<f64>,
    right: Vector3<f64>,
    up: Vector3<f64>,
    /// Middle of what is seen.
    pub target: Vector3<f64>,
    /// Tangent of half the angle of view.
    half: f64,
}

/// A direction across `a`, level where `a` is upright.
pub fn across(a: &Vector3<f64>) -> Vector3<f64> {
    let other = match a.x.abs() < 0.8 * a.norm() {
        true => Vector3::x(),
        false => Vector3::y(),
    };
    a.cross(&other).normalize()
}

impl View {
    /// All of `balls`, as large as they can be, in a picture so many times wider than high; `upwards` is up in the world.
    pub fn on(balls: &[Ball], upwards: &Vector3<f64>, aspect: f64) -> Self {
        let front = across(upwards);
        let left = upwards.cross(&front);
        let level = front * AZIMUTH.sin() - left * AZIMUTH.cos();
        let back = level * ELEVATION.cos() + upwards * ELEVATION.sin();
        let right = upwards.cross(&level).normalize();
        let up = back.cross(&right);
        let half = (ANGLE.to_radians() / 2.0).tan();
        // The eye is behind four planes that touch the balls.
        let most = |slope: f64, along: Vector3<f64>| {
            let reach = balls.iter().map(|(place, radius)| {
                along.dot(place) + slope * back.dot(place) + radius * slope.hypot(1.0)
            });
            reach.fold(f64::NEG_INFINITY, f64::max)
        };
        let (wide, high) = (FILLED * half * aspect, FILLED * half);
        let (east, west) = (most(wide, right), most(wide, -right));
        let (north, south) = (most(high, up), most(high, -up));
        let z = ((east + west) / (2.0 * wide)).max((north + south) / (2.0 * high));
        let depths = balls.iter().flat_map(|(place, radius)| {
            let depth = back.dot(place);
            [depth - radius, depth + radius]
        });
        let (least, greatest) = depths.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), depth| {
            (a.min(depth), b.max(depth))
        });
        let middle = (least + greatest) / 2.0;
        let target = right * ((east - west) / 2.0) + up * ((north - south) / 2.0) + back * middle;
        let distance = (z - middle).max(1e-9);
        Self {
            eye: target + back * distance,
            back,
            right,
            up,
            target,
            half,
        }
    }

    /// Distance of the eye from the middle of what is seen.
    pub fn distance(&self) -> f64 {
        (self.eye - self.target).norm()
    }

    /// How far before the eye a point is.
    pub fn depth(&self, place: &Vector3<f64>) -> f64 {
        self.back.dot(&(self.eye - place))
    }

    /// Rightwards and upwards from the middle, in halves of the picture's height.
    pub fn seen(&self, place: &Vector3<f64>) -> Vector2<f64> {
        let from = place - self.eye;
        let scale = 1.0 / (self.depth(place) * self.half);
        Vector2::new(self.right.dot(&from) * scale, self.up.dot(&from) * scale)
    }

    /// What is nearer than this is not drawn, m.
    pub fn near(&self) -> f64 {
        0.1 * self.distance()
    }

    /// Rightwards and downwards from the corner of a picture of that width and height, pixels.
    pub fn pixel(&self, place: &Vector3<f64>, (width, height): (u16, u16)) -> Vector2<f64> {
        let (width, height) = (f64::from(width), f64::from(height));
        let seen = self.seen(place) * (height / 2.0);
        Vector2::new(width / 2.0, height / 2.0) + Vector2::new(seen.x, -seen.y)
    }

    /// Direction to the light: above the viewer's left shoulder.
    pub fn light(&self, upwards: &Vector3<f64>) -> Vector3<f64> {
        let level = (self.back - upwards * self.back.dot(upwards)).normalize();
        (upwards * 1.1 + level * 0.55 - self.right * 0.5).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::View;
    use nalgebra::Vector3;

    #[test]
    fn what_is_to_be_seen_fills_the_picture() {
        let balls = [
            (Vector3::new(3.0, 1.0, 0.0), 0.0),
            (Vector3::new(-2.0, 0.5, 4.0), 0.0),
            (Vector3::new(0.0, -5.0, 1.0), 0.0),
        ];
        let view = View::on(&balls, &Vector3::z(), 1.6);
        let seen = balls.map(|(place, _)| view.seen(&place));
        let parts = seen.iter().flat_map(|at| [at.x.abs() / 1.6, at.y.abs()]);
        let largest = parts.fold(0.0, f64::max);
        assert!((largest - 0.92).abs() < 1e-9, "{seen:?}");
    }
}
