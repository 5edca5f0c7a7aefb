//! What is settled by motions before the one that is recorded: the tolerance that `--accuracy` needs, and the arithmetic where it is left open.

use super::accuracy::estimate;
use super::control::Loop;
use super::plan::Plan;
use super::progress;
use super::run::{Motion, move_unrecorded};
use hamel::dynamics::Dynamics;
use hamel::integrate::{Solution, Tuned, no_observer};
use hamel_console::interrupt::{self, Heed};
use hamel_console::output::Failure;
use hamel_scene::Arithmetic;
use serde::Serialize;
use std::fmt;

/// What came of an accuracy that was asked for.
#[derive(Clone, Debug, Serialize)]
pub struct Request {
    /// The error that was asked for.
    wanted: f64,
    /// Whether the estimated error is as small, and the estimate reliable.
    reached: bool,
    /// The tolerance that was found for it.
    tolerance: f64,
    /// Why it is not reached, if it is not.
    #[serde(skip_serializing_if = "Option::is_none", rename = "reason")]
    shortfall: Option<String>,
    /// Whether it may be reached all the same: the error is told as small enough, by an estimate that is not reliable.
    #[serde(skip)]
    is_open: bool,
}

/// Why an accuracy is not reached.
struct Shortfall<'a> {
    wanted: f64,
    found: &'a Tuned,
    is_refined: bool,
}

impl fmt::Display for Shortfall<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounding = self.found.error.rounding;
        match &self.found.doubt {
            _ if rounding > self.wanted && self.is_refined => {
                write!(f, "rounding of the state alone makes {rounding:.1e}")
            }
            _ if rounding > self.wanted => write!(
                f,
                "rounding in doubles alone makes {rounding:.1e}; `--arithmetic refined` leaves out that of the accelerations"
            ),
            Some(doubt) => write!(
                f,
                "the estimate is not reliable at any tolerance that was tried: {doubt}"
            ),
            None => write!(f, "no smaller tolerance makes it smaller"),
        }
    }
}

impl Request {
    /// Settles the method and the tolerance of `plan`, if it asks for an accuracy, and the arithmetic, if that is left open, by motions that are integrated for
    /// this alone.
    ///
    /// # Errors
    /// Those of a simulation; an interrupt.
    pub fn settle(plan: &mut Plan, quiet: bool) -> Result<(), Failure> {
        let Some(wanted) = plan.settings.accuracy else {
            return settle_arithmetic(plan, quiet);
        };
        let found = match search(plan, wanted, quiet) {
            Err(Ended::ByRounding(reason)) => {
                plan.settle_arithmetic(Some(reason));
                search(plan, wanted, quiet)
            }
            found => found,
        };
        let found = found.map_err(Ended::into_failure)?;
        plan.settle_arithmetic(None);
        plan.choose(found.tolerance)?;
        let shortfall = Shortfall {
            wanted,
            found: &found,
            is_refined: plan.settings.arithmetic == Arithmetic::Refined,
        };
        plan.request = Some(Self {
            wanted,
            reached: found.is_reached,
            tolerance: found.tolerance,
            shortfall: (!found.is_reached).then(|| shortfall.to_string()),
            is_open: found.error.total() <= wanted,
        });
        Ok(())
    }

    /// Whether the estimated error is as small as was asked, and the estimate reliable.
    pub const fn is_reached(&self) -> bool {
        self.reached
    }
}

/// Settles the arithmetic of `plan` by a motion in doubles, if it is left open.
fn settle_arithmetic(plan: &mut Plan, quiet: bool) -> Result<(), Failure> {
    if plan.settings.arithmetic != Arithmetic::Auto {
        return Ok(());
    }
    let progress = progress::working("trying doubles", quiet);
    let heed = Heed::begin();
    let tried = attempt(plan).map(|(solution, _)| reason_to_refine(plan, &solution));
    drop(heed);
    progress.finish_and_clear();
    match tried {
        Ok(reason) => plan.settle_arithmetic(reason),
        Err(Ended::ByRounding(reason)) => plan.settle_arithmetic(Some(reason)),
        Err(Ended::Failed(failure)) => return Err(failure),
    }
    Ok(())
}

/// Why a motion that is made before the one that is recorded comes to nothing.
enum Ended {
    /// It wants refined arithmetic, for this reason, which is left open.
    ByRounding(String),
    Failed(Failure),
}

impl Ended {
    fn into_failure(self) -> Failure {
        match self {
            Self::ByRounding(reason) => Failure::Simulation(reason),
            Self::Failed(failure) => failure,
        }
    }
}

impl From<Failure> for Ended {
    fn from(failure: Failure) -> Self {
        Self::Failed(failure)
    }
}

/// The tolerance with which the motion of `plan` has an error of at most `wanted`, or its least error.
fn search(plan: &mut Plan, wanted: f64, quiet: bool) -> Result<Tuned, Ended> {
    let progress = progress::working("looking for the tolerance", quiet);
    let heed = Heed::begin();
    let mut limited = None;
    let found = Tuned::search(wanted, |tolerance| {
        plan.choose(tolerance)?;
        progress.set_message(format!("looking for the tolerance: {tolerance:.1e}"));
        let (solution, mut dynamics) = attempt(plan)?;
        limited = limited.take().or_else(|| reason_to_refine(plan, &solution));
        Ok::<_, Ended>(estimate(plan, &mut *dynamics, &solution))
    });
    drop(heed);
    progress.finish_and_clear();
    let found = found?;
    let (rounding, is_open) = (
        found.error.rounding,
        plan.settings.arithmetic == Arithmetic::Auto,
    );
    let alone = (is_open && rounding > wanted)
        .then(|| format!("rounding in doubles alone makes an error of {rounding:.1e}"));
    match limited.or(alone) {
        Some(reason) if !found.is_reached => Err(Ended::ByRounding(reason)),
        _ => Ok(found),
    }
}

fn reason_to_refine(plan: &Plan, solution: &Solution) -> Option<String> {
    plan.settings.arithmetic.reason_to_refine(Ok(solution))
}

/// The motion of `plan`, unrecorded, and the equations that it follows.
fn attempt(plan: &Plan) -> Result<(Solution, Box<dyn Dynamics>), Ended> {
    let arithmetic = plan.settings.arithmetic;
    let mut dynamics = arithmetic.dynamics(&plan.scene.mechanism);
    let control = Loop::new(plan)?;
    let (initial, options) = (plan.scene.start(), plan.options());
    let motion = Motion {
        plan,
        initial: &initial,
        options: &options,
        control: control.as_ref(),
        companion_of: None,
    };
    let moved = move_unrecorded(&motion, &mut *dynamics, &mut no_observer);
    if interrupt::is_requested() {
        let told = "the motions before the one that is recorded were ended: no file was written";
        return Err(Failure::Interrupted(told.into()).into());
    }
    match moved {
        Ok(solution) => Ok((solution, dynamics)),
        Err(error) => {
            let failure = control.as_ref().and_then(Loop::failure);
            Err(match arithmetic.reason_to_refine(Err(&error)) {
                Some(reason) if failure.is_none() => Ended::ByRounding(reason),
                _ => Failure::Simulation(failure.unwrap_or_else(|| error.to_string())).into(),
            })
        }
    }
}

impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let wanted = self.wanted;
        let what = match self.is_open {
            true => "not confirmed",
            false => "not reached",
        };
        match &self.shortfall {
            None => write!(f, "an error of at most {wanted:.1e} was asked for"),
            Some(shortfall) => write!(
                f,
                "{what}: an error of at most {wanted:.1e} was asked for, and {shortfall}"
            ),
        }
    }
}
