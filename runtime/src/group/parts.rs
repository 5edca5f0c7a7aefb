//! Parts of vectors, one a factor of a manifold, and the small products that groups are made of.

use crate::scalar::Scalar;
use nalgebra::{SMatrix, SVector};

/// The R entries of a vector from place `start` on: what belongs to one factor of a manifold.
#[inline]
pub fn part<T: Scalar, const R: usize, const N: usize>(
    vector: &SVector<T, N>,
    start: usize,
) -> SVector<T, R> {
    vector.fixed_rows::<R>(start).into_owned()
}

/// The vector of all parts, one after the other.
///
/// # Panics
/// When the parts have not N entries together.
#[inline]
pub fn stacked<T: Scalar, const N: usize>(parts: &[&[T]]) -> SVector<T, N> {
    let mut whole = SVector::<T, N>::zeros();
    let mut start = 0;
    for part in parts {
        whole.as_mut_slice()[start..start + part.len()].copy_from_slice(part);
        start += part.len();
    }
    assert!(start == N, "the parts are not the whole vector");
    whole
}

/// Replaces the entries of a vector from place `start` on.
#[inline]
pub fn put<T: Scalar, const R: usize, const N: usize>(
    vector: &mut SVector<T, N>,
    start: usize,
    part: &SVector<T, R>,
) {
    vector.fixed_rows_mut::<R>(start).copy_from(part);
}

/// Replaces the block of a square matrix that stands on the diagonal from place `start` on.
#[inline]
pub fn put_block<T: Scalar, const R: usize, const N: usize>(
    matrix: &mut SMatrix<T, N, N>,
    start: usize,
    block: &SMatrix<T, R, R>,
) {
    matrix.fixed_view_mut::<R, R>(start, start).copy_from(block);
}

/// `A B`.
#[inline]
pub(super) fn product<T: Scalar, const R: usize, const M: usize, const C: usize>(
    a: &SMatrix<T, R, M>,
    b: &SMatrix<T, M, C>,
) -> SMatrix<T, R, C> {
    SMatrix::from_fn(|i, j| dot(|k| (a[(i, k)], b[(k, j)]), M))
}

/// `Aᵀ B`.
#[inline]
pub(super) fn transposed_product<T: Scalar, const R: usize, const M: usize, const C: usize>(
    a: &SMatrix<T, M, R>,
    b: &SMatrix<T, M, C>,
) -> SMatrix<T, R, C> {
    SMatrix::from_fn(|i, j| dot(|k| (a[(k, i)], b[(k, j)]), M))
}

#[inline(always)]
fn dot<T: Scalar>(pair: impl Fn(usize) -> (T, T), count: usize) -> T {
    let (a, b) = pair(count - 1);
    (0..count - 1).rev().fold(a * b, |sum, k| {
        let (a, b) = pair(k);
        a.mul_add(b, sum)
    })
}

/// `A b + c`, to which the products are added one after the other, the last first.
#[inline]
pub(super) fn moved<T: Scalar, const R: usize, const M: usize>(
    a: &SMatrix<T, R, M>,
    b: &SVector<T, M>,
    c: &SVector<T, R>,
) -> SVector<T, R> {
    let row = |i: usize, _| {
        (0..M)
            .rev()
            .fold(c[i], |sum, k| a[(i, k)].mul_add(b[k], sum))
    };
    SVector::from_fn(row)
}

/// Sum of the squares of the entries.
#[inline]
pub(super) fn squared<T: Scalar, const N: usize>(entries: &SVector<T, N>) -> T {
    transposed_product(entries, entries)[0]
}

/// The vector divided by its length.
#[inline]
pub(super) fn unit<T: Scalar, const N: usize>(vector: &SVector<T, N>) -> SVector<T, N> {
    let inverse = T::one() / squared(vector).sqrt();
    vector.map(|entry| entry * inverse)
}

/// `(|q|² − 1)²`: the relation of the unit vectors, squared.
#[inline]
pub(super) fn unit_residual_squared<T: Scalar, const N: usize>(q: &SVector<T, N>) -> T {
    let relation = squared(q) - T::one();
    relation * relation
}
