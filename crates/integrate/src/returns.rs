//! Steps that pass where a joint's motion ends, and come back on the branch on which they began.
//!
//! Where relations alone give the Φ of a joint, the motion would go on beyond its singular set on the other branch of the relations. Φ stays on its branch, and the
//! equations have a motion there: the one that came, backwards. The ends of a step over the set are both on the right side of it, and in ϕ they may be the same.
//! What tells is the function g that vanishes on the set: it falls in proportion to the time to the set and rises in proportion to the time since, so that the
//! tangents at both ends come to 0 within the step. Where the motion turns back by itself, g is a parabola, whose tangents do so only in steps that are too long for it.

use super::StepFailure;
use super::flow::{Flow, Rates, retract};
use super::rates_of_loops::{RateOf, has_ends};
use super::step_state::StepState;
use super::stepper::Span;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::mechanism::{Body, Mechanism};

/// The part of a step over which the change of g is taken: a chord of so little that a parabola through it differs from its tangent by a hundredth over the step.
const CHORD: f64 = 1.0 / 64.0;

/// Looks for such steps.
#[derive(Debug)]
pub(super) struct Returns {
    /// Q and rates at the end of the step.
    configuration: Vec<f64>,
    rates: Rates,
    rate: RateOf,
    /// A joint's Q a chord away.
    away: Vec<f64>,
}

/// g at one end of a step, and its rate there, 1/s.
#[derive(Clone, Copy, Debug)]
struct Tangent {
    value: f64,
    rate: f64,
}

impl Tangent {
    /// Whether less than this part of the value is left a step further.
    fn leaves_less(&self, part: f64, step: f64) -> bool {
        self.value + step * self.rate < part * self.value
    }
}

impl Returns {
    pub(super) fn new(mechanism: &Mechanism) -> Self {
        Self {
            configuration: vec![0.0; mechanism.layout().configuration],
            rates: Rates::new(mechanism),
            rate: RateOf::default(),
            away: vec![],
        }
    }

    /// The index of a joint, among those at these indices of bodies, that has come back within the step, or has no configuration at its end. Looked at are joints whose g the step
    /// changes by more than the part `unseen`. Such a joint has come back where the tangent at one end of the step leaves less than the part `left` of g at the other.
    ///
    /// # Errors
    /// Equations that have no value at the end of the step.
    pub(super) fn find(
        &mut self,
        flow: &mut Flow<'_>,
        (state, span): (&StepState, Span),
        bodies: impl Iterator<Item = usize>,
        (unseen, left): (f64, f64),
    ) -> Result<Option<usize>, StepFailure> {
        let mechanism = alloc::sync::Arc::clone(&flow.mechanism);
        let (mut is_there, mut has_speeds) = (false, false);
        for index in bodies {
            let body = &mechanism.bodies()[index];
            if !has_ends(body.joint()) {
                continue;
            }
            if !is_there {
                retract(&mechanism, &state.base, &state.phi, &mut self.configuration);
                is_there = true;
            }
            let value = value_at(body, &self.configuration);
            if value.is_nan() {
                return Ok(Some(index));
            }
            let at_start = (&*state.configuration, state.speeds());
            let start = self.tangent(body, at_start, (span.step, -1.0));
            if start.rate > 0.0 {
                continue;
            }
            let change = (span.step * start.rate).abs();
            if change.max((value - start.value).abs()) <= unseen * start.value {
                continue;
            }
            if !has_speeds {
                self.set_speeds(flow, state, span)?;
                has_speeds = true;
            }
            let (q, speeds) = (
                core::mem::take(&mut self.configuration),
                core::mem::take(&mut self.rates.speeds),
            );
            let end = self.tangent(body, (&q, &speeds), (span.step, 1.0));
            (self.configuration, self.rates.speeds) = (q, speeds);
            let is_back = end.rate >= 0.0
                && (start.leaves_less(left, span.step) || end.leaves_less(left, -span.step));
            if is_back {
                return Ok(Some(index));
            }
        }
        Ok(None)
    }

    /// v̄ at the end of the step.
    fn set_speeds(
        &mut self,
        flow: &mut Flow<'_>,
        state: &StepState,
        span: Span,
    ) -> Result<(), StepFailure> {
        if flow.y_is_speeds() {
            self.rates.speeds.copy_from_slice(&state.next_y);
            return Ok(());
        }
        state.evaluate_there(flow, span.time + span.step, self.rates.parts())
    }

    /// g at a state, and its rate by the chord that lies before it or behind it, on the side away from the set. The chord is straight in Q, and so leaves the relations, along which there may be nothing.
    fn tangent(
        &mut self,
        body: &Body,
        (q, speeds): (&[f64], &[f64]),
        (step, side): (f64, f64),
    ) -> Tangent {
        let time = side * CHORD * step;
        let value = value_at(body, q);
        let rates = self.rate.of(body, q, &speeds[body.ranges().speeds.clone()]);
        let pairs = body.configuration(q).iter().zip(rates);
        self.away.clear();
        self.away
            .extend(pairs.map(|(entry, rate)| entry + time * rate));
        let away = body.joint().singularity(&self.away);
        Tangent {
            value,
            rate: (away - value) / time,
        }
    }
}

fn value_at(body: &Body, q: &[f64]) -> f64 {
    body.joint().singularity(body.configuration(q))
}
