//! Rigid displacements: exponential and logarithm of a twist.

use super::{Pose, join, so3, split};
use crate::scalar::Scalar;
use nalgebra::Vector6;

/// `exp` of a twist (r; u): rotation `exp(r~)`, translation `J(r) u` with the left differential of [`so3`].
pub fn exp<T: Scalar>(twist: &Vector6<T>) -> Pose<T> {
    let (angular, linear) = split(twist);
    Pose::new(so3::exp(&angular), so3::left_jacobian(&angular) * linear)
}

/// The twist (r; u) with `exp(r; u) = pose` and |r| ≤ π.
pub fn log<T: Scalar>(pose: &Pose<T>) -> Vector6<T> {
    let angular = so3::log(&pose.rotation);
    join(
        &angular,
        &(so3::left_jacobian_inverse(&angular) * pose.translation),
    )
}
