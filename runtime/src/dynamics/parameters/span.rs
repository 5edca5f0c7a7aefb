//! Spaces of rows: which dimension they have, to a tolerance, and what is left of all rows beside them.

use alloc::vec::Vec;
use nalgebra::DVector;

/// A row, and its size before anything cancelled in it: what its rounding is measured by.
pub(super) struct Row {
    pub(super) entries: DVector<f64>,
    pub(super) size: f64,
}

impl Row {
    /// A row made of numbers of size 1: one that is smaller is what remained of them.
    pub(super) fn new(entries: DVector<f64>) -> Self {
        let size = entries.norm().max(1.0);
        Self { entries, size }
    }

    /// The difference of two rows.
    pub(super) fn difference(a: &DVector<f64>, b: &DVector<f64>) -> Self {
        Self {
            entries: a - b,
            size: a.norm() + b.norm(),
        }
    }

    fn ratio(&self) -> f64 {
        match self.size > 0.0 {
            true => self.entries.norm() / self.size,
            false => 0.0,
        }
    }
}

/// An orthonormal basis of the space that rows span.
#[derive(Clone, Debug)]
pub(super) struct Span {
    size: usize,
    basis: Vec<DVector<f64>>,
    /// What remained of the row that was the least of those that count, as a part of its size; 1 without any.
    pub(super) least: f64,
    /// What remained of the row that was the largest of those that do not.
    pub(super) most: f64,
}

impl Span {
    /// The span of rows with `size` entries. What remains of a row beside the others counts above `tolerance` times its size. The row of which
    /// most remains is always taken first.
    pub(super) fn new(size: usize, mut rows: Vec<Row>, tolerance: f64) -> Self {
        let mut span = Self {
            size,
            basis: Vec::new(),
            least: 1.0,
            most: 0.0,
        };
        while span.basis.len() < size {
            let ratios = rows.iter().map(Row::ratio).enumerate();
            let largest = ratios.fold((0, 0.0), |most, other| match other.1 > most.1 {
                true => other,
                false => most,
            });
            if largest.1 <= tolerance {
                span.most = largest.1;
                break;
            }
            span.least = span.least.min(largest.1);
            let new = rows[largest.0].entries.normalize();
            // Once more, for what rounding left of the others.
            let new = span.beside(&new).normalize();
            for row in &mut rows {
                row.entries -= &new * new.dot(&row.entries);
            }
            span.basis.push(new);
        }
        span
    }

    /// All rows of this size.
    pub(super) fn full(size: usize) -> Self {
        let unit = |i: usize| DVector::from_fn(size, |j, _| f64::from(u8::from(i == j)));
        Self {
            size,
            basis: (0..size).map(unit).collect(),
            least: 1.0,
            most: 0.0,
        }
    }

    pub(super) fn is_full(&self) -> bool {
        self.basis.len() == self.size
    }

    pub(super) fn basis(&self) -> &[DVector<f64>] {
        &self.basis
    }

    /// What remains of a vector beside the span.
    pub(super) fn beside(&self, vector: &DVector<f64>) -> DVector<f64> {
        let mut rest = vector.clone();
        for own in &self.basis {
            let along = own.dot(&rest);
            rest -= own * along;
        }
        rest
    }

    /// An orthonormal basis of what is orthogonal to the span.
    pub(super) fn complement(&self) -> Vec<DVector<f64>> {
        let mut all = self.clone();
        while !all.is_full() {
            let units = Self::full(self.size).basis;
            let rests = units.iter().map(|unit| all.beside(unit));
            let largest = rests.reduce(|most, other| match other.norm() > most.norm() {
                true => other,
                false => most,
            });
            let Some(largest) = largest else { break };
            let new = all.beside(&largest.normalize()).normalize();
            all.basis.push(new);
        }
        all.basis.split_off(self.basis.len())
    }
}

#[cfg(test)]
mod tests {
    use super::{Row, Span};
    use alloc::vec;
    use nalgebra::dvector;

    #[test]
    fn a_span_tells_rounding_from_rows() {
        let rows = vec![
            Row::new(dvector![1.0, 1.0, 0.0]),
            Row::difference(&dvector![3.0, 3.0, 1e-14], &dvector![1.0, 1.0, 0.0]),
            Row::new(dvector![0.0, 2.0, 0.0]),
        ];
        let span = Span::new(3, rows, 1e-10);
        assert_eq!(span.basis().len(), 2);
        assert!(span.most < 1e-14 && span.least > 0.5);
        let rest = span.complement();
        assert_eq!(rest.len(), 1);
        assert!((rest[0][2].abs() - 1.0).abs() < 1e-15);
    }
}
