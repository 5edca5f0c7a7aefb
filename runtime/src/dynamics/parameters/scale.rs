//! Units of length of the size of a mechanism: so that mass, first moments and moments of inertia are numbers of one size.

use crate::mechanism::Mechanism;
use crate::spatial::{INERTIAL_PARAMETERS, Pose};
use nalgebra::Vector6;
use num_traits::Float;

/// A unit of length, m: a power of two.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale(f64);

impl Scale {
    /// That of the longest distance between frames on one body.
    pub(super) fn of(mechanism: &Mechanism) -> Self {
        let bodies = mechanism.bodies().iter();
        let lengths = bodies.map(|body| {
            let own = body.child_placement().translation.norm();
            let placed = match body.parent() {
                Some(_) => body.placement().translation.norm(),
                None => 0.0,
            };
            own.max(placed)
        });
        let longest = lengths.fold(0.0, f64::max);
        match longest > 0.0 {
            true => Self(Float::exp2(Float::round(Float::log2(longest)))),
            false => Self(1.0),
        }
    }

    pub(super) fn pose(&self, pose: &Pose<f64>) -> Pose<f64> {
        Pose::new(pose.rotation, pose.translation / self.0)
    }

    pub(super) fn twist(&self, twist: &Vector6<f64>) -> Vector6<f64> {
        let mut scaled = *twist;
        for entry in scaled.iter_mut().skip(3) {
            *entry /= self.0;
        }
        scaled
    }

    /// What one unit of a parameter is in SI units: kg, kg m or kg m².
    pub(super) fn unit(&self, parameter: usize) -> f64 {
        match parameter % INERTIAL_PARAMETERS {
            0 => 1.0,
            1..4 => self.0,
            _ => self.0 * self.0,
        }
    }
}
