//! Plane rotations as unit complex numbers (c, s): 2 stored scalars, 1 angle.

use super::parts::{unit, unit_residual_squared};
use crate::scalar::Scalar;
use nalgebra::{Vector1, Vector2};

/// Q exp(ϕ): turned by the angle ϕ.
#[inline]
pub fn times_exp<T: Scalar>(q: &Vector2<T>, phi: &Vector1<T>) -> Vector2<T> {
    let (sin, cos) = phi[0].sin_cos();
    let (c, s) = (q[0], q[1]);
    Vector2::new(c * cos - s * sin, c * sin + s * cos)
}

/// The angle from Q to Q′, in (−π, π].
#[inline]
pub fn log_between<T: Scalar>(q: &Vector2<T>, target: &Vector2<T>) -> Vector1<T> {
    let sin = q[0] * target[1] - q[1] * target[0];
    let cos = q[0].mul_add(target[0], q[1] * target[1]);
    Vector1::new(sin.atan2(cos))
}

/// Q̇ at the angular velocity `v`.
#[inline]
pub fn rate<T: Scalar>(q: &Vector2<T>, v: &Vector1<T>) -> Vector2<T> {
    Vector2::new(-q[1] * v[0], q[0] * v[0])
}

/// The unit complex number nearest to `q`.
#[inline]
pub fn nearest<T: Scalar>(q: &Vector2<T>) -> Vector2<T> {
    unit(q)
}

/// `(c² + s² − 1)²`.
#[inline]
pub fn residual_squared<T: Scalar>(q: &Vector2<T>) -> T {
    unit_residual_squared(q)
}
