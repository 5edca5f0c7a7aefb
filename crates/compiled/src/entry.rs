//! What rows of a batch are made of.

use super::{LANES, Lanes, OneState, Quantities, States};
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::scalar::all_finite;

/// What rows of a [`Batch`](super::Batch) are made of: `f64`, a row for each state, or [`Lanes`], a row for eight states.
pub trait Entry: Copy + Send + Sync + private::Sealed {
    /// States of one row.
    const STATES: usize;

    /// Rows of these.
    #[doc(hidden)]
    fn states(rows: Quantities<'_, Self>) -> States<'_>;

    /// Computes what is asked for, of the states of one row; of all of them, or of those whose results are not finite.
    #[doc(hidden)]
    fn one_by_one(function: OneState, row: Quantities<'_, Self>, all: bool);
}

impl Entry for f64 {
    const STATES: usize = 1;

    fn states(rows: Quantities<'_, Self>) -> States<'_> {
        States::Rows(rows)
    }

    fn one_by_one(function: OneState, row: Quantities<'_, Self>, all: bool) {
        if all || !all_finite(row.results) {
            function(row.q, row.v, row.u, row.results);
        }
    }
}

impl Entry for Lanes {
    const STATES: usize = LANES;

    fn states(rows: Quantities<'_, Self>) -> States<'_> {
        States::SideBySide(rows)
    }

    fn one_by_one(function: OneState, row: Quantities<'_, Self>, all: bool) {
        let mut results = vec![];
        for state in 0..LANES {
            let is_done = row.results.iter().all(|number| number.0[state].is_finite());
            if is_done && !all {
                continue;
            }
            // Where there is nothing to be done nothing is allocated.
            results.resize(row.results.len(), 0.0);
            let [q, v, u] = [row.q, row.v, row.u].map(|row| of_state(row, state));
            function(&q, &v, &u, &mut results);
            for (lanes, &result) in row.results.iter_mut().zip(&results) {
                lanes.0[state] = result;
            }
        }
    }
}

/// The numbers of one state.
fn of_state(row: &[Lanes], state: usize) -> Vec<f64> {
    row.iter().map(|lanes| lanes.0[state]).collect()
}

impl Lanes {
    /// The numbers of eight states, each `width` long and one after the other, side by side: [`Batch`](super::Batch) takes rows of these. The last state
    /// is repeated where there are no eight.
    pub fn side_by_side(states: &[f64], width: usize) -> Vec<Self> {
        // A width of 0, and one beyond all numbers, make no state.
        let count = states.len().checked_div(width).unwrap_or(0);
        let entry = |group: usize, entry: usize| {
            let number =
                |lane: usize| states[(group * LANES + lane).min(count - 1) * width + entry];
            Self(core::array::from_fn(number))
        };
        let groups = 0..count.div_ceil(LANES);
        groups
            .flat_map(|group| (0..width).map(move |i| entry(group, i)))
            .collect()
    }

    /// The numbers of states, each `width` long, one after the other: the reverse of [`Lanes::side_by_side`], for whole groups of eight.
    pub fn apart(lanes: &[Self], width: usize) -> Vec<f64> {
        let groups = lanes.chunks_exact(width.max(1));
        groups
            .flat_map(|group| (0..LANES).flat_map(|state| of_state(group, state)))
            .collect()
    }
}

mod private {
    pub trait Sealed {}
    impl Sealed for f64 {}
    impl Sealed for super::Lanes {}
}
