//! How long the steps of a method are: by taking the first ones.

use super::{Form, Method, Options, State, Step, integrate, no_inputs};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::ops::ControlFlow;
use hamel_runtime::dynamics::Recursive;
use hamel_runtime::mechanism::Mechanism;

/// Steps taken. The second half of them counts, as the first ones grow to their length.
pub(super) const TAKEN: usize = 16;

/// The mean of the later ones of the first steps from `state` to the end of a span, s. `None` where they fail.
pub(super) fn step(
    mechanism: &Arc<Mechanism>,
    state: &State,
    span: f64,
    method: Method,
) -> Option<f64> {
    let options = Options {
        form: Form::Lagrangian,
        method,
        t_end: state.time + span,
        samples: Vec::new(),
    };
    let start = (0, state.time);
    let (mut middle, mut end) = (start, start);
    let mut watch = |step: &Step<'_>| {
        end = (step.number, step.time);
        if step.number <= TAKEN / 2 {
            middle = end;
        }
        match step.number < TAKEN {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        }
    };
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    integrate(&mut dynamics, state, &options, &mut no_inputs, &mut watch).ok()?;
    // A motion of few steps counts as a whole.
    let from = if end.0 > middle.0 { middle } else { start };
    Some((end.1 - from.1) / (end.0 - from.0).max(1) as f64)
}
