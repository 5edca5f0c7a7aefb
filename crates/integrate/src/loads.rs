//! Loads that change within a step faster than the method looks at them: its estimate of the error knows nothing of what lies between its stages.

use super::StepFailure;
use super::flow::{Flow, Rates};
use super::step_state::StepState;
use super::stepper::Span;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::time_function::Pace;

/// The product of step and rate up to which a load is seen: five turns of a sine, of which a method with seven stages or more sees a part as large as the whole.
const SEEN: f64 = 32.0;

/// What a load may do to a step that is not seen, over the tolerance: a hundredth is less than what errors of steps come to, and no estimate tells it.
const UNSEEN: f64 = 0.01;

/// Steps are shortened by no more than this factor at once.
const SHORTEST: f64 = 0.01;

/// What a step is tried with.
pub(super) struct Loads {
    rates: Rates,
    difference: Vec<f64>,
}

/// A load that a step does not resolve.
pub(super) struct Unresolved {
    pub(super) cause: StepFailure,
    /// The length to try next, over that of the step.
    pub(super) part: f64,
}

impl Loads {
    pub(super) fn new(flow: &Flow<'_>) -> Self {
        let rates = flow.new_rates();
        Self {
            difference: vec![0.0; rates.phi.len() + rates.y.len()],
            rates,
        }
    }

    /// The load that changes too fast for the step over `span` from the state, if one does, and does more to it than the tolerance leaves room for.
    pub(super) fn look(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        span: Span,
        tolerance: f64,
    ) -> Result<Option<Unresolved>, StepFailure> {
        let Some(Pace {
            function,
            rate,
            far,
        }) = flow.pace(span, SEEN / span.step)
        else {
            return Ok(None);
        };
        let (base, phi, y) = (&step_state.base, &step_state.offset, &step_state.y);
        flow.evaluate(far, base, phi, y, self.rates.parts())?;
        let pairs = self.rates.phi.iter().zip(&step_state.rates.phi);
        let pairs = pairs.chain(self.rates.y.iter().zip(&step_state.rates.y));
        for (difference, (there, here)) in self.difference.iter_mut().zip(pairs) {
            *difference = there - here;
        }
        step_state.set_errors(span.step / (UNSEEN * tolerance), &self.difference);
        let (error, _) = step_state.largest_error(flow, None)?;
        let step = span.step;
        Ok((error > 1.0).then(|| Unresolved {
            cause: StepFailure::Load {
                load: function,
                rate,
            },
            part: (SEEN / (rate * step)).clamp(SHORTEST, 0.5),
        }))
    }
}
