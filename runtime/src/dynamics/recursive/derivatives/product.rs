//! Products of small dense matrices, in tiles that stay in registers.

use super::Sensitivity;
use crate::scalar::Scalar;

/// `out = −leftᵀ right`.
pub(super) fn negative_product(left: &Sensitivity, right: &Sensitivity, out: &mut Sensitivity) {
    rows(
        &Product {
            left,
            right,
            sign: -1.0,
            beyond: left.rows,
        },
        out,
    );
}

/// `out = rootsᵀ roots`, where column i has no entries below row `i + beyond`.
pub(super) fn gram(roots: &Sensitivity, beyond: usize, out: &mut Sensitivity) {
    rows(
        &Product {
            left: roots,
            right: roots,
            sign: 1.0,
            beyond,
        },
        out,
    );
}

/// `sign leftᵀ right`, with at most so many rows below the diagonals of both.
struct Product<'a> {
    left: &'a Sensitivity,
    right: &'a Sensitivity,
    sign: f64,
    beyond: usize,
}

fn rows(product: &Product<'_>, out: &mut Sensitivity) {
    match product.left.columns {
        0..4 => columns::<1>(product, out),
        _ => columns::<4>(product, out),
    }
}

fn columns<const R: usize>(product: &Product<'_>, out: &mut Sensitivity) {
    match product.right.columns {
        0..4 => tiles::<R, 1>(product, out),
        4..8 => tiles::<R, 4>(product, out),
        _ => tiles::<R, 8>(product, out),
    }
}

fn tiles<const R: usize, const W: usize>(product: &Product<'_>, out: &mut Sensitivity) {
    for i in starts(product.left.columns, R, 0) {
        for j in starts(product.right.columns, W, 0) {
            tile::<R, W>(product, out, (i, j));
        }
    }
}

/// Where blocks of a length begin that cover the entries from `first` to before `end`. The last one overlaps what is before it: to do some entries
/// twice costs less than to do them one by one.
pub(super) fn starts(end: usize, block: usize, first: usize) -> impl Iterator<Item = usize> {
    (0..(end - first).div_ceil(block))
        .map(move |number| (first + number * block).min(end.saturating_sub(block)))
}

/// R rows and W columns of the product.
#[inline(never)]
fn tile<const R: usize, const W: usize>(
    product: &Product<'_>,
    out: &mut Sensitivity,
    (i, j): (usize, usize),
) {
    let (left, right) = (product.left, product.right);
    let mut sum = [[0.0; W]; R];
    let rows = right.entries.chunks_exact(right.columns);
    let depth = (i + R).min(j + W) + product.beyond;
    for (weights, row) in left
        .entries
        .chunks_exact(left.columns)
        .zip(rows)
        .take(depth)
    {
        let weights: [f64; R] = weights[i..i + R].try_into().unwrap_or([0.0; R]);
        let row: [f64; W] = row[j..j + W].try_into().unwrap_or([0.0; W]);
        for r in 0..R {
            for w in 0..W {
                sum[r][w] = Scalar::mul_add(weights[r], row[w], sum[r][w]);
            }
        }
    }
    for (r, sum) in sum.iter().enumerate() {
        let start = (i + r) * out.columns + j;
        for (entry, sum) in out.entries[start..start + W].iter_mut().zip(sum) {
            *entry = product.sign * sum;
        }
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
