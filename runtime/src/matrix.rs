//! Matrices of fixed sizes by plain loops over their columns.
//!
//! What is generic in a joint is compiled once more for each type of joint. nalgebra's `from_fn`, `map`, `*` and `dot` are several hundred lines of LLVM IR each, for
//! each size and scalar; the functions here are some thirty. `entries` and `map` do without `by_entry`: a closure within a closure would be a twenty-fifth of a joint. Sums run in the order of the index, without the fused multiply–adds of `group::parts` and `spatial::fused`.

use crate::scalar::Scalar;
use nalgebra::{ArrayStorage, SMatrix, SVector};

/// The matrix of these columns.
#[inline(always)]
pub(crate) fn of_columns<T: Scalar, const R: usize, const C: usize>(
    columns: [[T; R]; C],
) -> SMatrix<T, R, C> {
    SMatrix::from_array_storage(ArrayStorage(columns))
}

/// The matrix whose entries are all this one.
#[inline(always)]
pub(crate) fn filled<T: Scalar, const R: usize, const C: usize>(entry: T) -> SMatrix<T, R, C> {
    of_columns([[entry; R]; C])
}

/// The matrix of zeros.
#[inline(always)]
pub(crate) fn zeros<T: Scalar, const R: usize, const C: usize>() -> SMatrix<T, R, C> {
    filled(T::zero())
}

/// Ones on the diagonal, zeros elsewhere.
#[inline(always)]
pub(crate) fn identity<T: Scalar, const R: usize, const C: usize>() -> SMatrix<T, R, C> {
    by_entry(|i, j| if i == j { T::one() } else { T::zero() })
}

/// The vector with these entries at their indices.
#[inline(always)]
pub(crate) fn entries<T: Scalar, const R: usize>(entry: impl Fn(usize) -> T) -> SVector<T, R> {
    let mut vector = zeros::<T, R, 1>();
    for i in 0..R {
        vector.data.0[0][i] = entry(i);
    }
    vector
}

/// The matrix with these entries at their rows and columns.
#[inline(always)]
pub(crate) fn by_entry<T: Scalar, const R: usize, const C: usize>(
    entry: impl Fn(usize, usize) -> T,
) -> SMatrix<T, R, C> {
    let mut matrix = zeros::<T, R, C>();
    for j in 0..C {
        for i in 0..R {
            matrix.data.0[j][i] = entry(i, j);
        }
    }
    matrix
}

/// The square matrix with these entries, row by row.
#[cfg(feature = "alloc")]
#[inline(always)]
pub(crate) fn by_rows<T: Scalar, const R: usize>(entries: &[T]) -> SMatrix<T, R, R> {
    by_entry(|i, j| entries[i * R + j])
}

/// A function of each entry.
#[inline(always)]
pub(crate) fn map<T: Scalar, U: Scalar, const R: usize, const C: usize>(
    matrix: &SMatrix<T, R, C>,
    function: impl Fn(T) -> U,
) -> SMatrix<U, R, C> {
    let mut mapped = zeros::<U, R, C>();
    for j in 0..C {
        for i in 0..R {
            mapped.data.0[j][i] = function(matrix.data.0[j][i]);
        }
    }
    mapped
}

/// Column `j`.
#[inline(always)]
pub(crate) fn column<T: Scalar, const R: usize, const C: usize>(
    matrix: &SMatrix<T, R, C>,
    j: usize,
) -> SVector<T, R> {
    of_columns([matrix.data.0[j]])
}

/// Replaces column `j`.
#[inline(always)]
pub(crate) fn set_column<T: Scalar, const R: usize, const C: usize>(
    matrix: &mut SMatrix<T, R, C>,
    j: usize,
    column: &SVector<T, R>,
) {
    matrix.data.0[j] = column.data.0[0];
}

/// `A B`.
#[inline(always)]
pub(crate) fn product<T: Scalar, const R: usize, const M: usize, const C: usize>(
    a: &SMatrix<T, R, M>,
    b: &SMatrix<T, M, C>,
) -> SMatrix<T, R, C> {
    let mut product = zeros::<T, R, C>();
    for j in 0..C {
        for m in 0..M {
            let weight = b.data.0[j][m];
            for i in 0..R {
                let entry = a.data.0[m][i] * weight;
                let sum = &mut product.data.0[j][i];
                *sum = if m == 0 { entry } else { entry + *sum };
            }
        }
    }
    product
}

/// `Aᵀ B`.
#[cfg(feature = "alloc")]
#[inline(always)]
pub(crate) fn transposed_product<T: Scalar, const R: usize, const M: usize, const C: usize>(
    a: &SMatrix<T, M, R>,
    b: &SMatrix<T, M, C>,
) -> SMatrix<T, R, C> {
    by_entry(|i, j| sum_of_products(&a.data.0[i], &b.data.0[j]))
}

/// `aᵀ b`.
#[inline(always)]
pub(crate) fn dot<T: Scalar, const R: usize>(a: &SVector<T, R>, b: &SVector<T, R>) -> T {
    sum_of_products(&a.data.0[0], &b.data.0[0])
}

#[inline(always)]
fn sum_of_products<T: Scalar, const R: usize>(a: &[T; R], b: &[T; R]) -> T {
    let mut sum = T::zero();
    for i in 0..R {
        let product = a[i] * b[i];
        sum = if i == 0 { product } else { sum + product };
    }
    sum
}
