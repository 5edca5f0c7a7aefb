//! Products of matrices and of slices of derivatives, without what patterns know to be 0 or 1.
#![expect(
    clippy::needless_range_loop,
    reason = "one index is of several matrices and patterns"
)]

use super::Entry;
use crate::matrix::zeros;
use crate::scalar::Scalar;
use nalgebra::{SMatrix, SVector};

/// `Σ_k M_k x_k` without what `patterns` know to be 0 or 1.
#[inline(always)]
pub fn combined<T: Scalar, const R: usize, const C: usize, const K: usize>(
    slices: &[SMatrix<T, R, C>; K],
    patterns: &[[[Entry; C]; R]; K],
    x: &SVector<T, K>,
) -> SMatrix<T, R, C> {
    let mut sum = zeros::<T, R, C>();
    for k in 0..K {
        for i in 0..R {
            for j in 0..C {
                let known = patterns[k][i][j];
                sum.data.0[j][i] = accumulated(
                    sum.data.0[j][i],
                    known,
                    slices[k].data.0[j][i],
                    x.data.0[0][k],
                );
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
    let mut sum = zeros::<T, R, 1>();
    for k in 0..K {
        let column = times(&slices[k], &patterns[k], x);
        for i in 0..R {
            if is_any(&patterns[k][i]) {
                sum.data.0[0][i] = column.data.0[0][i].mul_add(y.data.0[0][k], sum.data.0[0][i]);
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
    let mut sum = zeros::<T, C, 1>();
    for k in 0..K {
        let column = transposed_times(&slices[k], &patterns[k], x);
        for j in 0..C {
            let mut known = [Entry::Zero; R];
            for i in 0..R {
                known[i] = patterns[k][i][j];
            }
            if is_any(&known) {
                sum.data.0[0][j] = column.data.0[0][j].mul_add(y.data.0[0][k], sum.data.0[0][j]);
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
        if !is_any(&of_b[m]) {
            continue;
        }
        let mut moved = T::zero();
        for j in 0..C {
            moved = accumulated(moved, of_b[m][j], b.data.0[j][m], x.data.0[0][j]);
        }
        for i in 0..R {
            sum.data.0[0][i] = accumulated(sum.data.0[0][i], of_a[i][m], a.data.0[m][i], moved);
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
                let entry = &mut sum.data.0[j][i];
                match of_a[i][m] {
                    Entry::Zero => {}
                    Entry::One => {
                        *entry = accumulated(*entry, of_b[m][j], b.data.0[j][m], T::one())
                    }
                    Entry::Other => {
                        *entry = accumulated(*entry, of_b[m][j], b.data.0[j][m], a.data.0[m][i])
                    }
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
    let mut product = zeros::<T, R, 1>();
    for i in 0..R {
        for j in 0..C {
            product.data.0[0][i] = accumulated(
                product.data.0[0][i],
                pattern[i][j],
                matrix.data.0[j][i],
                x.data.0[0][j],
            );
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
    let mut product = zeros::<T, C, 1>();
    for j in 0..C {
        for i in 0..R {
            product.data.0[0][j] = accumulated(
                product.data.0[0][j],
                pattern[i][j],
                matrix.data.0[j][i],
                x.data.0[0][i],
            );
        }
    }
    product
}

/// Whether any of the entries is not known to be 0.
#[inline(always)]
fn is_any<const C: usize>(entries: &[Entry; C]) -> bool {
    let mut any = false;
    for j in 0..C {
        any |= !matches!(entries[j], Entry::Zero);
    }
    any
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
