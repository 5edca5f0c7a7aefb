//! LU factors of a small square matrix in place, with row pivoting: what nalgebra does, without its allocations.

use crate::mechanism::share;
use alloc::vec;
use alloc::vec::Vec;

/// `P A = L U` of a matrix of fixed size.
#[derive(Clone, Debug)]
pub(super) struct Lu {
    size: usize,
    /// By rows; L below the diagonal.
    entries: Vec<f64>,
    rows: Vec<usize>,
    scratch: Vec<f64>,
}

impl Lu {
    pub(super) fn new(size: usize) -> Self {
        Self {
            size,
            entries: vec![0.0; size * size],
            rows: (0..size).collect(),
            scratch: vec![0.0; size],
        }
    }

    /// Factorises the matrix of the given entries; the row and the ratio of its pivot to the largest where that is below `limit`.
    pub(super) fn factorize(
        &mut self,
        entry: impl Fn(usize, usize) -> f64,
        limit: f64,
    ) -> Result<(), (usize, f64)> {
        let n = self.size;
        for i in 0..n {
            self.rows[i] = i;
            for j in 0..n {
                self.entries[i * n + j] = entry(i, j);
            }
        }
        let largest = self.entries.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for k in 0..n {
            let at = |entries: &[f64], i: usize| entries[i * n + k].abs();
            let mut best = k;
            for i in k + 1..n {
                if at(&self.entries, i) > at(&self.entries, best) {
                    best = i;
                }
            }
            let pivot = at(&self.entries, best);
            if pivot.is_nan() || pivot <= limit * largest {
                return Err((self.rows[best], share(pivot, largest)));
            }
            for j in 0..n {
                self.entries.swap(k * n + j, best * n + j);
            }
            self.rows.swap(k, best);
            self.eliminate(k);
        }
        Ok(())
    }

    fn eliminate(&mut self, k: usize) {
        let n = self.size;
        for i in k + 1..n {
            let factor = self.entries[i * n + k] / self.entries[k * n + k];
            self.entries[i * n + k] = factor;
            for j in k + 1..n {
                self.entries[i * n + j] -= factor * self.entries[k * n + j];
            }
        }
    }

    /// `A⁻¹ x` in place.
    pub(super) fn solve(&mut self, x: &mut [f64]) {
        let n = self.size;
        for i in 0..n {
            self.scratch[i] = x[self.rows[i]];
        }
        for i in 0..n {
            for j in 0..i {
                self.scratch[i] -= self.entries[i * n + j] * self.scratch[j];
            }
        }
        for i in (0..n).rev() {
            for j in i + 1..n {
                self.scratch[i] -= self.entries[i * n + j] * self.scratch[j];
            }
            self.scratch[i] /= self.entries[i * n + i];
        }
        x.copy_from_slice(&self.scratch);
    }

    /// `A⁻ᵀ x` in place.
    pub(super) fn solve_transposed(&mut self, x: &mut [f64]) {
        let n = self.size;
        self.scratch.copy_from_slice(x);
        for i in 0..n {
            for j in 0..i {
                self.scratch[i] -= self.entries[j * n + i] * self.scratch[j];
            }
            self.scratch[i] /= self.entries[i * n + i];
        }
        for i in (0..n).rev() {
            for j in i + 1..n {
                self.scratch[i] -= self.entries[j * n + i] * self.scratch[j];
            }
        }
        for i in 0..n {
            x[self.rows[i]] = self.scratch[i];
        }
    }
}
