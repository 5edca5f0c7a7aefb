//! Products of matrices and of slices of derivatives, without what patterns know to be 0 or 1.

use super::Entry;
use crate::scalar::Scalar;
use nalgebra::{SMatrix, SVector};

/// `Σ_k M_k x_k` without what `patterns` know to be 0 or 1.
#[inline(always)]
pub fn combined<T: Scalar, const R: usize, const C: usize, const K: usize>(
    slices: &[SMatrix<T, R, C>; K],
    patterns: &[[[Entry; C]; R]; K],
    x: &SVector<T, K>,
) -> SMatrix<T, R, C> {
    let mut sum = SMatrix::zeros();
    for k in 0..K {
        for i in 0..R {
            for j in 0..C {
                let known = patterns[k][i][j];
                sum[(i, j)] = accumulated(sum[(i, j)], known, slices[k][(i, j)], x[k]);
            }
        }
    }
    sum
}

/// `Σ_k M_k x y_k` without what `patterns` know to be 0 or 1.
#[inline(always)]
pub fn turned<T: Scalar, const R: usize, const C: usize, const K: usize>(
    slices: &[SMatrix<T, R, C>; K],
    patterns: &[[[Entry; C]; R]; K],
    y: &SVector<T, K>,
    x: &SVector<T, C>,
) -> SVector<T, R> {
    let mut sum = SVector::zeros();
    for k in 0..K {
        let column = times(&slices[k], &patterns[k], x);
        for i in 0..R {
            if patterns[k][i].iter().any(|entry| *entry != Entry::Zero) {
                sum[i] = column[i].mul_add(y[k], sum[i]);
            }
        }
    }
    sum
}

/// `Σ_k M_kᵀ x y_k` without what `patterns` know to be 0 or 1.
#[inline(always)]
pub fn turned_back<T: Scalar, const R: usize, const C: usize, const K: usize>(
    slices: &[SMatrix<T, R, C>; K],
    patterns: &[[[Entry; C]; R]; K],
    y: &SVector<T, K>,
    x: &SVector<T, R>,
) -> SVector<T, C> {
    let mut sum = SVector::zeros();
    for k in 0..K {
        let column = transposed_times(&slices[k], &patterns[k], x);
        for j in 0..C {
            if patterns[k].iter().any(|row| row[j] != Entry::Zero) {
                sum[j] = column[j].mul_add(y[k], sum[j]);
            }
        }
    }
    sum
}

/// `sum + A B x` without what the patterns of A and B know to be 0 or 1.
#[inline(always)]
pub fn add_moved<T: Scalar, const R: usize, const M: usize, const C: usize>(
    sum: &mut SVector<T, R>,
    (a, of_a): (&SMatrix<T, R, M>, &[[Entry; M]; R]),
    (b, of_b): (&SMatrix<T, M, C>, &[[Entry; C]; M]),
    x: &SVector<T, C>,
) {
    for m in 0..M {
        if of_b[m].iter().all(|entry| *entry == Entry::Zero) {
            continue;
        }
        let mut moved = T::zero();
        for j in 0..C {
            moved = accumulated(moved, of_b[m][j], b[(m, j)], x[j]);
        }
        for i in 0..R {
            sum[i] = accumulated(sum[i], of_a[i][m], a[(i, m)], moved);
        }
    }
}

/// `sum + A B` without what the patterns of A and B know to be 0 or 1.
#[inline(always)]
pub fn add_product<T: Scalar, const R: usize, const M: usize, const C: usize>(
    sum: &mut SMatrix<T, R, C>,
    (a, of_a): (&SMatrix<T, R, M>, &[[Entry; M]; R]),
    (b, of_b): (&SMatrix<T, M, C>, &[[Entry; C]; M]),
) {
    for i in 0..R {
        for m in 0..M {
            for j in 0..C {
                let entry = &mut sum[(i, j)];
                match of_a[i][m] {
                    Entry::Zero => {}
                    Entry::One => *entry = accumulated(*entry, of_b[m][j], b[(m, j)], T::one()),
                    Entry::Other => *entry = accumulated(*entry, of_b[m][j], b[(m, j)], a[(i, m)]),
                }
            }
        }
    }
}

/// `M x` without what `pattern` knows to be 0 or 1.
#[inline(always)]
pub fn times<T: Scalar, const R: usize, const C: usize>(
    matrix: &SMatrix<T, R, C>,
    pattern: &[[Entry; C]; R],
    x: &SVector<T, C>,
) -> SVector<T, R> {
    let mut product = SVector::zeros();
    for i in 0..R {
        for j in 0..C {
            product[i] = accumulated(product[i], pattern[i][j], matrix[(i, j)], x[j]);
        }
    }
    product
}

/// `Mᵀ x` without what `pattern` of M knows to be 0 or 1.
#[inline(always)]
pub fn transposed_times<T: Scalar, const R: usize, const C: usize>(
    matrix: &SMatrix<T, R, C>,
    pattern: &[[Entry; C]; R],
    x: &SVector<T, R>,
) -> SVector<T, C> {
    let mut product = SVector::zeros();
    for j in 0..C {
        for i in 0..R {
            product[j] = accumulated(product[j], pattern[i][j], matrix[(i, j)], x[i]);
        }
    }
    product
}

/// `sum + entry x`.
#[inline(always)]
fn accumulated<T: Scalar>(sum: T, pattern: Entry, entry: T, x: T) -> T {
    match pattern {
        Entry::Zero => sum,
        Entry::One => sum + x,
        Entry::Other => entry.mul_add(x, sum),
    }
}
