//! The relations of ties at a configuration, as systems of equations for the dependent coordinates.
//!
//! One type of joint has room for any number of relations; what is computed is of those that there are.

use super::closed::{MOST_INDEPENDENT, MOST_RELATIONS};
use super::{Coordinates, Coupled, MOST_LINKS};
use crate::finite;
use crate::scalar::{Dual, Scalar};
use nalgebra::{SMatrix, SVector};

/// A matrix by columns, of at most ROOM entries.
pub(super) struct Columns<T, const ROOM: usize> {
    entries: [T; ROOM],
    rows: usize,
    columns: usize,
}

/// Of as many rows and columns as there are relations.
pub(super) type Square<T> = Columns<T, { MOST_RELATIONS * MOST_RELATIONS }>;

/// Of a row for each relation, and a column for each independent coordinate.
pub(super) type Sides<T> = Columns<T, { MOST_RELATIONS * MOST_INDEPENDENT }>;

impl<T: Scalar, const ROOM: usize> Columns<T, ROOM> {
    /// Of zeros.
    #[inline]
    pub(super) fn new(rows: usize, columns: usize) -> Self {
        Self {
            entries: [T::zero(); ROOM],
            rows,
            columns,
        }
    }

    pub(super) fn as_slice(&self) -> &[T] {
        &self.entries[..self.rows * self.columns]
    }

    pub(super) fn as_mut_slice(&mut self) -> &mut [T] {
        &mut self.entries[..self.rows * self.columns]
    }

    /// Column after column; none of a matrix without rows.
    pub(super) fn columns(&self) -> impl Iterator<Item = &[T]> {
        self.as_slice().chunks_exact(self.rows.max(1))
    }

    /// Column after column; none of a matrix without rows.
    pub(super) fn columns_mut(&mut self) -> impl Iterator<Item = &mut [T]> {
        let rows = self.rows.max(1);
        self.as_mut_slice().chunks_exact_mut(rows)
    }
}

/// g(q), with its derivatives along the coordinates.
pub(super) struct Equations<T> {
    values: SVector<T, MOST_RELATIONS>,
    /// A row for each relation, and a column for each coordinate.
    slopes: Columns<T, { MOST_RELATIONS * MOST_LINKS }>,
    independent: usize,
}

impl<const K: usize> Coupled<K> {
    /// Those at q.
    #[inline]
    pub(super) fn equations<T: Scalar>(&self, q: &Coordinates<T>) -> Equations<T> {
        let mut equations = Equations {
            values: SVector::zeros(),
            slopes: Columns::new(self.relation_count(), self.coordinate_count()),
            independent: K,
        };
        // Apart, so that a result of this size is made in its place and not copied there.
        self.fill(q, &mut equations);
        equations
    }

    fn fill<T: Scalar>(&self, q: &Coordinates<T>, into: &mut Equations<T>) {
        let q = &q.as_slice()[..self.coordinate_count()];
        let mut i = 0;
        for tie in self.ties.as_slice() {
            tie.relations(&self.links, q, |(value, row)| {
                into.values[i] = value;
                for (column, slope) in into.slopes.columns_mut().zip(row) {
                    column[i] = slope;
                }
                i += 1;
            });
        }
    }
}

impl<T: Scalar> Equations<T> {
    /// The columns of the independent coordinates, and of the dependent ones.
    pub(super) fn split_mut(&mut self) -> (&mut [T], &mut [T]) {
        let first = self.independent * self.slopes.rows;
        self.slopes.as_mut_slice().split_at_mut(first)
    }

    /// The values, to first order, after q is led on by `ahead`.
    pub(super) fn led(&self, ahead: &Coordinates<T>) -> SVector<T, MOST_RELATIONS> {
        let mut values = self.values;
        for (column, ahead) in self.slopes.columns().zip(ahead.iter()) {
            for (value, slope) in values.iter_mut().zip(column) {
                *value = slope.mul_add(*ahead, *value);
            }
        }
        values
    }

    /// The shortest displacement at which the relations hold, to first order: `−∂gᵀ (∂g ∂gᵀ)⁻¹ g`.
    pub(super) fn shortest(&self) -> Coordinates<T> {
        let count = self.slopes.rows;
        let mut squares = Square::new(count, count);
        for slopes in self.slopes.columns() {
            for (column, factor) in squares.columns_mut().zip(slopes) {
                for (entry, slope) in column.iter_mut().zip(slopes) {
                    *entry = slope.mul_add(*factor, *entry);
                }
            }
        }
        let mut weights = self.values;
        let weights = &mut weights.as_mut_slice()[..count];
        finite::solve(count, squares.as_mut_slice(), weights);
        let mut shortest = Coordinates::zeros();
        for (entry, slopes) in shortest.iter_mut().zip(self.slopes.columns()) {
            let pairs = slopes.iter().zip(weights.iter());
            *entry = -pairs.fold(T::zero(), |sum, (slope, weight)| {
                slope.mul_add(*weight, sum)
            });
        }
        shortest
    }
}

impl<T: Scalar> Equations<Dual<T>> {
    /// ∂g of the dependent coordinates, without its derivatives.
    pub(super) fn dependent(&self) -> Square<T> {
        let count = self.slopes.rows;
        let mut own = Square::new(count, count);
        let columns = self.slopes.columns().skip(self.independent);
        for (own, column) in own.columns_mut().zip(columns) {
            for (own, slope) in own.iter_mut().zip(column) {
                *own = slope.value;
            }
        }
        own
    }

    /// The derivative of ∂g times the rates of all coordinates.
    pub(super) fn changes<const K: usize>(&self, rates: &SMatrix<T, MOST_LINKS, K>) -> Sides<T> {
        let mut changes = Sides::new(self.slopes.rows, K);
        for (k, own) in changes.columns_mut().enumerate() {
            for (slopes, rate) in self.slopes.columns().zip(rates.column(k).iter()) {
                for (own, slope) in own.iter_mut().zip(slopes) {
                    *own = slope.derivative().mul_add(*rate, *own);
                }
            }
        }
        changes
    }
}
