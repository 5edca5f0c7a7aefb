//! Rⁿ with addition: Q exp(ϕ) = Q + ϕ.

use crate::scalar::Scalar;
use nalgebra::SVector;

/// Q + ϕ.
#[inline]
pub fn times_exp<T: Scalar, const N: usize>(
    q: &SVector<T, N>,
    phi: &SVector<T, N>,
) -> SVector<T, N> {
    q + phi
}

/// Q′ − Q.
#[inline]
pub fn log_between<T: Scalar, const N: usize>(
    q: &SVector<T, N>,
    target: &SVector<T, N>,
) -> SVector<T, N> {
    target - q
}
