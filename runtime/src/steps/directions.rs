//! Derivatives along the axes of a vector, by dual numbers.

use crate::scalar::{Dual, Scalar};
use nalgebra::{SMatrix, SVector};

/// A vector without a derivative.
pub(super) fn constant<T: Scalar, const R: usize>(vector: &SVector<T, R>) -> SVector<Dual<T>, R> {
    vector.map(Dual::constant)
}

/// The infinitesimal along axis `k`.
pub(super) fn along<T: Scalar, const K: usize>(k: usize) -> SVector<Dual<T>, K> {
    let mut axis = SVector::repeat(Dual::constant(T::zero()));
    axis[k] = Dual::variable(T::zero());
    axis
}

/// What stands beside the infinitesimal.
pub(super) fn derivative<T: Scalar, const R: usize>(vector: &SVector<Dual<T>, R>) -> SVector<T, R> {
    vector.map(|entry| entry.derivative())
}

/// The matrix of these columns.
pub(super) fn columns<T: Scalar, const R: usize, const K: usize>(
    column: impl FnMut(usize) -> SVector<T, R>,
) -> SMatrix<T, R, K> {
    let columns: [_; K] = core::array::from_fn(column);
    SMatrix::from_columns(&columns)
}
