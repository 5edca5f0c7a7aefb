//! The choice of the method, looked at again on the way: springs stiffen, stops are met, joints fold.

use super::driver::Driver;
use super::pacing::Pacing;
use super::step_control::StepController;
use super::{Choice, IntegrateError, Method, Scheme, Wanted};
use alloc::string::String;
use alloc::vec::Vec;

/// Steps before the first look. Each look comes after twice as many as the one before, so that all of them together cost a small part of the motion.
const FIRST: usize = 256;

/// The most speeds for which it is done: eigenvalues of twice as many rows cost more than some hundred steps of larger mechanisms.
const MOST_SPEEDS: usize = 64;

/// A method that took over within a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodChange {
    /// When, s.
    pub time: f64,
    /// The method from then on.
    pub scheme: Scheme,
    /// Why, in words.
    pub reason: String,
}

/// When the choice is looked at again.
#[derive(Debug)]
pub(super) struct Reconsideration {
    /// The number of steps at the next look.
    next: usize,
    pub(super) changes: Vec<MethodChange>,
}

impl Reconsideration {
    pub(super) const fn new() -> Self {
        Self {
            next: FIRST,
            changes: Vec::new(),
        }
    }
}

impl Driver<'_> {
    /// Looks at the choice again, if it is time: where an explicit method is held by what has become stiff, Radau IIA takes over, and the other way round.
    ///
    /// Dense output and events keep their method: what is between the ends of steps is made for its order.
    pub(super) fn reconsider(&mut self, pacing: &mut Pacing) -> Result<(), IntegrateError> {
        let steps = self.statistics.steps;
        let Some(own) = self
            .reconsideration
            .as_mut()
            .filter(|own| steps >= own.next)
        else {
            return Ok(());
        };
        own.next = 2 * steps;
        let Method::Controlled { control, .. } = self.options.method else {
            return Ok(());
        };
        let is_kept = self.outputs.is_some() || self.scheme == Scheme::Exponential;
        if is_kept || self.flow.mechanism.layout().speeds > MOST_SPEEDS {
            return Ok(());
        }
        let state = self.state();
        let wanted = Wanted {
            tolerance: control.tolerance,
            span: self.options.t_end - state.time,
            is_bound: true,
        };
        // A state at which nothing can be chosen keeps its method.
        let Ok(choice) = Choice::new(&self.flow.mechanism, &state, wanted) else {
            return Ok(());
        };
        if choice.scheme.takes_derivatives() == self.scheme.takes_derivatives() {
            return Ok(());
        }
        self.scheme = choice.scheme;
        self.renew_stepper();
        pacing.controller = StepController::new(self.stepper.order());
        self.pace_anew(pacing)?;
        if let Some(own) = &mut self.reconsideration {
            own.changes.push(MethodChange {
                time: state.time,
                scheme: choice.scheme,
                reason: choice.reason,
            });
        }
        Ok(())
    }
}
