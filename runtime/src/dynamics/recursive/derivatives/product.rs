//! Products of small dense matrices, in tiles that stay in registers.

use super::Sensitivity;
use crate::scalar::Scalar;

/// `out = −left right` for a symmetric `left`.
pub(super) fn negative_product(left: &Sensitivity, right: &Sensitivity, out: &mut Sensitivity) {
    match left.rows {
        0..4 => rows::<1>(left, right, out),
        _ => rows::<4>(left, right, out),
    }
}

fn rows<const R: usize>(left: &Sensitivity, right: &Sensitivity, out: &mut Sensitivity) {
    match right.columns {
        0..4 => tiles::<R, 1>(left, right, out),
        4..8 => tiles::<R, 4>(left, right, out),
        _ => tiles::<R, 8>(left, right, out),
    }
}

fn tiles<const R: usize, const W: usize>(
    left: &Sensitivity,
    right: &Sensitivity,
    out: &mut Sensitivity,
) {
    for i in starts(left.rows, R) {
        for j in starts(right.columns, W) {
            tile::<R, W>(left, right, out, (i, j));
        }
    }
}

/// Where blocks of a length begin that cover so many entries. The last one overlaps the one before it: to do some entries twice costs less
/// than to do them one by one.
fn starts(entries: usize, block: usize) -> impl Iterator<Item = usize> {
    (0..entries.div_ceil(block)).map(move |number| (number * block).min(entries - block))
}

/// R rows and W columns of the product.
#[inline(never)]
fn tile<const R: usize, const W: usize>(
    left: &Sensitivity,
    right: &Sensitivity,
    out: &mut Sensitivity,
    (i, j): (usize, usize),
) {
    let mut sum = [[0.0; W]; R];
    let rows = right.entries.chunks_exact(right.columns);
    for (weights, row) in left.entries.chunks_exact(left.columns).zip(rows) {
        // Column i of the symmetric matrix is its row i.
        let weights: [f64; R] = weights[i..i + R].try_into().unwrap_or([0.0; R]);
        let row: [f64; W] = row[j..j + W].try_into().unwrap_or([0.0; W]);
        for r in 0..R {
            for w in 0..W {
                sum[r][w] = Scalar::mul_add(-weights[r], row[w], sum[r][w]);
            }
        }
    }
    for (r, sum) in sum.iter().enumerate() {
        let start = (i + r) * out.columns + j;
        out.entries[start..start + W].copy_from_slice(sum);
    }
}

/// `out += left right`.
pub(super) fn add_product(left: &Sensitivity, right: &Sensitivity, out: &mut Sensitivity) {
    let width = right.columns.max(1);
    let rows = out.entries.chunks_exact_mut(width);
    for (row, weights) in rows.zip(left.entries.chunks_exact(left.columns.max(1))) {
        for (weight, other) in weights.iter().zip(right.entries.chunks_exact(width)) {
            if *weight != 0.0 {
                for (sum, entry) in row.iter_mut().zip(other) {
                    *sum = Scalar::mul_add(*weight, *entry, *sum);
                }
            }
        }
    }
}
