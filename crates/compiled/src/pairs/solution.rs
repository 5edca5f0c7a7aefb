//! Solutions with M̄, factorised along the tree.

use super::super::number::Number;
use super::Pairs;

impl Pairs<'_> {
    /// Makes given rates known: what they take of others moves to the right-hand side.
    #[inline(always)]
    pub(super) fn hold<T: Number>(&self, matrix: &mut [T], rows: &mut [T], width: usize) {
        let size = self.above.len();
        for &[speed, column] in self.held {
            for row in 0..size {
                rows[row * width + column] = matrix[row * size + speed].negative();
            }
        }
        for &[speed, _] in self.held {
            rows[speed * width..][..width - 1].fill(T::from_f64(0.0));
        }
        for &[speed, column] in self.held {
            rows[speed * width + column] = T::from_f64(1.0);
        }
        self.fix(matrix);
    }

    /// Rates that are given depend on nothing.
    #[inline(always)]
    pub(super) fn fix<T: Number>(&self, matrix: &mut [T]) {
        let size = self.above.len();
        for &[speed, _] in self.held {
            for other in 0..size {
                matrix[speed * size + other] = T::from_f64(0.0);
                matrix[other * size + speed] = T::from_f64(0.0);
            }
            matrix[speed * size + speed] = T::from_f64(1.0);
        }
    }

    /// `M̄ = LᵀDL`, which fills no zero of the tree: L in the lower triangle, D⁻¹ on the diagonal.
    #[inline(always)]
    pub(super) fn factorise<T: Number, const FUSED: bool>(&self, matrix: &mut [T]) {
        let size = self.above.len();
        for k in (0..size).rev() {
            let (before, own) = matrix.split_at_mut(k * size);
            let inverse = T::from_f64(1.0).over(own[k]);
            let mut next = self.above[k];
            while let Some(i) = next {
                let factor = own[i].times(inverse);
                let less = factor.negative();
                let row = &mut before[i * size..][..size];
                let mut other = next;
                while let Some(j) = other {
                    row[j] = less.times_plus::<FUSED>(own[j], row[j]);
                    other = self.above[j];
                }
                own[i] = factor;
                next = self.above[i];
            }
            own[k] = inverse;
        }
    }

    /// `M̄⁻¹` times the columns of the tables, as many at once as registers take.
    #[inline(always)]
    pub(super) fn solve<T: Number, const FUSED: bool>(
        &self,
        factors: &[T],
        rows: &mut [T],
        width: usize,
    ) {
        for &[from, to] in self.columns {
            let mut from = from;
            while from < to {
                from += match (to - from).min(T::COLUMNS) {
                    32.. => self.solve_block::<T, FUSED, 32>(factors, rows, [width, from]),
                    16.. => self.solve_block::<T, FUSED, 16>(factors, rows, [width, from]),
                    8.. => self.solve_block::<T, FUSED, 8>(factors, rows, [width, from]),
                    4.. => self.solve_block::<T, FUSED, 4>(factors, rows, [width, from]),
                    _ => self.solve_block::<T, FUSED, 1>(factors, rows, [width, from]),
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
    #[inline(always)]
    fn solve_block<T: Number, const FUSED: bool, const N: usize>(
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
                    less::<T, FUSED, N>(&mut own, factors[k * size + i], &other);
                }
            }
            rows[place..place + N].copy_from_slice(&own);
        }
        for k in 0..wanted {
            let inverse = factors[k * size + k];
            let place = k * width + from;
            let mut own: [T; N] = block(rows, place).map(|entry| entry.times(inverse));
            let mut next = self.above[k];
            while let Some(i) = next {
                let other = block(rows, i * width + from);
                less::<T, FUSED, N>(&mut own, factors[k * size + i], &other);
                next = self.above[i];
            }
            rows[place..place + N].copy_from_slice(&own);
        }
        N
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
fn block<T: Number, const N: usize>(rows: &[T], place: usize) -> [T; N] {
    let found = rows[place..].first_chunk();
    found.copied().unwrap_or([T::from_f64(0.0); N])
}

#[inline(always)]
fn less<T: Number, const FUSED: bool, const N: usize>(sums: &mut [T; N], factor: T, from: &[T; N]) {
    let factor = factor.negative();
    for (sum, &other) in sums.iter_mut().zip(from) {
        *sum = factor.times_plus::<FUSED>(other, *sum);
    }
}
