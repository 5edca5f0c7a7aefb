//! M̄⁻¹ of few speeds from the articulated factors.
//!
//! `M̄ = Lᵀ D L` with the pivots of the articulated recursion for D and, in row i of L, `Y_iᵀ X_k / d_i` for the speeds k that are eliminated after i on
//! its way to the root. So `M̄⁻¹ = RᵀR` with `R = D^(−1/2) L⁻ᵀ`, whose row k has entries for k and for what is eliminated before it on the branches
//! that joint k carries.

use super::product::{gram, starts};
use super::{Branch, Sensitivity, WORLD};
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::scalar::Scalar;
use alloc::vec;
use alloc::vec::Vec;

/// Room for L and R.
#[derive(Clone, Debug)]
pub(super) struct Factors {
    lower: Vec<f64>,
    roots: Sensitivity,
    /// One a body: the speed after the last one that it carries.
    ends: Vec<usize>,
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
            ends,
        }
    }

    /// `L⁻ᵀ` from L.
    fn invert(&mut self, branches: &[Branch]) {
        match self.roots.columns {
            0..8 => self.invert_by::<1>(branches),
            _ => self.invert_by::<8>(branches),
        }
    }

    /// Row k is `e_k − Σ L_ik (row i)` over all i that are eliminated before k; W columns at a time.
    fn invert_by<const W: usize>(&mut self, branches: &[Branch]) {
        self.roots.clear();
        let size = self.roots.columns;
        for (branch, &last) in branches.iter().zip(&self.ends).rev() {
            let (start, end) = branch.speeds;
            for k in start..end {
                let known = (start..k).chain(end..last);
                for j in starts(last, W, start) {
                    let mut sum = [0.0; W];
                    for i in known.clone() {
                        let weight = self.lower[i * size + k];
                        let entries = &self.roots.entries[i * size + j..][..W];
                        for (sum, entry) in sum.iter_mut().zip(entries) {
                            *sum = Scalar::mul_add(-weight, *entry, *sum);
                        }
                    }
                    self.roots.entries[k * size + j..][..W].copy_from_slice(&sum);
                }
                self.roots.entries[k * size + k] = 1.0;
            }
        }
    }
}

impl Recursive {
    /// M̄⁻¹ into `out`, after [`Recursive::articulate`].
    pub(super) fn invert_few(
        &mut self,
        branches: &[Branch],
        factors: &mut Factors,
        out: &mut Sensitivity,
    ) {
        for (momentum, pivot) in self.momenta.iter_mut().zip(&self.pivots) {
            *momentum = pivot.momentum * pivot.inverse;
        }
        self.fill_rows(&mut factors.lower);
        factors.invert(branches);
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
