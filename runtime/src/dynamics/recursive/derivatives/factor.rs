//! M̄⁻¹ of few speeds from the articulated factors.
//!
//! `M̄ = Lᵀ D L` with the pivots of the articulated recursion for D and, in row i of L, `Y_iᵀ X_k / d_i` for the speeds k that are eliminated after i on
//! its way to the root. So `M̄⁻¹ = RᵀR` with `R = D^(−1/2) L⁻ᵀ`, whose row k has entries for k and for what is eliminated before it on the branches
//! that joint k carries.

use super::product::{Span, gram, sums};
use super::{Branch, Sensitivity, WORLD};
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::scalar::Scalar;
use alloc::vec;
use alloc::vec::Vec;

/// Up to so many speeds a product with M̄⁻¹ costs less than sweeps.
pub(super) const FEW: usize = 56;

/// Room for L and R.
#[derive(Clone, Debug)]
pub(super) struct Factors {
    lower: Vec<f64>,
    roots: Sensitivity,
    /// From the tips on.
    blocks: Vec<Block>,
}

/// Rows of neighbouring joints that are found together: those before them are a product, and among themselves they are few.
#[derive(Clone, Copy, Debug)]
struct Block {
    start: usize,
    rows: usize,
    /// The speed after the last one that they carry.
    end: usize,
    /// The rows from `start` on in the order in which their speeds are eliminated.
    order: [usize; MOST_FREEDOMS],
}

/// Most rows of several joints in one block.
const TOGETHER: usize = 6;

impl Block {
    const EMPTY: Self = Self {
        start: 0,
        rows: 0,
        end: 0,
        order: [0; MOST_FREEDOMS],
    };

    /// The rows of `branches`, from the tips on; each body carries speeds up to before its entry of `ends`.
    fn all(branches: &[Branch], ends: &[usize]) -> Vec<Self> {
        let mut blocks: Vec<Self> = Vec::new();
        for (branch, &end) in branches.iter().zip(ends).rev() {
            let (start, own) = (branch.speeds.0, branch.speeds.1 - branch.speeds.0);
            let fits = |last: &&mut Self| last.rows + own <= TOGETHER;
            let mut block = match blocks.last_mut().filter(fits) {
                Some(last) => core::mem::replace(last, Self::EMPTY),
                None => {
                    blocks.push(Self::EMPTY);
                    Self::EMPTY
                }
            };
            // What is in it already moves on by the rows of this joint.
            let known = &mut block.order[..block.rows];
            known.iter_mut().for_each(|row| *row += own);
            for row in 0..own {
                block.order[block.rows + row] = row;
            }
            block.start = start;
            block.rows += own;
            block.end = block.end.max(end);
            if let Some(last) = blocks.last_mut() {
                *last = block;
            }
        }
        blocks
    }
}

impl Factors {
    pub(super) fn new(branches: &[Branch], speeds: usize) -> Self {
        let mut ends: Vec<usize> = branches.iter().map(|branch| branch.speeds.1).collect();
        for (body, branch) in branches.iter().enumerate().rev() {
            if branch.parent != WORLD {
                ends[branch.parent] = ends[branch.parent].max(ends[body]);
            }
        }
        Self {
            lower: vec![0.0; speeds * speeds],
            roots: Sensitivity::new(speeds, speeds),
            blocks: Block::all(branches, &ends),
        }
    }

    /// `L⁻ᵀ` from L: row k is `e_k − Σ L_ik (row i)` over all i that are eliminated before k.
    fn invert(&mut self) {
        let Self {
            lower,
            roots,
            blocks,
        } = self;
        // So that nothing stays of numbers that overflowed.
        roots.clear();
        for block in &*blocks {
            match block.rows {
                0 => {}
                1 => rows::<1>(block, lower, roots),
                2 => rows::<2>(block, lower, roots),
                3 => rows::<3>(block, lower, roots),
                4 => rows::<4>(block, lower, roots),
                5 => rows::<5>(block, lower, roots),
                TOGETHER => rows::<TOGETHER>(block, lower, roots),
                _ => rows::<MOST_FREEDOMS>(block, lower, roots),
            }
        }
    }
}

/// The rows of one block.
fn rows<const R: usize>(block: &Block, lower: &[f64], roots: &mut Sensitivity) {
    for span in Span::cover(block.start..block.end, roots.columns) {
        match span {
            Span::Eight(j) => columns::<R, 8>(block, lower, roots, j),
            Span::Four(j) => columns::<R, 4>(block, lower, roots, j),
            Span::One(j) => columns::<R, 1>(block, lower, roots, j),
        }
    }
}

/// W columns of them, from column j on.
#[inline(never)]
fn columns<const R: usize, const W: usize>(
    block: &Block,
    lower: &[f64],
    roots: &mut Sensitivity,
    j: usize,
) {
    let (size, start, first) = (roots.columns, block.start, block.start + R);
    let (own, known) = roots.entries.split_at_mut(first * size);
    let mut rows = match block.end - first {
        0 => [[0.0; W]; R],
        depth => sums::<R, W>(
            (&lower[first * size + start..], size),
            (&known[j..], size),
            depth,
        ),
    };
    for (place, &row) in block.order[..R].iter().enumerate() {
        let mut entries = rows[row].map(|sum| -sum);
        if let Some(own) = (start + row).checked_sub(j).filter(|own| *own < W) {
            entries[own] += 1.0;
        }
        for &before in &block.order[..place] {
            let weight = lower[(start + before) * size + start + row];
            for (entry, known) in entries.iter_mut().zip(&rows[before]) {
                *entry = Scalar::mul_add(-weight, *known, *entry);
            }
        }
        rows[row] = entries;
        own[(start + row) * size + j..][..W].copy_from_slice(&entries);
    }
}

impl Recursive {
    /// M̄⁻¹ into `out`, after [`Recursive::articulate`].
    pub(super) fn invert_few(&mut self, factors: &mut Factors, out: &mut Sensitivity) {
        for (momentum, pivot) in self.momenta.iter_mut().zip(&self.pivots) {
            *momentum = pivot.momentum * pivot.inverse;
        }
        self.fill_rows(&mut factors.lower);
        factors.invert();
        let size = factors.roots.columns.max(1);
        for (row, pivot) in factors
            .roots
            .entries
            .chunks_exact_mut(size)
            .zip(&self.pivots)
        {
            let weight = Scalar::sqrt(pivot.inverse);
            row.iter_mut().for_each(|entry| *entry *= weight);
        }
        gram(&factors.roots, MOST_FREEDOMS, out);
    }
}
