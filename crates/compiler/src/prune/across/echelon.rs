//! Rows of linear conditions in reduced echelon form, and what meets all of them.

use super::{BITS, ROUNDING, size, zero};
use hamel_codegen::precise::Precise;

pub(super) struct Echelon {
    columns: usize,
    /// Each with the place of its 1, where all others have 0.
    rows: Vec<(usize, Vec<Precise>)>,
}

impl Echelon {
    pub(super) fn new(columns: usize) -> Self {
        let rows = vec![];
        Self { columns, rows }
    }

    /// Adds a condition among others whose largest entry has this binary logarithm; whether it says anything new.
    pub(super) fn add(&mut self, row: &[Precise], of_all: f64) -> bool {
        let mut row = row.to_vec();
        for (pivot, own) in &self.rows {
            subtract(&mut row, *pivot, own);
        }
        let sizes = row.iter().map(size).enumerate();
        let largest = sizes.reduce(|most, other| if other.1 > most.1 { other } else { most });
        let Some((place, _)) = largest.filter(|(_, left)| left - of_all > ROUNDING) else {
            return false;
        };
        let one = Precise::integer(1, BITS);
        let scale = &one / &row[place];
        row.iter_mut().for_each(|entry| *entry = &*entry * &scale);
        for (_, own) in &mut self.rows {
            subtract(own, place, &row);
        }
        self.rows.push((place, row));
        true
    }

    /// A basis of what meets all conditions.
    pub(super) fn null_space(&self) -> Vec<Vec<Precise>> {
        let is_pivot = |column: &usize| self.rows.iter().any(|(pivot, _)| pivot == column);
        let free = (0..self.columns).filter(|column| !is_pivot(column));
        free.map(|column| {
            let mut solution = vec![zero(); self.columns];
            solution[column] = Precise::integer(1, BITS);
            for (pivot, row) in &self.rows {
                solution[*pivot] = -&row[column];
            }
            solution
        })
        .collect()
    }
}

/// Takes a row times the entry at its pivot away.
fn subtract(row: &mut [Precise], pivot: usize, own: &[Precise]) {
    let factor = row[pivot].clone();
    if factor.is_zero() {
        return;
    }
    for (entry, own) in row.iter_mut().zip(own) {
        *entry = &*entry - &(&factor * own);
    }
    row[pivot] = zero();
}
