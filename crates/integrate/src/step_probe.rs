//! How long the steps of a method are: by taking the first ones.

use super::{Form, Method, Options, State, Step, integrate, no_inputs};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::ops::ControlFlow;
use hamel_runtime::dynamics::Recursive;
use hamel_runtime::mechanism::Mechanism;

/// Steps taken at first, where no fewer are wanted. The second half of them counts, as the first ones grow to their length.
pub(super) const TAKEN: usize = 16;

/// Steps still grow where the last one is longer than this times the mean of those that count.
const GROWING: f64 = 1.5;

/// The steps so far: how many, and the time they have come to, s.
#[derive(Clone, Copy)]
struct Progress {
    number: usize,
    time: f64,
}

impl Progress {
    /// The mean step from `start` to here, s.
    fn mean_since(&self, start: &Self) -> f64 {
        (self.time - start.time) / self.number.saturating_sub(start.number).max(1) as f64
    }
}

/// The mean of the later ones of the first steps from `state` to the end of a span, s; `None` where they fail. As long as steps grow, twice as many are taken, up to `most`:
/// after a fast transient they are short for a while.
pub(super) fn step(
    mechanism: &Arc<Mechanism>,
    state: &State,
    (span, most): (f64, usize),
    method: Method,
) -> Option<f64> {
    let options = Options {
        form: Form::Lagrangian,
        method,
        t_end: state.time + span,
        samples: Vec::new(),
    };
    let start = Progress {
        number: 0,
        time: state.time,
    };
    let few = TAKEN.min(most);
    let (mut middle, mut end, mut taken) = (start, start, few);
    let mut watch = |step: &Step<'_>| {
        let before = end;
        end = Progress {
            number: step.number,
            time: step.time,
        };
        if step.number <= taken / 2 {
            middle = end;
        }
        let is_growing =
            || end.mean_since(&before) > GROWING * end.mean_since(&middle) && 2 * taken <= most;
        match step.number < taken {
            true => ControlFlow::Continue(()),
            false if is_growing() => {
                (middle, taken) = (end, 2 * taken);
                ControlFlow::Continue(())
            }
            false => ControlFlow::Break(()),
        }
    };
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    integrate(&mut dynamics, state, &options, &mut no_inputs, &mut watch).ok()?;
    // A motion of few steps counts as a whole.
    let is_short = end.number <= few && end.time >= options.t_end;
    let is_whole = is_short || end.number <= middle.number;
    Some(end.mean_since(if is_whole { &start } else { &middle }))
}
