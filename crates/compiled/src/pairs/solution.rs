//! Solutions with M̄, factorised along the tree.

use super::Pairs;
use hamel_runtime::scalar::Scalar;

/// Numbers that begin where a line of the cache begins.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Aligned<T, const N: usize>(pub [T; N]);

/// M̄, then its factors, by rows.
pub(super) struct Factors<'a, T> {
    pub(super) entries: &'a mut [T],
    /// Numbers of a row: blocks of columns end within it.
    pub(super) stride: usize,
}

/// Columns that are solved for at once, at most: what registers hold.
const STRIP: usize = 48;
/// Columns of the smallest block.
const BLOCK: usize = 8;

/// Numbers of a row of M̄ as it is factorised.
const fn stride(size: usize) -> usize {
    size.next_multiple_of(BLOCK)
}

/// Numbers that solving with M̄ of so many speeds needs room for.
#[must_use]
pub const fn room_to_solve(size: usize) -> usize {
    size * (stride(size) + STRIP)
}

impl Pairs<'_> {
    /// Room for M̄, and for the columns that are solved for.
    pub(super) fn split<'r, T: Scalar>(&self, room: &'r mut [T]) -> (Factors<'r, T>, &'r mut [T]) {
        let stride = stride(self.size());
        let (entries, strip) = room.split_at_mut(self.size() * stride);
        (Factors { entries, stride }, strip)
    }

    /// Makes given rates known: what they take of others moves to the right-hand side.
    pub(super) fn hold<T: Scalar>(
        &self,
        matrix: &mut Factors<'_, T>,
        rows: &mut [T],
        width: usize,
    ) {
        for &[speed, column] in self.held {
            for row in 0..self.size() {
                let place = row.max(speed) * matrix.stride + row.min(speed);
                rows[row * width + column] = -matrix.entries[place];
            }
        }
        for &[speed, _] in self.held {
            rows[speed * width..][..width - 1].fill(T::zero());
        }
        for &[speed, column] in self.held {
            rows[speed * width + column] = T::one();
        }
        self.fix(matrix);
    }

    /// Rates that are given depend on nothing.
    pub(super) fn fix<T: Scalar>(&self, matrix: &mut Factors<'_, T>) {
        let stride = matrix.stride;
        for &[speed, _] in self.held {
            for other in 0..self.size() {
                matrix.entries[speed * stride + other] = T::zero();
                matrix.entries[other * stride + speed] = T::zero();
            }
            matrix.entries[speed * stride + speed] = T::one();
        }
    }

    /// `M̄ = LᵀDL`, which fills no zero of the tree: L left of the diagonal, D⁻¹ on it. Right of it nothing is read.
    pub(super) fn factorise<T: Scalar>(&self, matrix: &mut Factors<'_, T>) {
        let stride = matrix.stride;
        for i in (0..self.size()).rev() {
            let end = (i + 1).next_multiple_of(BLOCK);
            let mut from = 0;
            while from < end {
                from += match end - from {
                    32.. => self.eliminate::<T, 32>(matrix, i, from),
                    16.. => self.eliminate::<T, 16>(matrix, i, from),
                    _ => self.eliminate::<T, BLOCK>(matrix, i, from),
                };
            }
            let pivot = &mut matrix.entries[i * stride + i];
            *pivot = T::one() / *pivot;
        }
        for (k, row) in matrix.entries.chunks_exact_mut(stride.max(1)).enumerate() {
            let inverse = row[k];
            for &[from, to] in self.above[k] {
                for entry in &mut row[from..to] {
                    *entry *= inverse;
                }
            }
        }
    }

    /// Takes those below a row from its block of columns; how many these are.
    #[inline(always)]
    fn eliminate<T: Scalar, const N: usize>(
        &self,
        matrix: &mut Factors<'_, T>,
        row: usize,
        from: usize,
    ) -> usize {
        let Factors { entries, stride } = matrix;
        let place = row * *stride + from;
        let mut own: [T; N] = *super::numbers(entries, place);
        for &[first, last] in self.below[row] {
            for k in (first..last).rev() {
                let below = k * *stride;
                let factor = entries[below + row] * entries[below + k];
                less(&mut own, factor, super::numbers(entries, below + from));
            }
        }
        entries[place..][..N].copy_from_slice(&own);
        N
    }

    /// `M̄⁻¹` times the columns of the tables, as many at once as registers take.
    pub(super) fn solve<T: Scalar>(
        &self,
        factors: &Factors<'_, T>,
        strip: &mut [T],
        rows: &mut [T],
        width: usize,
    ) {
        for &[from, to] in self.columns {
            // Strips as wide as each other: a narrow one takes nearly as long as a wide one.
            let count = (to - from).div_ceil((to - from).div_ceil(STRIP));
            for from in (from..to).step_by(count) {
                let columns = (from, count.min(to - from), width);
                match count {
                    41.. => self.solve_strip::<T, STRIP>(factors, strip, rows, columns),
                    33.. => self.solve_strip::<T, 40>(factors, strip, rows, columns),
                    25.. => self.solve_strip::<T, 32>(factors, strip, rows, columns),
                    17.. => self.solve_strip::<T, 24>(factors, strip, rows, columns),
                    9.. => self.solve_strip::<T, 16>(factors, strip, rows, columns),
                    _ => self.solve_strip::<T, BLOCK>(factors, strip, rows, columns),
                }
            }
        }
        if let Some(first) = self.mirrored {
            for row in 0..self.size() {
                for column in 0..row {
                    rows[row * width + first + column] = rows[column * width + first + row];
                }
            }
        }
    }

    /// The same of `count` columns beside each other, at most N.
    #[inline(always)]
    fn solve_strip<T: Scalar, const N: usize>(
        &self,
        factors: &Factors<'_, T>,
        strip: &mut [T],
        rows: &mut [T],
        (from, count, width): (usize, usize, usize),
    ) {
        // A column of M̄⁻¹ is a unit below its diagonal, and not wanted there.
        let wanted = self
            .mirrored
            .and_then(|first| (from + count).checked_sub(first));
        let wanted = wanted
            .filter(|&wanted| wanted > 0)
            .map_or(self.size(), |wanted| wanted.min(self.size()));
        let strip = &mut strip.as_chunks_mut::<N>().0[..wanted];
        for (i, own) in strip.iter_mut().enumerate() {
            *own = load(&rows[i * width + from..]);
        }
        self.solve_up(factors, strip);
        self.solve_down(factors, strip);
        for (k, own) in strip.iter().enumerate() {
            store(&mut rows[k * width + from..], own, count);
        }
    }

    /// From the leaves to the root.
    #[inline(always)]
    fn solve_up<T: Scalar, const N: usize>(&self, factors: &Factors<'_, T>, strip: &mut [[T; N]]) {
        for i in (0..strip.len()).rev() {
            let mut own = strip[i];
            for &[from, to] in self.below[i] {
                for k in (from..to.min(strip.len())).rev() {
                    less(&mut own, factors.entries[k * factors.stride + i], &strip[k]);
                }
            }
            strip[i] = own;
        }
    }

    /// From the root to the leaves.
    #[inline(always)]
    fn solve_down<T: Scalar, const N: usize>(
        &self,
        factors: &Factors<'_, T>,
        strip: &mut [[T; N]],
    ) {
        for k in 0..strip.len() {
            let row = &factors.entries[k * factors.stride..][..factors.stride];
            let mut own = strip[k];
            for entry in &mut own {
                *entry *= row[k];
            }
            for &[from, to] in self.above[k] {
                for i in (from..to).rev() {
                    less(&mut own, row[i], &strip[i]);
                }
            }
            strip[k] = own;
        }
    }
}

/// N entries of a row, or what there is of them and zeros.
#[inline(always)]
fn load<T: Scalar, const N: usize>(row: &[T]) -> [T; N] {
    match row.first_chunk() {
        Some(row) => *row,
        None => {
            let mut all = [T::zero(); N];
            all[..row.len()].copy_from_slice(row);
            all
        }
    }
}

/// Assigns the first `count` entries of a row.
#[inline(always)]
fn store<T: Scalar>(row: &mut [T], entries: &[T], count: usize) {
    let (row, _) = row.split_at_mut(count);
    let (blocks, rest) = row.as_chunks_mut::<BLOCK>();
    let (full, others) = entries.as_chunks::<BLOCK>();
    for (block, entries) in blocks.iter_mut().zip(full) {
        *block = *entries;
    }
    let left = full.get(blocks.len()).map_or(others, |block| &block[..]);
    for (place, &entry) in rest.iter_mut().zip(left) {
        *place = entry;
    }
}

#[inline(always)]
fn less<T: Scalar, const N: usize>(sums: &mut [T; N], factor: T, from: &[T; N]) {
    let factor = -factor;
    for (sum, &other) in sums.iter_mut().zip(from) {
        *sum = factor.mul_add(other, *sum);
    }
}
