//! Rows of linear conditions in reduced echelon form, and what meets all of them.

use super::{BITS, zero};
use hamel_codegen::precise::Precise;

/// Entries below this part of a row's largest, as powers of two, are rounding.
const ROUNDING: f64 = -64.0;

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

    /// Adds a condition; whether it says anything new.
    pub(super) fn add(&mut self, row: &[Precise]) -> bool {
        let Some((_, size)) = largest(row) else {
            return false;
        };
        let mut row = row.to_vec();
        for (pivot, own) in &self.rows {
            subtract(&mut row, *pivot, own);
        }
        let Some((place, _)) = largest(&row).filter(|(_, left)| left - size > ROUNDING) else {
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
    pub(super) fn null_space(&self) -> Vec<Vec<f64>> {
        let is_pivot = |column: &usize| self.rows.iter().any(|(pivot, _)| pivot == column);
        let free = (0..self.columns).filter(|column| !is_pivot(column));
        free.map(|column| {
            let mut solution = vec![0.0; self.columns];
            solution[column] = 1.0;
            for (pivot, row) in &self.rows {
                // What is left of zeros is far below doubles.
                let entry = -row[column].to_f64();
                solution[*pivot] = if entry.abs() < f64::EPSILON.powi(2) {
                    0.0
                } else {
                    entry
                };
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

/// Place and binary logarithm of the largest entry, unless all are 0.
fn largest(row: &[Precise]) -> Option<(usize, f64)> {
    let sizes = row.iter().enumerate().filter(|(_, entry)| !entry.is_zero());
    let sizes = sizes.map(|(place, entry)| (place, entry.abs().log2()));
    sizes.reduce(|most, other| if other.1 > most.1 { other } else { most })
}
