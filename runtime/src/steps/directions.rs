//! Derivatives along the axes of a vector, by dual numbers.

use crate::matrix::{entries, map, set_column, zeros};
use crate::scalar::{Dual, Scalar};
use nalgebra::{SMatrix, SVector};

/// A vector without a derivative.
pub(super) fn constant<T: Scalar, const R: usize>(vector: &SVector<T, R>) -> SVector<Dual<T>, R> {
    map(vector, Dual::constant)
}

/// The infinitesimal along axis `k`.
pub(super) fn along<T: Scalar, const K: usize>(k: usize) -> SVector<Dual<T>, K> {
    let mut axis = zeros::<Dual<T>, K, 1>();
    axis.data.0[0][k] = Dual::variable(T::zero());
    axis
}

/// A vector that moves at `rate`.
pub(super) fn moving<T: Scalar, const R: usize>(
    vector: &SVector<T, R>,
    rate: &SVector<T, R>,
) -> SVector<Dual<T>, R> {
    entries(|i| Dual::new(vector[i], rate[i]))
}

/// What stands beside the infinitesimal.
pub(super) fn derivative<T: Scalar, const R: usize, const C: usize>(
    matrix: &SMatrix<Dual<T>, R, C>,
) -> SMatrix<T, R, C> {
    map(matrix, |entry| entry.derivative())
}

/// The matrix of these columns.
pub(super) fn columns<T: Scalar, const R: usize, const K: usize>(
    mut column: impl FnMut(usize) -> SVector<T, R>,
) -> SMatrix<T, R, K> {
    let mut columns = zeros::<T, R, K>();
    for k in 0..K {
        set_column(&mut columns, k, &column(k));
    }
    columns
}
