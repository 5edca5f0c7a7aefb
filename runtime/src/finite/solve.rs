//! Linear systems of fixed size by Householder reflections: no pivots, so no branches, and backward stable.

use super::absolute;
use crate::scalar::Scalar;
use nalgebra::{SMatrix, SVector};

/// The inverse of a square matrix; infinite or NaN where it is singular.
pub fn inverse<T: Scalar, const K: usize>(matrix: &SMatrix<T, K, K>) -> SMatrix<T, K, K> {
    least_squares(matrix, &SMatrix::identity())
}

/// The determinant of a square matrix.
pub fn determinant<T: Scalar, const K: usize>(matrix: &SMatrix<T, K, K>) -> T {
    let (triangle, _) = triangular(*matrix, SMatrix::<T, K, 1>::zeros());
    // Each reflection turns the sign: one for every column but the last.
    (0..K).fold(T::one(), |product, k| {
        let entry = triangle[(k, k)];
        product * if k + 1 < K { -entry } else { entry }
    })
}

/// For each column r of `side` (N×M) the x (K) with the least ‖F x − r‖₂, for an F (`matrix`) of N rows and rank K.
///
/// Backward stable, as normal equations are not. Infinite or NaN where F has dependent columns.
pub fn least_squares<T: Scalar, const N: usize, const K: usize, const M: usize>(
    matrix: &SMatrix<T, N, K>,
    side: &SMatrix<T, N, M>,
) -> SMatrix<T, K, M> {
    let (triangle, side) = triangular(*matrix, *side);
    substitute_back(&triangle, &side)
}

/// F and the columns of `side`, reflected so that F is an upper triangle in its first K rows. What is left below the diagonal is rounding.
pub(super) fn triangular<T: Scalar, const N: usize, const K: usize, const M: usize>(
    mut matrix: SMatrix<T, N, K>,
    mut side: SMatrix<T, N, M>,
) -> (SMatrix<T, N, K>, SMatrix<T, N, M>) {
    // The last row has nothing below it.
    for k in (0..K).take_while(|k| k + 1 < N) {
        let mirror = Mirror::of_column(&matrix, k);
        mirror.reflect(&mut matrix);
        mirror.reflect(&mut side);
    }
    (matrix, side)
}

/// The sign of the determinant of a square matrix by its triangle, times −1 for each reflection: as many for any matrix of this size.
pub(super) fn orientation<T: Scalar, const K: usize>(triangle: &SMatrix<T, K, K>) -> T {
    (0..K).fold(T::one(), |sign, k| {
        T::select(triangle[(k, k)].less(T::zero()), -sign, sign)
    })
}

/// The reflection `I − τ v vᵀ` that clears a column below the diagonal (Golub and Van Loan, Matrix Computations, section 5.1): v is zero above the
/// diagonal and one on it.
struct Mirror<T, const N: usize> {
    first: usize,
    normal: SVector<T, N>,
    factor: T,
}

impl<T: Scalar, const N: usize> Mirror<T, N> {
    /// Of a column of zeros it is the identity. Of a column with a number that is not finite it makes NaN of all that it reflects.
    fn of_column<const K: usize>(matrix: &SMatrix<T, N, K>, column: usize) -> Self {
        let zero = T::zero();
        let largest = (column..N).fold(zero, |largest, i| {
            let size = absolute(matrix[(i, column)]);
            T::select(size.less(largest), largest, size)
        });
        // Relative to the largest entry nothing overflows, and nothing that counts underflows.
        let divisor = T::select(zero.less(largest), largest, T::one());
        let mut normal = SVector::<T, N>::zeros();
        let square = (column..N).fold(zero, |sum, i| {
            normal[i] = matrix[(i, column)] / divisor;
            normal[i].mul_add(normal[i], sum)
        });
        let filled = zero.less(square);
        let length = T::select(filled, square, T::one()).sqrt();
        let pivot = normal[column];
        // Away from the pivot, so that nothing cancels.
        let moved = pivot + T::select(pivot.less(zero), -length, length);
        for i in column + 1..N {
            normal[i] /= moved;
        }
        normal[column] = T::one();
        let factor = T::one() + absolute(pivot) / length;
        Self {
            first: column,
            normal,
            // The square is 0 here, or NaN.
            factor: T::select(filled, factor, square),
        }
    }

    /// Reflects the columns.
    fn reflect<const M: usize>(&self, matrix: &mut SMatrix<T, N, M>) {
        let Self {
            first,
            normal,
            factor,
        } = *self;
        for j in 0..M {
            let share = (first..N).fold(T::zero(), |sum, i| normal[i].mul_add(matrix[(i, j)], sum));
            let share = factor * share;
            for i in first..N {
                matrix[(i, j)] -= share * normal[i];
            }
        }
    }
}

/// Solves the upper triangle of the first K rows.
pub(super) fn substitute_back<T: Scalar, const N: usize, const K: usize, const M: usize>(
    triangle: &SMatrix<T, N, K>,
    side: &SMatrix<T, N, M>,
) -> SMatrix<T, K, M> {
    let mut solution = SMatrix::<T, K, M>::zeros();
    for i in (0..K).rev() {
        for j in 0..M {
            let known = (i + 1..K).fold(T::zero(), |sum, l| {
                triangle[(i, l)].mul_add(solution[(l, j)], sum)
            });
            solution[(i, j)] = (side[(i, j)] - known) / triangle[(i, i)];
        }
    }
    solution
}
