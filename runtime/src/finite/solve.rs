//! Linear systems by Householder reflections: no pivots, so no branches, and backward stable.
//!
//! Matrices are slices of their entries by columns, so that one function serves sizes that a type tells and sizes that only the data tell.

use super::absolute;
use crate::matrix::{by_entry, identity};
use crate::scalar::Scalar;
use nalgebra::SMatrix;

/// The inverse of a square matrix; infinite or NaN where it is singular.
pub fn inverse<T: Scalar, const K: usize>(matrix: &SMatrix<T, K, K>) -> SMatrix<T, K, K> {
    least_squares(matrix, &identity())
}

/// For each column r of `side` (N×M) the x (K) with the least ‖F x − r‖₂, for an F (`matrix`) of N rows and rank K.
///
/// Backward stable, as normal equations are not. Infinite or NaN where F has dependent columns.
pub fn least_squares<T: Scalar, const N: usize, const K: usize, const M: usize>(
    matrix: &SMatrix<T, N, K>,
    side: &SMatrix<T, N, M>,
) -> SMatrix<T, K, M> {
    let (mut matrix, mut side) = (*matrix, *side);
    solve(N, matrix.as_mut_slice(), side.as_mut_slice());
    by_entry(|i, j| side.data.0[j][i])
}

/// The same for matrices of so many rows: the solutions stand in the first entries of the columns of `side`, and `matrix` becomes what [`triangulate`] leaves.
#[inline]
pub(crate) fn solve<T: Scalar>(rows: usize, matrix: &mut [T], side: &mut [T]) {
    triangulate(rows, matrix, side);
    substitute_back(rows, matrix, side);
}

/// A matrix of so many rows, and the columns of `side`, reflected so that it is an upper triangle in its first rows. Its entries below the diagonal are those of the reflections.
#[inline]
pub(crate) fn triangulate<T: Scalar>(rows: usize, matrix: &mut [T], side: &mut [T]) {
    let columns = matrix.len().checked_div(rows).unwrap_or(0);
    // The last row has nothing below it.
    for k in (0..columns).take_while(|k| k + 1 < rows) {
        let (before, behind) = matrix.split_at_mut((k + 1) * rows);
        let own = &mut before[k * rows + k..];
        let (factor, diagonal) = mirror(own);
        let normal = &own[1..];
        for column in behind
            .chunks_exact_mut(rows)
            .chain(side.chunks_exact_mut(rows))
        {
            reflect(factor, normal, &mut column[k..]);
        }
        own[0] = diagonal;
    }
}

/// The reflection `I − τ v vᵀ` that clears a column below its first entry (Golub and Van Loan, Matrix Computations, section 5.1): τ and what the first entry becomes. v has 1 in its
/// first entry; the others take the places of those of the column.
///
/// Of a column of zeros it is the identity. Of a column with a number that is not finite it makes NaN of all that it reflects.
#[inline]
fn mirror<T: Scalar>(column: &mut [T]) -> (T, T) {
    let zero = T::zero();
    let largest = column.iter().fold(zero, |largest, entry| {
        let size = absolute(*entry);
        T::select(size.less(largest), largest, size)
    });
    // Relative to the largest entry nothing overflows, and nothing that counts underflows.
    let divisor = T::select(zero.less(largest), largest, T::one());
    let square = column.iter().fold(zero, |sum, entry| {
        let part = *entry / divisor;
        part.mul_add(part, sum)
    });
    let filled = zero.less(square);
    let length = T::select(filled, square, T::one()).sqrt();
    let pivot = column[0] / divisor;
    // Away from the pivot, so that nothing cancels.
    let moved = pivot + T::select(pivot.less(zero), -length, length);
    // The square is 0 where it is not filled, or NaN.
    let factor = T::select(filled, T::one() + absolute(pivot) / length, square);
    let first = column[0];
    let mut share = first;
    for entry in &mut column[1..] {
        let own = *entry;
        *entry = own / divisor / moved;
        share = entry.mul_add(own, share);
    }
    (factor, first - factor * share)
}

/// Reflects a column, from the row of the reflection's first entry on.
#[inline]
fn reflect<T: Scalar>(factor: T, normal: &[T], column: &mut [T]) {
    let Some((first, others)) = column.split_first_mut() else {
        return;
    };
    let pairs = normal.iter().zip(others.iter());
    let share = pairs.fold(*first, |sum, (normal, entry)| normal.mul_add(*entry, sum));
    let share = factor * share;
    *first -= share;
    for (normal, entry) in normal.iter().zip(others) {
        *entry -= share * *normal;
    }
}

/// Solves a triangle that [`triangulate`] left, in the first entries of the columns of `side`.
#[inline]
pub(crate) fn substitute_back<T: Scalar>(rows: usize, triangle: &[T], side: &mut [T]) {
    if rows == 0 {
        return;
    }
    for solution in side.chunks_exact_mut(rows) {
        for i in (0..triangle.len() / rows).rev() {
            let known = (i + 1..triangle.len() / rows).fold(T::zero(), |sum, l| {
                triangle[l * rows + i].mul_add(solution[l], sum)
            });
            solution[i] = (solution[i] - known) / triangle[i * rows + i];
        }
    }
}

/// The entries on the diagonal.
fn diagonal<T: Scalar>(rows: usize, triangle: &[T]) -> impl Iterator<Item = T> {
    triangle.iter().step_by(rows + 1).copied()
}

/// The determinant of a square matrix by its triangle.
#[cfg(feature = "alloc")]
pub(crate) fn determinant<T: Scalar>(rows: usize, triangle: &[T]) -> T {
    // Each reflection turns the sign: one for every column but the last.
    diagonal(rows, triangle)
        .enumerate()
        .fold(T::one(), |product, (k, entry)| {
            product * if k + 1 < rows { -entry } else { entry }
        })
}

/// The sign of the determinant of a square matrix by its triangle, times −1 for each reflection: as many for any matrix of this size.
pub(crate) fn orientation<T: Scalar>(rows: usize, triangle: &[T]) -> T {
    diagonal(rows, triangle).fold(T::one(), |sign, entry| {
        T::select(entry.less(T::zero()), -sign, sign)
    })
}
