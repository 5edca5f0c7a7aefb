//! Linear systems of fixed size by Householder reflections: no pivots, so no branches, and backward stable.

use super::norm;
use crate::scalar::Scalar;
use nalgebra::{SMatrix, SVector};

/// The inverse of a square matrix; infinite or NaN where it is singular.
pub fn inverse<T: Scalar, const K: usize>(matrix: &SMatrix<T, K, K>) -> SMatrix<T, K, K> {
    least_squares(matrix, &SMatrix::identity())
}

/// The determinant of a square matrix.
pub fn determinant<T: Scalar, const K: usize>(matrix: &SMatrix<T, K, K>) -> T {
    let (triangle, _) = triangular(*matrix, SMatrix::<T, K, 1>::zeros());
    // Each of the K reflections turns the sign.
    (0..K).fold(T::one(), |product, k| -product * triangle[(k, k)])
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

/// F and the columns of `side`, reflected so that F is an upper triangle in its first K rows.
pub(super) fn triangular<T: Scalar, const N: usize, const K: usize, const M: usize>(
    mut matrix: SMatrix<T, N, K>,
    mut side: SMatrix<T, N, M>,
) -> (SMatrix<T, N, K>, SMatrix<T, N, M>) {
    for k in 0..K {
        let mirror = mirror(&matrix, k);
        reflect(&mut matrix, &mirror, k);
        reflect(&mut side, &mirror, k);
    }
    (matrix, side)
}

/// The sign of the determinant of a square matrix by its triangle: times −1 for each of the K reflections, the same of any matrix of this size.
pub(super) fn orientation<T: Scalar, const K: usize>(triangle: &SMatrix<T, K, K>) -> T {
    (0..K).fold(T::one(), |sign, k| {
        T::select(triangle[(k, k)].less(T::zero()), -sign, sign)
    })
}

/// The vector u, zero above row `column`, whose reflection `I − 2 u uᵀ` clears that column below the diagonal.
fn mirror<T: Scalar, const N: usize, const K: usize>(
    matrix: &SMatrix<T, N, K>,
    column: usize,
) -> SVector<T, N> {
    let zero = T::zero();
    let mut u = SVector::<T, N>::from_fn(|i, _| {
        if i < column {
            zero
        } else {
            matrix[(i, column)]
        }
    });
    let length = norm(&u);
    let pivot = u[column];
    // Away from the pivot, so that nothing cancels.
    u[column] = pivot + T::select(pivot.less(zero), -length, length);
    let length = norm(&u);
    let divisor = T::select(zero.less(length), length, T::one());
    u.map(|entry| entry / divisor)
}

/// Reflects the columns by a mirror that is zero above row `first`.
fn reflect<T: Scalar, const N: usize, const M: usize>(
    matrix: &mut SMatrix<T, N, M>,
    mirror: &SVector<T, N>,
    first: usize,
) {
    for j in 0..M {
        let share = (first..N).fold(T::zero(), |sum, i| mirror[i].mul_add(matrix[(i, j)], sum));
        let twice = share + share;
        for i in first..N {
            matrix[(i, j)] -= twice * mirror[i];
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
