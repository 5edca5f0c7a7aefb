//! `--accuracy`: the tolerance that a motion needs for the error that was asked for.

use super::accuracy::estimate;
use super::control::Loop;
use super::plan::Plan;
use super::progress;
use super::run::{Motion, move_unrecorded};
use hamel::integrate::{GlobalError, IntegrateError, Solution, Tuned, no_observer};
use hamel_console::interrupt::{self, Heed};
use hamel_console::output::Failure;
use hamel_scene::Arithmetic;
use serde::Serialize;
use std::fmt;

/// What came of an accuracy that was asked for.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Request {
    /// The error that was asked for.
    wanted: f64,
    /// Whether the estimated error is as small.
    reached: bool,
    /// The tolerance that was found for it.
    tolerance: f64,
    /// The part of the error that no tolerance makes smaller.
    #[serde(skip)]
    rounding: f64,
    #[serde(skip)]
    is_refined: bool,
}

impl Request {
    /// Settles the method and the tolerance of `plan`, by motions that are integrated for this alone, if it asks for an accuracy.
    ///
    /// # Errors
    /// Those of a simulation; an interrupt.
    pub fn settle(plan: &mut Plan, quiet: bool) -> Result<(), Failure> {
        let Some(wanted) = plan.settings.accuracy else {
            return Ok(());
        };
        let progress = progress::working("looking for the tolerance", quiet);
        let heed = Heed::begin();
        let found = Tuned::search(wanted, |tolerance| {
            plan.choose(tolerance)?;
            progress.set_message(format!("looking for the tolerance: {tolerance:.1e}"));
            attempt(plan)
        });
        drop(heed);
        progress.finish_and_clear();
        let Tuned {
            tolerance,
            error,
            is_reached,
            ..
        } = found?;
        plan.choose(tolerance)?;
        plan.request = Some(Self {
            wanted,
            reached: is_reached,
            tolerance,
            rounding: error.rounding,
            is_refined: plan.settings.arithmetic == Arithmetic::Refined,
        });
        Ok(())
    }
}

/// The motion of `plan`, unrecorded, and the estimate of its error.
fn attempt(plan: &Plan) -> Result<GlobalError, Failure> {
    let mut dynamics = plan.settings.arithmetic.dynamics(&plan.scene.mechanism);
    let control = Loop::new(plan)?;
    let (initial, options) = (plan.scene.start(), plan.options());
    let motion = Motion {
        plan,
        initial: &initial,
        options: &options,
        control: control.as_ref(),
        is_companion: false,
    };
    let moved = move_unrecorded(&motion, &mut *dynamics, &mut no_observer);
    let solution = solution(moved, control.as_ref())?;
    Ok(estimate(plan, &mut *dynamics, &solution))
}

fn solution(
    moved: Result<Solution, IntegrateError>,
    control: Option<&Loop>,
) -> Result<Solution, Failure> {
    if interrupt::is_requested() {
        return Err(Failure::Interrupted(
            "the search for the tolerance was ended: no file was written".into(),
        ));
    }
    moved.map_err(|error| {
        let failure = control.and_then(Loop::failure);
        Failure::Simulation(failure.unwrap_or_else(|| error.to_string()))
    })
}

impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            wanted, rounding, ..
        } = *self;
        if self.reached {
            return write!(f, "an error of at most {wanted:.1e} was asked for");
        }
        write!(
            f,
            "not reached: an error of at most {wanted:.1e} was asked for, "
        )?;
        match rounding > wanted {
            false => write!(f, "and no smaller tolerance makes it smaller"),
            true if self.is_refined => {
                write!(f, "rounding of the state alone makes {rounding:.1e}")
            }
            true => write!(
                f,
                "rounding in doubles alone makes {rounding:.1e}; `--arithmetic refined` leaves out that of the accelerations"
            ),
        }
    }
}
