//! Rounding in the estimate of a step's error.
//!
//! An embedded estimate is a sum of rates that cancel. What rounding has left in these rates does not fall as shorter steps would have it, so that a
//! tolerance below it cannot be met: steps would shrink without an end, and the motion would not become more accurate. How much it is, the
//! rates beside the state tell, at a point that differs from it by roundings.

use super::StepFailure;
use super::flow::{Flow, Rates};
use super::positions;
use super::rates_of_loops::{has_ends, rounding_of};
use super::step_state::{StepState, add};
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use num_traits::Float;

/// Attempts of one step that are refused before rounding is looked at again: the second one is of a step that the first estimate has chosen.
const REFUSALS: usize = 2;

/// Accepted steps after which it is looked at again: one evaluation in so many steps costs some thousandths of them.
const LIFE: usize = 64;

/// How many times what rounding comes to on average is still rounding.
pub(super) const MARGIN: f64 = 8.0;

/// Steps that are longer by this factor than one whose error was rounding are taken without another look at that.
const SETTLED: f64 = 1.2;

/// Shorter steps are tried so often where the error may be rounding.
const TRIES: usize = 2;

/// What is left of an older look beside a new one, as one look at rounding may see little of it by chance.
const MEMORY: f64 = 0.95;

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
    /// By what the estimate of a step's error grows with its length, over a tolerance of 1, 1/s.
    rate: f64,
    /// Steps accepted since; `None` where it has not been looked at.
    age: Option<usize>,
    /// Attempts of the present step that were refused.
    refusals: usize,
    /// The attempt of the present step before this one: its length, s, and its error over the tolerance.
    before: Option<[f64; 2]>,
    /// How often the present step has been refused for an error that may be rounding.
    tried: usize,
    /// The length of a step whose error was rounding, s, since rounding was looked at; 0 where there was none.
    settled: f64,
    limit: Option<Limit>,
    /// Whether the roundings of Q count at all joints.
    is_of_configurations: bool,
    room: Room,
}

/// As [`RoundingLimit`], with the body in the place of its joint.
struct Limit {
    steps: usize,
    body: usize,
    error: f64,
}

/// A point next to the state, with its rates.
struct Room {
    phi: Vec<f64>,
    y: Vec<f64>,
    beside: Rates,
    difference: Vec<f64>,
}

impl Rounding {
    pub(super) fn new(flow: &Flow<'_>) -> Self {
        let beside = flow.new_rates();
        Self {
            rate: 0.0,
            age: None,
            refusals: 0,
            before: None,
            tried: 0,
            settled: 0.0,
            limit: None,
            is_of_configurations: false,
            room: Room {
                phi: beside.phi.clone(),
                y: beside.y.clone(),
                difference: vec![0.0; beside.phi.len() + beside.y.len()],
                beside,
            },
        }
    }

    /// What of an estimated error over `tolerance` is allowed a step for its rounding.
    pub(super) fn allowed(&self, step: f64, tolerance: f64) -> f64 {
        (self.rate * step / tolerance).max(1.0)
    }

    /// Whether it is to be looked at.
    pub(super) fn is_due(&self) -> bool {
        self.refusals >= REFUSALS || self.age.is_none_or(|age| age >= LIFE)
    }

    /// From now on the roundings of Q count at all joints, and not only where relations determine Q.
    ///
    /// They are small beside those of the speeds, but where masses differ by many orders of magnitude they decide the accelerations. Elsewhere they would lengthen
    /// steps at the smallest tolerances, at the cost of digits; so they are left to motions that take more steps than anybody waits for.
    pub(super) fn count_configurations(&mut self) {
        if !core::mem::replace(&mut self.is_of_configurations, true) {
            self.age = None;
        }
    }

    /// Whether all of an error over the tolerance that rounding may have made is rounding, and no shorter step has less: at a longer step it was not larger as the order would have it. Rounding
    /// is other than the error of a method: that adds up from step to step.
    pub(super) fn is_all(&mut self, step: f64, error: f64, order: u32) -> bool {
        if step <= SETTLED * self.settled {
            return true;
        }
        let falls = 0.5 * f64::from(order);
        let is_noise = |&[longer, larger]: &[f64; 2]| {
            step < longer && error > larger * Float::powf(step / longer, falls)
        };
        if let Some([longer, _]) = self.before.filter(is_noise) {
            self.settled = longer;
            return true;
        }
        // Stages of a step that is short enough have the same time.
        if self.tried == TRIES {
            self.settled = step;
            return true;
        }
        self.tried += 1;
        false
    }

    /// An attempt of the present step had this error over the tolerance.
    pub(super) const fn see(&mut self, step: f64, error: f64) {
        self.before = Some([step, error]);
    }

    /// The present step was refused for its error.
    pub(super) const fn refuse(&mut self) {
        self.refusals += 1;
    }

    /// Looks at it at the state, at `time`: not where a step that may be far too long has led to. Where the equations have no value nearby, nothing is known of it.
    /// `weight` is that of [`Stepper::estimate_weight`](super::stepper::Stepper::estimate_weight).
    pub(super) fn look(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        time: f64,
        weight: f64,
    ) {
        let found = match self.is_of_configurations {
            true => self.room.scatter_of_all(step_state, flow, time),
            false => self.room.scatter_of_loops(step_state, flow, time),
        };
        let found = found.and_then(|()| {
            step_state.set_scatter(flow, (MARGIN * weight, MEMORY), &mut self.room.difference);
            step_state.set_errors(1.0, &self.room.difference);
            step_state.largest_error(flow, None)
        });
        let rate = found.map_or(0.0, |(rate, _)| rate);
        let rate = match rate.is_finite() {
            true => MARGIN * weight * rate,
            false => 0.0,
        };
        self.rate = rate.max(MEMORY * self.rate);
        (self.age, self.refusals, self.settled) = (Some(0), 0, 0.0);
    }

    /// What roundings of the state, in Q at all joints, make of the rates at it: ϕ̇, then ẏ.
    pub(super) fn scatter_of_configurations(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        time: f64,
    ) -> Result<&mut [f64], StepFailure> {
        self.room.scatter_of_all(step_state, flow, time)?;
        Ok(&mut self.room.difference)
    }

    /// A step was accepted with this error of the joint under a body, over the tolerance.
    pub(super) fn accept(&mut self, error: f64, body: usize, tolerance: f64) {
        (self.refusals, self.tried, self.before) = (0, 0, None);
        self.age = self.age.map(|age| age + 1);
        if error <= 1.0 {
            return;
        }
        let error = error * tolerance;
        let first = Limit {
            steps: 0,
            body,
            error,
        };
        let limit = self.limit.get_or_insert(first);
        limit.steps += 1;
        if error > limit.error {
            (limit.body, limit.error) = (body, error);
        }
    }

    /// The steps whose length it has decided, if there are any.
    pub(super) fn limit(&self, flow: &Flow<'_>) -> Option<RoundingLimit> {
        let limit = self.limit.as_ref()?;
        Some(RoundingLimit {
            steps: limit.steps,
            joint: flow.joint_name(limit.body),
            error: limit.error,
        })
    }
}

impl Room {
    /// Differences of the rates at the state, and at one that differs from it by a rounding in each of its numbers and in the time, in Q too where relations determine it: ϕ̇, then ẏ.
    fn scatter_of_loops(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        time: f64,
    ) -> Result<(), StepFailure> {
        beside(&step_state.offset, &mut self.phi);
        let joints = flow.mechanism.joints();
        for (_, body) in joints.filter(|(_, body)| has_ends(body.joint())) {
            let freedoms = body.ranges().freedoms.clone();
            for (own, phi) in self.phi[freedoms].iter_mut().enumerate() {
                *phi += rounding_of(body, own, &step_state.configuration);
            }
        }
        self.scatter(step_state, flow, time)
    }

    /// The same with a rounding in Q at all joints, and in where bodies are.
    fn scatter_of_all(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        time: f64,
    ) -> Result<(), StepFailure> {
        beside(&step_state.offset, &mut self.phi);
        let roundings = positions::roundings(&flow.mechanism, &step_state.configuration);
        add(&mut self.phi, 1.0, &roundings);
        self.scatter(step_state, flow, time)
    }

    /// The differences, with these roundings of ϕ.
    fn scatter(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        time: f64,
    ) -> Result<(), StepFailure> {
        beside(&step_state.y, &mut self.y);
        flow.evaluate(
            time * (1.0 + f64::EPSILON),
            &step_state.base,
            &self.phi,
            &self.y,
            self.beside.parts(),
        )?;
        let (here, beside) = (&step_state.rates, &self.beside);
        let pairs = here.phi.iter().zip(&beside.phi);
        let pairs = pairs.chain(here.y.iter().zip(&beside.y));
        for (difference, (a, b)) in self.difference.iter_mut().zip(pairs) {
            *difference = a - b;
        }
        Ok(())
    }
}

/// Numbers that are larger by a rounding, and smaller, in turn. What is 0 stays.
fn beside(numbers: &[f64], moved: &mut [f64]) {
    let signs = [f64::EPSILON, -f64::EPSILON].into_iter().cycle();
    for ((number, sign), moved) in numbers.iter().zip(signs).zip(moved) {
        *moved = number * (1.0 + sign);
    }
}
