//! The largest error that a law has met, and distances between states of a mechanism.

use hamel::mechanism::Kinematics;
use hamel::nalgebra::{Matrix3, Vector3};
use hamel::spatial::so3;

/// The largest error of one law over many cases.
#[derive(Clone, Debug)]
pub struct Largest {
    law: &'static str,
    error: f64,
    place: String,
    count: usize,
}

impl Largest {
    /// Nothing met yet.
    pub const fn new(law: &'static str) -> Self {
        Self {
            law,
            error: 0.0,
            place: String::new(),
            count: 0,
        }
    }

    /// Takes the error met at `place`.
    ///
    /// # Panics
    /// Where it is NaN: that is no error of any size.
    pub fn meet(&mut self, error: f64, place: impl ToString) {
        assert!(
            !error.is_nan(),
            "{}: the error at {} is NaN",
            self.law,
            place.to_string()
        );
        self.count += 1;
        if error >= self.error {
            self.error = error;
            self.place = place.to_string();
        }
    }

    /// Says the figure, and holds it to its bound.
    ///
    /// # Panics
    /// Where it exceeds the bound, and where no case has been met.
    pub fn assert_within(&self, bound: f64) {
        let Self {
            law,
            error,
            place,
            count,
        } = self;
        println!("{law}: {error:.1e} at {place}, of {count} cases");
        assert!(*count > 0, "{law}: no case");
        assert!(
            *error <= bound,
            "{law}: error {error:e} at {place} exceeds {bound:e}"
        );
    }
}

/// Largest absolute difference of two vectors of one size.
///
/// # Panics
/// Where the sizes differ.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len(), "vectors of different sizes");
    // Not f64::max, which would drop a NaN.
    let larger = |m: f64, x: f64| if x <= m { m } else { x };
    a.iter()
        .zip(b)
        .map(|(x, y)| (x - y).abs())
        .fold(0.0, larger)
}

/// Largest absolute entry.
pub fn size(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// Angle of `AᵀB`, rad.
pub fn attitude_error(a: &Matrix3<f64>, b: &Matrix3<f64>) -> f64 {
    so3::log(&a.tr_mul(b)).norm()
}

/// Distance of two vectors relative to max(1, |expected|).
pub fn vector_error(found: &Vector3<f64>, expected: &Vector3<f64>) -> f64 {
    (found - expected).norm() / expected.norm().max(1.0)
}

/// How far two states of one mechanism are apart: the largest over bodies of attitude (rad), position and velocity of the
/// centre of mass and angular velocity, each relative to max(1, size).
pub fn state_distance(a: &Kinematics, b: &Kinematics) -> f64 {
    let bodies = a.bodies.iter().zip(&b.bodies).flat_map(|(a, b)| {
        [
            attitude_error(&b.pose.rotation, &a.pose.rotation),
            vector_error(&a.position_com, &b.position_com),
            vector_error(&a.velocity_com, &b.velocity_com),
            vector_error(&a.angular_velocity_body(), &b.angular_velocity_body()),
        ]
    });
    bodies.fold(0.0, |m, x| if x <= m { m } else { x })
}
