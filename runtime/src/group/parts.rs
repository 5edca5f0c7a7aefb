//! Parts of vectors, one a factor of a manifold, and the small products that groups are made of.

use crate::matrix::{by_entry, entries, map, zeros};
use crate::scalar::Scalar;
use nalgebra::{SMatrix, SVector};

/// The R entries of a vector from place `start` on: what belongs to one factor of a manifold.
#[inline]
pub fn part<T: Scalar, const R: usize, const N: usize>(
    vector: &SVector<T, N>,
    start: usize,
) -> SVector<T, R> {
    entries(|i| vector.data.0[0][start + i])
}

/// The vector of all parts, one after the other.
///
/// # Panics
/// When the parts have not N entries together.
#[inline]
pub fn stacked<T: Scalar, const N: usize>(parts: &[&[T]]) -> SVector<T, N> {
    let mut whole = zeros::<T, N, 1>();
    let mut start = 0;
    for part in parts {
        whole.data.0[0][start..start + part.len()].copy_from_slice(part);
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
    for i in 0..R {
        vector.data.0[0][start + i] = part.data.0[0][i];
    }
}

/// Replaces the block of a square matrix that stands on the diagonal from place `start` on.
#[inline]
pub fn put_block<T: Scalar, const R: usize, const N: usize>(
    matrix: &mut SMatrix<T, N, N>,
    start: usize,
    block: &SMatrix<T, R, R>,
) {
    for j in 0..R {
        for i in 0..R {
            matrix.data.0[start + j][start + i] = block.data.0[j][i];
        }
    }
}

/// `A B`.
#[inline]
pub(super) fn product<T: Scalar, const R: usize, const M: usize, const C: usize>(
    a: &SMatrix<T, R, M>,
    b: &SMatrix<T, M, C>,
) -> SMatrix<T, R, C> {
    by_entry(|i, j| dot(|k| (a.data.0[k][i], b.data.0[j][k]), M))
}

/// `Aᵀ B`.
#[inline]
pub(super) fn transposed_product<T: Scalar, const R: usize, const M: usize, const C: usize>(
    a: &SMatrix<T, M, R>,
    b: &SMatrix<T, M, C>,
) -> SMatrix<T, R, C> {
    by_entry(|i, j| dot(|k| (a.data.0[i][k], b.data.0[j][k]), M))
}

#[inline(always)]
fn dot<T: Scalar>(pair: impl Fn(usize) -> (T, T), count: usize) -> T {
    let (a, b) = pair(count - 1);
    let mut sum = a * b;
    for k in (0..count - 1).rev() {
        let (a, b) = pair(k);
        sum = a.mul_add(b, sum);
    }
    sum
}

/// `A b + c`, to which the products are added one after the other, the last first.
#[inline]
pub(super) fn moved<T: Scalar, const R: usize, const M: usize>(
    a: &SMatrix<T, R, M>,
    b: &SVector<T, M>,
    c: &SVector<T, R>,
) -> SVector<T, R> {
    entries(|i| {
        let mut sum = c.data.0[0][i];
        for k in (0..M).rev() {
            sum = a.data.0[k][i].mul_add(b.data.0[0][k], sum);
        }
        sum
    })
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
    map(vector, |entry| entry * inverse)
}

/// `(|q|² − 1)²`: the relation of the unit vectors, squared.
#[inline]
pub(super) fn unit_residual_squared<T: Scalar, const N: usize>(q: &SVector<T, N>) -> T {
    let relation = squared(q) - T::one();
    relation * relation
}
