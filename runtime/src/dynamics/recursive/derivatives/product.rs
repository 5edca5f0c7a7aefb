//! Products of small dense matrices, in tiles that stay in registers.

use super::Sensitivity;
use crate::scalar::Scalar;

/// `out = −leftᵀ right`.
pub(super) fn negative_product(left: &Sensitivity, right: &Sensitivity, out: &mut Sensitivity) {
    let all = left.rows;
    by_rows::<false>(&Product { left, right, all }, out);
}

/// `out = rootsᵀ roots`, where column i has no entries below row `i + beyond`.
pub(super) fn gram(roots: &Sensitivity, beyond: usize, out: &mut Sensitivity) {
    let product = Product {
        left: roots,
        right: roots,
        all: beyond,
    };
    by_rows::<true>(&product, out);
}

struct Product<'a> {
    left: &'a Sensitivity,
    right: &'a Sensitivity,
    /// How many rows count: all of them, or so many below the diagonals.
    all: usize,
}

/// The product, six rows of it at a time and fewer at the end.
fn by_rows<const GRAM: bool>(product: &Product<'_>, out: &mut Sensitivity) {
    let mut i = 0;
    loop {
        i += match product.left.columns - i {
            0 => return,
            1 => by_columns::<GRAM, 1>(product, out, i),
            2 | 3 => by_columns::<GRAM, 2>(product, out, i),
            4 | 5 | 8 => by_columns::<GRAM, 4>(product, out, i),
            _ => by_columns::<GRAM, 6>(product, out, i),
        };
    }
}

/// R rows of the product; R.
fn by_columns<const GRAM: bool, const R: usize>(
    product: &Product<'_>,
    out: &mut Sensitivity,
    i: usize,
) -> usize {
    for span in Span::cover(0..product.right.columns, product.right.columns) {
        match span {
            Span::Eight(j) => tile::<GRAM, R, 8>(product, out, (i, j)),
            Span::Four(j) => tile::<GRAM, R, 4>(product, out, (i, j)),
            Span::One(j) => tile::<GRAM, R, 1>(product, out, (i, j)),
        }
    }
    R
}

/// Columns that are done at once, from the first one on.
#[derive(Clone, Copy)]
pub(super) enum Span {
    Eight(usize),
    Four(usize),
    One(usize),
}

impl Span {
    /// Spans over `columns` of a matrix that has `width`. They may reach beyond, or overlap: to do some entries twice costs less than to do them one by
    /// one.
    #[inline(always)]
    pub(super) fn cover(
        columns: core::ops::Range<usize>,
        width: usize,
    ) -> impl Iterator<Item = Self> {
        let mut next = columns.start;
        core::iter::from_fn(move || {
            let left = columns.end.checked_sub(next).filter(|left| *left > 0)?;
            let (span, taken) = match left {
                _ if width < 4 => (Self::One(next), 1),
                0..=4 => (Self::Four(next.min(width - 4)), 4),
                _ if width < 8 => (Self::Four(next), 4),
                5..=7 => (Self::Eight(next.min(width - 8)), 8),
                _ => (Self::Eight(next), 8),
            };
            next += taken;
            Some(span)
        })
    }
}

/// R rows and W columns of the product.
#[inline(never)]
fn tile<const GRAM: bool, const R: usize, const W: usize>(
    product: &Product<'_>,
    out: &mut Sensitivity,
    (i, j): (usize, usize),
) {
    let depth = match GRAM {
        true => ((i + R).min(j + W) + product.all).min(product.left.rows),
        false => product.all,
    };
    let sum = sums::<R, W>(
        (&product.left.entries[i..], product.left.columns),
        (&product.right.entries[j..], product.right.columns),
        depth,
    );
    for (r, sum) in sum.iter().enumerate() {
        let start = (i + r) * out.columns + j;
        for (entry, sum) in out.entries[start..start + W].iter_mut().zip(sum) {
            *entry = if GRAM { *sum } else { -sum };
        }
    }
}

/// The products of R columns of the one matrix with W columns of the other, over `depth` rows; each begins where its slice does and has its width.
#[inline(always)]
pub(super) fn sums<const R: usize, const W: usize>(
    (left, lefts): (&[f64], usize),
    (right, rights): (&[f64], usize),
    depth: usize,
) -> [[f64; W]; R] {
    let mut sum = [[0.0; W]; R];
    for row in 0..depth {
        let weights = &left[row * lefts..][..R];
        let entries = &right[row * rights..][..W];
        for r in 0..R {
            for w in 0..W {
                sum[r][w] = Scalar::mul_add(weights[r], entries[w], sum[r][w]);
            }
        }
    }
    sum
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
