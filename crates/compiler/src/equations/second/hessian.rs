//! A symmetric matrix over (ϕ, v̄, v̄̇, τ), of which half is kept.

use crate::equations::Tree;
use crate::graph::Sym;
use num_traits::Zero;
use std::ops::Range;

/// The matrix.
pub(super) struct Hessian {
    rows: Vec<Vec<Sym>>,
    freedoms: usize,
    speeds: usize,
}

impl Hessian {
    /// Zeros.
    pub(super) fn new(tree: &Tree<'_>) -> Self {
        let [_, freedoms, speeds] = tree.model.sizes();
        let size = 2 * (freedoms + speeds);
        Self {
            rows: (0..size).map(|row| vec![Sym::zero(); row + 1]).collect(),
            freedoms,
            speeds,
        }
    }

    /// The place of a speed.
    pub(super) fn of_speed(&self, speed: usize) -> usize {
        self.freedoms + speed
    }

    /// The place of the rate of a speed.
    pub(super) fn of_rate(&self, speed: usize) -> usize {
        self.freedoms + self.speeds + speed
    }

    /// The place of an effort.
    pub(super) fn of_effort(&self, freedom: usize) -> usize {
        self.freedoms + 2 * self.speeds + freedom
    }

    /// The places of (ϕ, v̄).
    pub(super) fn of_state(&self) -> Range<usize> {
        0..self.freedoms + self.speeds
    }

    /// Adds to an entry and to that across the diagonal, which is the same.
    pub(super) fn add(&mut self, row: usize, column: usize, entry: Sym) {
        self.rows[row.max(column)][row.min(column)] += entry;
    }

    /// An entry.
    pub(super) fn entry(&self, row: usize, column: usize) -> Sym {
        self.rows[row.max(column)][row.min(column)]
    }

    /// The first rows, each up to the diagonal.
    pub(super) fn into_rows(mut self, count: usize) -> Vec<Vec<Sym>> {
        self.rows.truncate(count);
        self.rows
    }

    /// All that is kept.
    pub(super) fn entries_mut(&mut self) -> impl Iterator<Item = &mut Sym> {
        self.rows.iter_mut().flatten()
    }
}
