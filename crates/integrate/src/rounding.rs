//! Rounding in the estimate of a step's error.
//!
//! An embedded estimate is a sum of rates that cancel. What rounding has left in these rates does not fall as shorter steps would have it, so that a
//! tolerance below it cannot be met: steps would shrink without an end, and the motion would not become more accurate. How much it is, two
//! evaluations tell that differ by roundings of the state.

use super::StepFailure;
use super::flow::{Flow, Rates};
use super::step_state::StepState;
use alloc::string::String;
use alloc::vec::Vec;

/// Attempts of one step that are refused before rounding is asked for: the second one is of a step that the first estimate has chosen.
const REFUSALS: usize = 2;

/// Accepted steps after which it is no longer known.
const LIFE: usize = 64;

/// What rounding of rates comes to in an estimate, as a part of what they would come to in a sum: weights of estimates are about a tenth, and of either sign.
const PART: f64 = 0.25;

/// Steps whose length rounding has decided, and not the tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct RoundingLimit {
    /// How many.
    pub steps: usize,
    /// The joint with the largest error in them.
    pub joint: String,
    /// Its error, as that which a tolerance allows a step.
    pub error: f64,
}

/// What is known of rounding at the present state.
pub(super) struct Rounding {
    /// By what the estimate of a step's error grows with its length, over a tolerance of 1, 1/s; 0 where it is not known.
    rate: f64,
    /// Steps accepted since.
    age: usize,
    /// Attempts of the present step that were refused.
    refusals: usize,
    limit: Option<(usize, usize, f64)>,
}

impl Rounding {
    pub(super) const fn new() -> Self {
        Self {
            rate: 0.0,
            age: 0,
            refusals: 0,
            limit: None,
        }
    }

    /// What of an estimated error over `tolerance` is allowed a step for its rounding.
    pub(super) fn allowed(&self, step: f64, tolerance: f64) -> f64 {
        (PART * self.rate * step / tolerance).max(1.0)
    }

    /// A step was refused for its error; whether rounding is to be looked at.
    pub(super) const fn refuse(&mut self) -> bool {
        self.refusals += 1;
        self.refusals >= REFUSALS
    }

    /// Looks at it, at the end of the step just tried, which comes at `time`.
    pub(super) fn measure(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        time: f64,
    ) -> Result<(), StepFailure> {
        let found = scatter(step_state, flow, time)?;
        step_state.set_errors(1.0, &found);
        let (rate, _) = step_state.largest_error(flow, None)?;
        self.rate = if rate.is_finite() { rate } else { 0.0 };
        self.age = 0;
        Ok(())
    }

    /// A step was accepted with this error of the joint under a body.
    pub(super) fn accept(&mut self, error: f64, joint: usize, tolerance: f64) {
        self.refusals = 0;
        self.age += 1;
        if self.age > LIFE {
            self.rate = 0.0;
        }
        if error > 1.0 {
            let (steps, worst, most) = self.limit.unwrap_or((0, joint, 0.0));
            let error = error * tolerance;
            self.limit = Some(match error > most {
                true => (steps + 1, joint, error),
                false => (steps + 1, worst, most),
            });
        }
    }

    /// The steps whose length it has decided, if there are any.
    pub(super) fn limit(&self, flow: &Flow<'_>) -> Option<RoundingLimit> {
        let (steps, joint, error) = self.limit?;
        Some(RoundingLimit {
            steps,
            joint: flow.joint_name(joint),
            error,
        })
    }
}

/// Differences of the rates at the point that the step has come to, and at one that differs from it by a rounding in each of its numbers: ϕ̇, then ẏ.
fn scatter(
    step_state: &StepState,
    flow: &mut Flow<'_>,
    time: f64,
) -> Result<Vec<f64>, StepFailure> {
    let (phi, y) = (&step_state.phi, &step_state.next_y);
    let mut rates = |phi: &[f64], y: &[f64]| -> Result<Rates, StepFailure> {
        let mut rates = flow.new_rates();
        flow.evaluate(time, &step_state.base, phi, y, rates.parts())?;
        Ok(rates)
    };
    let here = rates(phi, y)?;
    let beside = rates(&beside(phi), &beside(y))?;
    let pairs = here.phi.iter().zip(&beside.phi);
    let pairs = pairs.chain(here.y.iter().zip(&beside.y));
    Ok(pairs.map(|(a, b)| a - b).collect())
}

/// Numbers that are larger by a rounding, and smaller, in turn. What is 0 stays.
fn beside(numbers: &[f64]) -> Vec<f64> {
    let signs = [f64::EPSILON, -f64::EPSILON].into_iter().cycle();
    let pairs = numbers.iter().zip(signs);
    pairs.map(|(number, sign)| number * (1.0 + sign)).collect()
}
