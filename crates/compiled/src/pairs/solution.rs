//! Solutions with M̄, factorised along the tree.

use super::Pairs;
use hamel_runtime::scalar::Scalar;

impl Pairs<'_> {
    /// Makes given rates known: what they take of others moves to the right-hand side.
    pub(super) fn hold<T: Scalar>(&self, matrix: &mut [T], rows: &mut [T], width: usize) {
        let size = self.above.len();
        for &[speed, column] in self.held {
            for row in 0..size {
                rows[row * width + column] = -matrix[row * size + speed];
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
    pub(super) fn fix<T: Scalar>(&self, matrix: &mut [T]) {
        let size = self.above.len();
        for &[speed, _] in self.held {
            for other in 0..size {
                matrix[speed * size + other] = T::zero();
                matrix[other * size + speed] = T::zero();
            }
            matrix[speed * size + speed] = T::one();
        }
    }

    /// `M̄ = LᵀDL`, which fills no zero of the tree: L in the lower triangle, D⁻¹ on the diagonal.
    pub(super) fn factorise<T: Scalar>(&self, matrix: &mut [T]) {
        let size = self.above.len();
        for k in (0..size).rev() {
            let (before, own) = matrix.split_at_mut(k * size);
            let inverse = T::one() / own[k];
            for i in self.above(k) {
                let factor = own[i] * inverse;
                let less = -factor;
                let row = &mut before[i * size..][..size];
                row[i] = less.mul_add(own[i], row[i]);
                for &[from, to] in self.above[i] {
                    for (entry, &own) in row[from..to].iter_mut().zip(&own[from..to]) {
                        *entry = less.mul_add(own, *entry);
                    }
                }
                own[i] = factor;
            }
            own[k] = inverse;
        }
    }

    /// `M̄⁻¹` times the columns of the tables, as many at once as registers take.
    pub(super) fn solve<T: Scalar>(&self, factors: &[T], rows: &mut [T], width: usize) {
        for &[from, to] in self.columns {
            let mut from = from;
            while from < to {
                from += match to - from {
                    32.. => self.solve_block::<T, 32>(factors, rows, [width, from]),
                    16.. => self.solve_block::<T, 16>(factors, rows, [width, from]),
                    8.. => self.solve_block::<T, 8>(factors, rows, [width, from]),
                    4.. => self.solve_block::<T, 4>(factors, rows, [width, from]),
                    _ => self.solve_block::<T, 1>(factors, rows, [width, from]),
                };
            }
        }
        if let Some(first) = self.mirrored {
            let size = self.above.len();
            for row in 0..size {
                for column in 0..row {
                    rows[row * width + first + column] = rows[column * width + first + row];
                }
            }
        }
    }

    /// The same of columns beside each other; how many these are.
    fn solve_block<T: Scalar, const N: usize>(
        &self,
        factors: &[T],
        rows: &mut [T],
        [width, from]: [usize; 2],
    ) -> usize {
        let size = self.above.len();
        // A column of M̄⁻¹ is a unit below its diagonal, and not wanted there.
        let wanted = self
            .mirrored
            .and_then(|first| (from + N).checked_sub(first));
        let wanted = wanted
            .filter(|&wanted| wanted > 0)
            .map_or(size, |wanted| wanted.min(size));
        for i in (0..wanted).rev() {
            let place = i * width + from;
            let mut own: [T; N] = block(rows, place);
            for &k in self.below[i] {
                if k < wanted && self.is_filled(k, from, N) {
                    let other = block(rows, k * width + from);
                    less(&mut own, factors[k * size + i], &other);
                }
            }
            rows[place..place + N].copy_from_slice(&own);
        }
        for k in 0..wanted {
            let inverse = factors[k * size + k];
            let place = k * width + from;
            let mut own: [T; N] = block(rows, place).map(|entry| entry * inverse);
            for i in self.above(k) {
                let other = block(rows, i * width + from);
                less(&mut own, factors[k * size + i], &other);
            }
            rows[place..place + N].copy_from_slice(&own);
        }
        N
    }

    /// The speeds towards the root, the nearest first.
    #[inline(always)]
    fn above(&self, speed: usize) -> impl Iterator<Item = usize> {
        let ranges = self.above[speed].iter();
        ranges.flat_map(|&[from, to]| (from..to).rev())
    }

    /// Whether any of so many columns differs from 0 in the row of a speed, before it is divided.
    #[inline(always)]
    fn is_filled(&self, speed: usize, from: usize, count: usize) -> bool {
        let words = self.filled[speed];
        let (word, bit) = (from / WORD, from % WORD);
        let mut bits = words[word] >> bit;
        if bit > 0 && bit + count > WORD {
            bits |= words[word + 1] << (WORD - bit);
        }
        bits & ((1 << count) - 1) != 0
    }
}

/// Columns of a word.
const WORD: usize = u64::BITS as usize;

#[inline(always)]
fn block<T: Scalar, const N: usize>(rows: &[T], place: usize) -> [T; N] {
    let found = rows[place..].first_chunk();
    found.copied().unwrap_or([T::zero(); N])
}

#[inline(always)]
fn less<T: Scalar, const N: usize>(sums: &mut [T; N], factor: T, from: &[T; N]) {
    let factor = -factor;
    for (sum, &other) in sums.iter_mut().zip(from) {
        *sum = factor.mul_add(other, *sum);
    }
}
