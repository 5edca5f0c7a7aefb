//! One call for many states: sizes are checked, then rows go through together, and those without finite results once more by themselves.

use super::Batch;
use crate::{Entry, Level, ManyStates, OneState, Quantities};
use alloc::string::String;
use core::fmt::Write;

/// Why a batch is not computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BatchError {
    /// The module was compiled without the function.
    #[error(
        "the equations compiled for `{scene}` have no {function}: compile it with this function"
    )]
    Missing {
        /// The scene that was compiled.
        scene: &'static str,
        /// The function.
        function: &'static str,
    },
    /// The level of SIMD instructions is not that of this machine.
    #[error("this machine, or this build without the feature `levels`, has no {0:?}")]
    Level(Level),
    /// The numbers that say how many rows there are, speeds or those of Q, are no whole number of rows.
    #[error("{found} {quantity} are no whole number of rows of `{scene}`, which has {row}")]
    Partial {
        /// The scene that was compiled.
        scene: &'static str,
        /// Speeds, or numbers of the configuration where no speeds are asked for.
        quantity: &'static str,
        /// Numbers of one row.
        row: usize,
        /// What was given.
        found: usize,
    },
    /// Other quantities have not as many rows.
    #[error("a batch of {rows} rows of `{scene}`: {mistakes}")]
    Sizes {
        /// The scene that was compiled.
        scene: &'static str,
        /// Rows by the number of speeds, or of those of Q.
        rows: usize,
        /// Every quantity of another size, with what it must have and what it has.
        mistakes: String,
    },
}

/// States of one task where several threads share a batch: a multiple of eight, some ten microseconds of work.
#[cfg(feature = "rayon")]
const TASK: usize = 128;

/// A function: its name, and it of one state and of many.
pub(super) type Asked = (&'static str, (Option<OneState>, Option<ManyStates>));

/// A quantity: its name, numbers of a row, and those of all rows.
pub(super) type Numbers<'a, N> = (&'static str, usize, &'a [N]);

/// One call: what is asked for, checked.
#[derive(Clone, Copy)]
pub(super) struct Call<'a, N> {
    pub(super) one: OneState,
    pub(super) many: Option<ManyStates>,
    pub(super) level: Level,
    /// Numbers of a row: Q, v̄, inputs.
    pub(super) row: [usize; 3],
    /// Numbers of a row of results.
    pub(super) width: usize,
    /// Those of all rows.
    pub(super) of: [&'a [N]; 3],
}

impl Batch {
    /// How many rows there are of a quantity.
    pub(super) fn rows<N>(&self, (quantity, row, of): Numbers<'_, N>) -> Result<usize, BatchError> {
        // A scene without speeds has no results whatever the number of its states.
        let rows = of.len().checked_div(row).unwrap_or(0);
        match rows * row == of.len() {
            true => Ok(rows),
            false => Err(BatchError::Partial {
                scene: self.equations.scene,
                quantity,
                row,
                found: of.len(),
            }),
        }
    }

    /// Whether all quantities have as many rows.
    pub(super) fn check<N, const COUNT: usize>(
        &self,
        rows: usize,
        sizes: [Numbers<'_, N>; COUNT],
    ) -> Result<(), BatchError> {
        // What no vector can hold is no size of one.
        let sizes = sizes.map(|(name, row, of)| (name, rows.saturating_mul(row), of.len()));
        match mistakes(&sizes) {
            None => Ok(()),
            Some(mistakes) => Err(BatchError::Sizes {
                scene: self.equations.scene,
                rows,
                mistakes,
            }),
        }
    }
}

/// What is wrong with sizes, given as name, right number and what was found.
fn mistakes(sizes: &[(&'static str, usize, usize)]) -> Option<String> {
    let mut text = String::new();
    for &(quantity, expected, found) in sizes {
        if expected != found {
            let stop = if text.is_empty() { "" } else { "; " };
            // Writing to a string does not fail.
            _ = write!(
                text,
                "{stop}{quantity} must have {expected} numbers, not {found}"
            );
        }
    }
    (!text.is_empty()).then_some(text)
}

impl<N: Entry> Call<'_, N> {
    /// Results of rows from `first`, as many as there is room for.
    pub(super) fn run(&self, first: usize, results: &mut [N]) {
        let Some(rows) = results.len().checked_div(self.width) else {
            return;
        };
        if let Some(many) = self.many {
            let [q, v, u] = self.rows(first, rows);
            let results = &mut *results;
            if many(self.level, N::states(Quantities { q, v, u, results })) {
                return;
            }
        }
        let all = self.many.is_none();
        for (row, results) in results.chunks_exact_mut(self.width).enumerate() {
            let [q, v, u] = self.rows(first + row, 1);
            N::one_by_one(self.one, Quantities { q, v, u, results }, all);
        }
    }

    fn rows(&self, first: usize, rows: usize) -> [&[N]; 3] {
        core::array::from_fn(|i| &self.of[i][first * self.row[i]..(first + rows) * self.row[i]])
    }

    #[cfg(feature = "rayon")]
    pub(super) fn share(&self, results: &mut [N]) {
        use rayon::prelude::*;
        let rows = TASK / N::STATES;
        let task = rows * self.width.max(1);
        results
            .par_chunks_mut(task)
            .enumerate()
            .for_each(|(number, results)| self.run(number * rows, results));
    }
}
