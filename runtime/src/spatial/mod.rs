//! Spatial algebra: poses, twists, wrenches and inertias.
//!
//! A twist `T = (ω; v)` and a wrench `W = (moment; force)` are 6-vectors, angular part first; their power is `Wᵀ T`. A
//! pose takes child coordinates to parent coordinates. SI units, radians.

mod articulated;
mod check;
pub mod fused;
mod inertia;
mod mass;
mod parameters;
mod pose;
pub mod se3;
pub mod so3;
mod symmetric;
mod twist;

pub use articulated::{ArticulatedInertia, add_weighted, shift_twist, shift_wrench};
pub use check::{PoseError, ROTATION_TOLERANCE};
pub use inertia::SpatialInertia;
pub use mass::{MassError, MassProperties};
pub use parameters::{
    INERTIAL_PARAMETER_NAMES, INERTIAL_PARAMETER_UNITS, INERTIAL_PARAMETERS, body_regressor,
    energy_row,
};
pub use pose::Pose;
pub use so3::nearest as nearest_rotation;
pub use symmetric::Symmetric3;
pub use twist::{bracket, bracket_dual_product, bracket_product, join, split, turn_back, turn_out};

use crate::scalar::Scalar;
use nalgebra::{Matrix3, Vector3};

/// Cross-product matrix: `hat(a) b = a × b`.
pub fn hat<T: Scalar>(a: &Vector3<T>) -> Matrix3<T> {
    let zero = T::zero();
    Matrix3::new(zero, -a.z, a.y, a.z, zero, -a.x, -a.y, a.x, zero)
}

/// Inverse of [`hat`], applied to the skew part of `matrix`.
pub fn vee<T: Scalar>(matrix: &Matrix3<T>) -> Vector3<T> {
    let half = T::from_f64(0.5);
    Vector3::new(
        (matrix[(2, 1)] - matrix[(1, 2)]) * half,
        (matrix[(0, 2)] - matrix[(2, 0)]) * half,
        (matrix[(1, 0)] - matrix[(0, 1)]) * half,
    )
}
