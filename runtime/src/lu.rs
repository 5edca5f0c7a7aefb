//! LU factors of a small square matrix in place, with row pivoting: what nalgebra does, without its allocations.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::ComplexField;

/// `P A = L U` of a matrix of fixed size, real or complex.
#[derive(Clone, Debug)]
pub struct Lu<T> {
    size: usize,
    /// By rows; L below the diagonal.
    entries: Vec<T>,
    rows: Vec<usize>,
    scratch: Vec<T>,
}

impl<T: ComplexField<RealField = f64> + Copy> Lu<T> {
    /// Room for the factors of a `size`×`size` matrix.
    pub fn new(size: usize) -> Self {
        Self {
            size,
            entries: vec![T::zero(); size * size],
            rows: (0..size).collect(),
            scratch: vec![T::zero(); size],
        }
    }

    /// Factorises the matrix of the given entries; the row and the ratio of its pivot to the largest where that is at most `limit`.
    pub fn factorize(
        &mut self,
        entry: impl Fn(usize, usize) -> T,
        limit: f64,
    ) -> Result<(), (usize, f64)> {
        let n = self.size;
        for i in 0..n {
            self.rows[i] = i;
            for j in 0..n {
                self.entries[i * n + j] = entry(i, j);
            }
        }
        let size = |entry: &T| entry.norm1();
        let largest = self.entries.iter().fold(0.0_f64, |m, x| m.max(size(x)));
        for k in 0..n {
            let at = |entries: &[T], i: usize| size(&entries[i * n + k]);
            let mut best = k;
            for i in k + 1..n {
                if at(&self.entries, i) > at(&self.entries, best) {
                    best = i;
                }
            }
            let pivot = at(&self.entries, best);
            if pivot.is_nan() || pivot <= limit * largest {
                let share = if largest > 0.0 { pivot / largest } else { 0.0 };
                return Err((self.rows[best], share));
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
        let (above, below) = self.entries.split_at_mut((k + 1) * n);
        let pivot = &above[k * n..];
        for row in below.chunks_exact_mut(n) {
            let factor = row[k] / pivot[k];
            row[k] = factor;
            if factor != T::zero() {
                for (entry, own) in row[k + 1..].iter_mut().zip(&pivot[k + 1..]) {
                    *entry -= factor * *own;
                }
            }
        }
    }

    /// `A⁻¹ x` in place.
    pub fn solve(&mut self, x: &mut [T]) {
        let n = self.size;
        for i in 0..n {
            self.scratch[i] = x[self.rows[i]];
        }
        for i in 0..n {
            for j in 0..i {
                let known = self.entries[i * n + j] * self.scratch[j];
                self.scratch[i] -= known;
            }
        }
        for i in (0..n).rev() {
            for j in i + 1..n {
                let known = self.entries[i * n + j] * self.scratch[j];
                self.scratch[i] -= known;
            }
            self.scratch[i] /= self.entries[i * n + i];
        }
        x.copy_from_slice(&self.scratch);
    }

    /// `A⁻ᵀ x` in place.
    pub(crate) fn solve_transposed(&mut self, x: &mut [T]) {
        let n = self.size;
        self.scratch.copy_from_slice(x);
        for i in 0..n {
            for j in 0..i {
                let known = self.entries[j * n + i] * self.scratch[j];
                self.scratch[i] -= known;
            }
            self.scratch[i] /= self.entries[i * n + i];
        }
        for i in (0..n).rev() {
            for j in i + 1..n {
                let known = self.entries[j * n + i] * self.scratch[j];
                self.scratch[i] -= known;
            }
        }
        for i in 0..n {
            x[self.rows[i]] = self.scratch[i];
        }
    }
}
