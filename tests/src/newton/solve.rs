//! Cholesky's decomposition of a symmetric matrix within its skyline.

use super::number::{Real, real};

/// The lower triangle, each row from its first entry that can be other than 0.
#[derive(Clone, Debug)]
pub struct Skyline {
    rows: Vec<(usize, Vec<Real>)>,
}

impl Skyline {
    /// Decomposes the matrix of `entry`, whose entries `(i, j)` are 0 where not `linked`.
    pub fn new(
        size: usize,
        linked: impl Fn(usize, usize) -> bool,
        entry: impl Fn(usize, usize) -> Real,
    ) -> Self {
        let mut rows: Vec<(usize, Vec<Real>)> = Vec::with_capacity(size);
        for i in 0..size {
            let first = (0..i).find(|&j| linked(i, j)).unwrap_or(i);
            let mut row = Vec::with_capacity(i + 1 - first);
            for j in first..=i {
                let above = rows.get(j);
                let sum = match above {
                    Some((start, above)) => entry(i, j) - overlap(first, &row, *start, above, j),
                    None => entry(i, i) - row.iter().fold(real(0.0), |sum, &x| sum + x * x),
                };
                row.push(match above.and_then(|(_, above)| above.last()) {
                    Some(&pivot) => sum / pivot,
                    None => sum.sqrt(),
                });
            }
            rows.push((first, row));
        }
        Self { rows }
    }

    /// Solves in place.
    pub fn solve(&self, right: &mut [Real]) {
        for (i, (first, row)) in self.rows.iter().enumerate() {
            let (pivot, left) = split(row);
            let known = left.iter().zip(&right[*first..i]);
            let sum = known.fold(right[i], |sum, (&l, &x)| sum - l * x);
            right[i] = sum / pivot;
        }
        for (i, (first, row)) in self.rows.iter().enumerate().rev() {
            let (pivot, left) = split(row);
            let value = right[i] / pivot;
            right[i] = value;
            for (l, x) in left.iter().zip(&mut right[*first..i]) {
                *x -= *l * value;
            }
        }
    }
}

fn split(row: &[Real]) -> (Real, &[Real]) {
    row.split_last()
        .map_or((real(1.0), row), |(&pivot, left)| (pivot, left))
}

/// The product of two rows over the columns before `end`.
fn overlap(first: usize, row: &[Real], start: usize, above: &[Real], end: usize) -> Real {
    let from = first.max(start);
    let own = &row[from.saturating_sub(first).min(row.len())..];
    let other = &above[from.saturating_sub(start).min(above.len())..];
    let count = end.saturating_sub(from);
    let pairs = own.iter().zip(other).take(count);
    pairs.fold(real(0.0), |sum, (&a, &b)| sum + a * b)
}
