//! The error of a motion, estimated by companion motions, as the summary and JSON tell it.

use super::plan::Plan;
use super::run::move_unrecorded;
use super::{control::Loop, run::Motion};
use hamel::dynamics::Dynamics;
use hamel::integrate::{
    ErrorParts, GlobalError, IntegrateError, Observer, Options, Solution, State,
};
use hamel_console::interrupt;
use serde::Serialize;
use std::fmt;
use std::sync::Arc;

/// The estimate of the error of a motion.
#[derive(Clone, Debug, Serialize)]
pub struct Accuracy {
    /// Of the last state.
    end: Parts,
    /// Of each sample, steps and rounding together.
    samples: Vec<Option<f64>>,
    /// Change of the last state per change of the initial speeds, each as a part of the largest of its joint in the motion; absent where it was not found.
    #[serde(skip_serializing_if = "Option::is_none")]
    conditioning: Option<f64>,
    /// Whether it is likely to be right within a factor of ten.
    reliable: bool,
    /// Why not, where it is not.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
    /// Evaluations of the equations of motion that the estimate took.
    evaluations: usize,
    /// Whether the user ended the estimate.
    #[serde(skip)]
    pub is_interrupted: bool,
}

/// An error, by where it comes from; `null` in JSON where it is not known.
#[derive(Clone, Copy, Debug, Serialize)]
struct Parts {
    total: Option<f64>,
    steps: Option<f64>,
    rounding: Option<f64>,
}

fn known(error: f64) -> Option<f64> {
    error.is_finite().then_some(error)
}

impl From<ErrorParts> for Parts {
    fn from(error: ErrorParts) -> Self {
        Self {
            total: known(error.total()),
            steps: known(error.steps),
            rounding: known(error.rounding),
        }
    }
}

impl Accuracy {
    /// That of `solution`, to which `dynamics` came under `plan`.
    pub fn estimate(plan: &Plan, dynamics: &mut dyn Dynamics, solution: &Solution) -> Self {
        let mut own: Self = estimate(plan, dynamics, solution).into();
        // Companions end at an interrupt; one that comes later has ended nothing.
        if !own.reliable && interrupt::is_requested() {
            own.is_interrupted = true;
            own.reason = Some("the estimate was interrupted".into());
        }
        own
    }

    /// The error of the last state in a few words.
    pub fn at_the_end(&self) -> String {
        let error = told(self.end.total);
        match self.reliable {
            true => format!("estimated error at the end {error}"),
            false => format!("estimated error at the end {error}, not reliable"),
        }
    }

    /// Of each sample, steps and rounding together; absent where it is not known.
    pub fn samples(&self) -> &[Option<f64>] {
        &self.samples
    }
}

/// The error of `solution`, to which `dynamics` came under `plan`. Companions are not ended by events, and follow a controller of their own.
pub fn estimate(plan: &Plan, dynamics: &mut dyn Dynamics, solution: &Solution) -> GlobalError {
    let (initial, options) = (plan.scene.start(), plan.options());
    let mut own = dynamics.of(Arc::clone(&plan.scene.mechanism));
    let mut companion = |initial: &State, options: &Options, observer: &mut Observer<'_>| {
        run(plan, &mut *dynamics, (initial, options, solution), observer)
            .map_err(|error| error.to_string())
    };
    GlobalError::estimate(&mut *own, &initial, &options, solution, &mut companion)
}

/// One companion of a motion, which an interrupt ends.
fn run(
    plan: &Plan,
    dynamics: &mut dyn Dynamics,
    (initial, options, of): (&State, &Options, &Solution),
    observer: &mut Observer<'_>,
) -> Result<Solution, IntegrateError> {
    // It was begun for the motion before.
    let control = Loop::new(plan).ok().flatten();
    let motion = Motion {
        plan,
        initial,
        options,
        control: control.as_ref(),
        companion_of: Some(of),
    };
    move_unrecorded(&motion, dynamics, observer)
}

impl From<GlobalError> for Accuracy {
    fn from(error: GlobalError) -> Self {
        let samples = error.samples.iter();
        Self {
            end: error.end.into(),
            samples: samples.map(|error| known(error.total())).collect(),
            conditioning: error.conditioning.and_then(known),
            reliable: error.doubt.is_none(),
            reason: error.doubt.map(|doubt| doubt.to_string()),
            evaluations: error.evaluations,
            is_interrupted: false,
        }
    }
}

fn told(error: Option<f64>) -> String {
    error.map_or("?".to_owned(), |error| format!("{error:.1e}"))
}

impl fmt::Display for Accuracy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Parts {
            total,
            steps,
            rounding,
        } = self.end;
        write!(
            f,
            "error       {} at the end, estimated: {} of steps, {} of rounding",
            told(total),
            told(steps),
            told(rounding)
        )?;
        if let Some(conditioning) = self.conditioning {
            write!(f, "; conditioning {conditioning:.1e}")?;
        }
        writeln!(f)?;
        match &self.reason {
            Some(reason) => writeln!(f, "            not reliable: {reason}"),
            None => Ok(()),
        }
    }
}
