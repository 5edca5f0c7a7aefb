//! Whether a motion comes to its end in a time that anybody waits for.

use super::flow::Flow;
use super::rounding::Rounding;
use super::{Choice, IntegrateError, Method, Options, State, Statistics, Wanted};
use alloc::format;
use alloc::string::String;

/// Steps after which it is looked at again.
const STEPS: usize = 4096;

/// Evaluations of the equations, times bodies, before which nothing is said: some ten seconds on one core.
const PATIENCE: f64 = 2e7;

/// So many times the work done so far is too much: a night or more.
const HOPELESS: f64 = 3e3;

/// So many steps still to come are too many for a stiff mechanism, from the first look on: half a month for the smallest one.
const ENDLESS: f64 = 1e13;

/// So many steps still to come are many enough to ask whether the rounding of Q makes them short: some seconds for the smallest mechanism.
const MANY: f64 = 1e6;

/// Steps that are less than this part of those before still shrink.
const SHRINKS: f64 = 0.1;

/// What is known of the pace of a motion.
#[derive(Debug)]
pub(super) struct Prospect {
    /// When it was looked at last, s.
    time: f64,
    /// How many steps there were by then.
    steps: usize,
    /// The mean of those before, s.
    step: f64,
}

impl Prospect {
    pub(super) const fn new(time: f64) -> Self {
        Self {
            time,
            steps: 0,
            step: 0.0,
        }
    }

    /// Whether the motion takes so many steps that their cause is worth a look, at `time`.
    ///
    /// # Errors
    /// If the remaining steps, at the present pace, would take a night or longer.
    pub(super) fn check(
        &mut self,
        flow: &Flow<'_>,
        (options, statistics): (&Options, &Statistics),
        (time, rounding): (f64, &Rounding),
        state: impl FnOnce() -> State,
    ) -> Result<bool, IntegrateError> {
        let steps = statistics.steps;
        let taken = steps - self.steps;
        if taken < STEPS {
            return Ok(false);
        }
        let step = (time - self.time) / taken as f64;
        (self.time, self.steps) = (time, steps);
        let before = core::mem::replace(&mut self.step, step);
        // Steps that still shrink come to their own end soon, which tells what they shrink for.
        if step < SHRINKS * before || before == 0.0 {
            return Ok(false);
        }
        let to_go = (options.t_end - time) / step;
        let bodies = flow.mechanism.bodies().len();
        let work = flow.evaluations as f64 * bodies as f64;
        let is_long = work >= PATIENCE && to_go > HOPELESS * steps as f64;
        if !is_long && to_go < ENDLESS {
            return Ok(to_go > MANY);
        }
        let other = other_method(flow, options, &state());
        // Short steps may pass with what calls for them, unless it is the mechanism itself.
        if !is_long && other.is_none() {
            return Ok(true);
        }
        let advice = || match (options.method, rounding.limit(flow)) {
            (Method::Fixed { .. }, _) => "take a larger dt, or a method with step control".into(),
            (_, Some(limit)) => format!(
                "rounding in doubles has decided the length of {} of them, first of all at joint `{}`: take refined arithmetic, or a larger tolerance",
                limit.steps, limit.joint
            ),
            _ => "take a larger tolerance, or refined arithmetic".into(),
        };
        Err(IntegrateError::Hopeless {
            time,
            steps,
            step,
            to_go,
            advice: other.unwrap_or_else(advice),
        })
    }
}

/// The method that solves for what is stiff at a state, and why, where it is another one than that of `options`.
pub(super) fn other_method(flow: &Flow<'_>, options: &Options, state: &State) -> Option<String> {
    let choice = choice(flow, options, state)?;
    choice.scheme.takes_derivatives().then(|| advice(&choice))
}

/// The method that is chosen at a state, and why, where it is another one than that of `options`.
pub(super) fn chosen_method(flow: &Flow<'_>, options: &Options, state: &State) -> Option<String> {
    choice(flow, options, state).as_ref().map(advice)
}

fn choice(flow: &Flow<'_>, options: &Options, state: &State) -> Option<Choice> {
    let Method::Controlled { scheme, control } = options.method else {
        return None;
    };
    let wanted = Wanted {
        tolerance: control.tolerance,
        span: options.t_end - state.time,
        is_bound: true,
    };
    let choice = Choice::new(&flow.mechanism, state, wanted).ok();
    choice.filter(|choice| choice.scheme != scheme)
}

fn advice(choice: &Choice) -> String {
    format!(
        "{}: take the method `{}`",
        choice.reason,
        choice.scheme.name()
    )
}
