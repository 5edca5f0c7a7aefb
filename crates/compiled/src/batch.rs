//! Many states of one compiled scene: rows of Q, v̄ and inputs in, rows of results out.

use super::{Entry, Equations, Level, ManyStates, OneState, Quantities};
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
    /// Speeds that are no whole number of rows.
    #[error("{found} speeds are no whole number of rows of `{scene}`, which has {row}")]
    Partial {
        /// The scene that was compiled.
        scene: &'static str,
        /// Speeds of one row.
        row: usize,
        /// What was given.
        found: usize,
    },
    /// Other quantities have not as many rows as the speeds.
    #[error("a batch of {rows} rows of `{scene}`: {mistakes}")]
    Sizes {
        /// The scene that was compiled.
        scene: &'static str,
        /// Rows by the number of speeds.
        rows: usize,
        /// Every quantity of another size, with what it must have and what it has.
        mistakes: String,
    },
}

/// States of one task where several threads share a batch: a multiple of eight, some ten microseconds of work.
#[cfg(feature = "rayon")]
const TASK: usize = 128;

/// A compiled scene for many states at once.
///
/// A row of `q` holds `configuration` numbers, one of `v` and of results `speeds`, one of τ `freedoms`, each in the mechanism's layout. Rows are of `f64`,
/// one for each state, or of [`Lanes`](super::Lanes), one for eight states side by side, which saves turning rows into lanes and back: a fifth of the time and more.
/// Modules compiled with lanes take eight states at a time at the [`Level`] that was chosen; others take them one by one. A state's
/// results depend on that state and the level alone: not on the other states, nor on the number of threads. Between levels they
/// differ by rounding. A state without finite results (a singular mass, an angle beyond 8e5 rad) is computed again in `f64`, so that what
/// is not finite then is not finite in [`Equations`] either. Nothing allocates but this where states are side by side, and what `rayon` itself needs for its tasks.
#[derive(Clone, Copy, Debug)]
pub struct Batch {
    equations: &'static Equations,
    level: Level,
}

/// One call: what is asked for, checked.
#[derive(Clone, Copy)]
struct Call<'a, N> {
    one: OneState,
    many: Option<ManyStates>,
    level: Level,
    /// Numbers of a row: Q, v̄, inputs.
    row: [usize; 3],
    /// Those of all rows.
    of: [&'a [N]; 3],
}

impl Batch {
    /// At the best level that the machine has.
    pub fn new(equations: &'static Equations) -> Self {
        let level = Level::default();
        Self { equations, level }
    }

    /// At a given level.
    ///
    /// # Errors
    /// A level that the machine does not have.
    pub fn at(equations: &'static Equations, level: Level) -> Result<Self, BatchError> {
        match level.is_available() {
            true => Ok(Self { equations, level }),
            false => Err(BatchError::Level(level)),
        }
    }

    /// The level at which it computes.
    pub fn level(&self) -> Level {
        self.level
    }

    /// Accelerations v̄̇ of all states, (24), (34), on this thread.
    ///
    /// # Errors
    /// A module without forward dynamics; numbers that are no whole rows, or not the same number of rows in all arguments.
    pub fn forward_dynamics<N: Entry>(
        &self,
        q: &[N],
        v: &[N],
        tau: &[N],
        rates: &mut [N],
    ) -> Result<(), BatchError> {
        self.forward(q, v, tau, rates)?.run(0, rates);
        Ok(())
    }

    /// Efforts τ̄ that the accelerations `a` take at all states, (24), (34), on this thread.
    ///
    /// # Errors
    /// A module without inverse dynamics; numbers that are no whole rows, or not the same number of rows in all arguments.
    pub fn inverse_dynamics<N: Entry>(
        &self,
        q: &[N],
        v: &[N],
        a: &[N],
        efforts: &mut [N],
    ) -> Result<(), BatchError> {
        self.inverse(q, v, a, efforts)?.run(0, efforts);
        Ok(())
    }

    /// [`Batch::forward_dynamics`] on the threads of rayon's current pool.
    ///
    /// # Errors
    /// Those of [`Batch::forward_dynamics`].
    #[cfg(feature = "rayon")]
    pub fn par_forward_dynamics<N: Entry>(
        &self,
        q: &[N],
        v: &[N],
        tau: &[N],
        rates: &mut [N],
    ) -> Result<(), BatchError> {
        self.forward(q, v, tau, rates)?.share(rates);
        Ok(())
    }

    /// [`Batch::inverse_dynamics`] on the threads of rayon's current pool.
    ///
    /// # Errors
    /// Those of [`Batch::inverse_dynamics`].
    #[cfg(feature = "rayon")]
    pub fn par_inverse_dynamics<N: Entry>(
        &self,
        q: &[N],
        v: &[N],
        a: &[N],
        efforts: &mut [N],
    ) -> Result<(), BatchError> {
        self.inverse(q, v, a, efforts)?.share(efforts);
        Ok(())
    }

    fn forward<'a, N: Entry>(
        &self,
        q: &'a [N],
        v: &'a [N],
        tau: &'a [N],
        rates: &[N],
    ) -> Result<Call<'a, N>, BatchError> {
        let equations = self.equations;
        let function = (
            equations.forward_dynamics,
            equations.in_lanes.forward_dynamics,
        );
        let inputs = ("efforts", equations.freedoms, tau);
        self.call(
            "forward dynamics",
            function,
            [q, v],
            inputs,
            ("rates", rates),
        )
    }

    fn inverse<'a, N: Entry>(
        &self,
        q: &'a [N],
        v: &'a [N],
        a: &'a [N],
        efforts: &[N],
    ) -> Result<Call<'a, N>, BatchError> {
        let equations = self.equations;
        let function = (
            equations.inverse_dynamics,
            equations.in_lanes.inverse_dynamics,
        );
        let inputs = ("accelerations", equations.speeds, a);
        self.call(
            "inverse dynamics",
            function,
            [q, v],
            inputs,
            ("efforts", efforts),
        )
    }

    /// The call, where sizes fit: as many rows in all arguments as in the speeds.
    fn call<'a, N: Entry>(
        &self,
        function: &'static str,
        (one, many): (Option<OneState>, Option<ManyStates>),
        [q, v]: [&'a [N]; 2],
        (inputs, width, u): (&'static str, usize, &'a [N]),
        (outputs, results): (&'static str, &[N]),
    ) -> Result<Call<'a, N>, BatchError> {
        let Equations {
            scene,
            configuration,
            speeds,
            ..
        } = *self.equations;
        let one = one.ok_or(BatchError::Missing { scene, function })?;
        // A scene without speeds has no results whatever the number of its states.
        let rows = v.len().checked_div(speeds).unwrap_or(0);
        if rows * speeds != v.len() {
            return Err(BatchError::Partial {
                scene,
                row: speeds,
                found: v.len(),
            });
        }
        // What no vector can hold is no size of one.
        let sizes = [
            ("configuration", rows.saturating_mul(configuration), q.len()),
            (inputs, rows.saturating_mul(width), u.len()),
            (outputs, rows * speeds, results.len()),
        ];
        if let Some(mistakes) = mistakes(sizes) {
            return Err(BatchError::Sizes {
                scene,
                rows,
                mistakes,
            });
        }
        Ok(Call {
            one,
            many,
            level: self.level,
            row: [configuration, speeds, width],
            of: [q, v, u],
        })
    }
}

/// What is wrong with sizes, given as name, right number and what was found.
fn mistakes(sizes: [(&'static str, usize, usize); 3]) -> Option<String> {
    let mut text = String::new();
    for (quantity, expected, found) in sizes {
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
    fn run(&self, first: usize, results: &mut [N]) {
        let Some(rows) = results.len().checked_div(self.row[1]) else {
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
        for (row, results) in results.chunks_exact_mut(self.row[1]).enumerate() {
            let [q, v, u] = self.rows(first + row, 1);
            N::one_by_one(self.one, Quantities { q, v, u, results }, all);
        }
    }

    fn rows(&self, first: usize, rows: usize) -> [&[N]; 3] {
        core::array::from_fn(|i| &self.of[i][first * self.row[i]..(first + rows) * self.row[i]])
    }

    #[cfg(feature = "rayon")]
    fn share(&self, results: &mut [N]) {
        use rayon::prelude::*;
        let rows = TASK / N::STATES;
        let task = rows * self.row[1].max(1);
        results
            .par_chunks_mut(task)
            .enumerate()
            .for_each(|(number, results)| self.run(number * rows, results));
    }
}
