//! Unit vectors: 3 stored scalars. No group, so that joints on it declare Φ themselves.

use super::parts::{unit, unit_residual_squared};
use crate::scalar::Scalar;
use nalgebra::Vector3;

/// The unit vector nearest to `q`.
#[inline]
pub fn nearest<T: Scalar>(q: &Vector3<T>) -> Vector3<T> {
    unit(q)
}

/// `(|q|² − 1)²`.
#[inline]
pub fn residual_squared<T: Scalar>(q: &Vector3<T>) -> T {
    unit_residual_squared(q)
}
