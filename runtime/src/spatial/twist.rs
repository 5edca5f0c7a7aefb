//! Twists and wrenches as 6-vectors: parts and brackets.

use super::fused::{add_cross, apply, apply_transposed, cross};
use super::hat;
use crate::scalar::Scalar;
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

/// Angular and linear part of a twist, or moment and force of a wrench.
#[inline(always)]
pub fn split<T: Scalar>(vector: &Vector6<T>) -> (Vector3<T>, Vector3<T>) {
    let [a, b, c, d, e, f] = vector.data.0[0];
    (Vector3::new(a, b, c), Vector3::new(d, e, f))
}

/// The 6-vector of an angular and a linear part.
#[inline(always)]
pub fn join<T: Scalar>(angular: &Vector3<T>, linear: &Vector3<T>) -> Vector6<T> {
    let ([[a, b, c]], [[d, e, f]]) = (angular.data.0, linear.data.0);
    Vector6::new(a, b, c, d, e, f)
}

/// A twist, wrench or momentum in a frame's axes, in those of which `rotation` holds the frame's axes as columns; origin alike.
#[inline(always)]
pub fn turn_out<T: Scalar>(rotation: &Matrix3<T>, vector: &Vector6<T>) -> Vector6<T> {
    let (angular, linear) = split(vector);
    join(&apply(rotation, &angular), &apply(rotation, &linear))
}

/// The inverse of [`turn_out`].
#[inline(always)]
pub fn turn_back<T: Scalar>(rotation: &Matrix3<T>, vector: &Vector6<T>) -> Vector6<T> {
    let (angular, linear) = split(vector);
    join(
        &apply_transposed(rotation, &angular),
        &apply_transposed(rotation, &linear),
    )
}

/// `ad_T = [ω~ 0; v~ ω~]`, 6×6: the bracket of twists in one frame.
pub fn bracket<T: Scalar>(twist: &Vector6<T>) -> Matrix6<T> {
    let (angular, linear) = split(twist);
    let mut matrix = Matrix6::zeros();
    let (angular, linear) = (hat(&angular), hat(&linear));
    matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&angular);
    matrix.fixed_view_mut::<3, 3>(3, 0).copy_from(&linear);
    matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(&angular);
    matrix
}

/// `ad_T U = (ω × ω_U; v × ω_U + ω × v_U)`.
#[inline(always)]
pub fn bracket_product<T: Scalar>(twist: &Vector6<T>, other: &Vector6<T>) -> Vector6<T> {
    let (angular, linear) = split(twist);
    let (other_angular, other_linear) = split(other);
    join(
        &cross(&angular, &other_angular),
        // As a sum of two products the bracket of a twist with itself is exactly zero.
        &(cross(&linear, &other_angular) + cross(&angular, &other_linear)),
    )
}

/// `ad_Tᵀ W = −(ω × moment + v × force; ω × force)`: the dual bracket, on wrenches and momenta.
#[inline(always)]
pub fn bracket_dual_product<T: Scalar>(twist: &Vector6<T>, wrench: &Vector6<T>) -> Vector6<T> {
    let (angular, linear) = split(twist);
    let (moment, force) = split(wrench);
    join(
        &add_cross(&cross(&moment, &angular), &force, &linear),
        &cross(&force, &angular),
    )
}
