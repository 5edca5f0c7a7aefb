//! What an integration starts from, shows on the way, and returns.

use super::{Approach, Crossing, MethodChange, RoundingLimit, Scheme};
use alloc::vec::Vec;
use hamel_runtime::dynamics::Recursive;

/// State of a mechanism at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// s.
    pub time: f64,
    /// All joints' Q.
    pub configuration: Vec<f64>,
    /// v̄ of all joints, in either form.
    pub speeds: Vec<f64>,
}

/// What an observer sees.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// s.
    pub time: f64,
    /// How many steps were accepted so far, that in which a sample lies included; 0 for the initial state.
    pub number: usize,
    /// All joints' Q.
    pub configuration: &'a [f64],
    /// v̄ of all joints.
    pub speeds: &'a [f64],
    /// How far each joint has gone since the motion began, one entry per degree of freedom, in the units of ϕ: the sum of its ϕ over all steps, each around its own base
    /// point. Of a joint that turns about one axis it counts the turns, which Q does not where it comes back to itself.
    pub travel: &'a [f64],
    /// p̄ of all joints, in the Hamiltonian form.
    pub momenta: Option<&'a [f64]>,
    /// Index of the last sample that falls on this time, if one does.
    pub sample: Option<usize>,
    /// Whether it lies between the ends of a step: a sample of dense output.
    pub is_within: bool,
    /// At a sample, where [`Integration::telling_forces`](super::Integration::telling_forces) asks for it: the mechanism at the accelerations that it has there, from
    /// which what the joints carry can be read, as after [`Recursive::inverse_dynamics`].
    pub carried: Option<&'a Recursive>,
}

impl<'a> Step<'a> {
    /// A state at the end of a step, without momenta and forces.
    ///
    /// `travel` is [`Step::travel`], `number` is how many steps led there, and `sample` the index of the last sample that falls on its time, if one does.
    pub fn of_state(
        state: &'a State,
        travel: &'a [f64],
        number: usize,
        sample: Option<usize>,
    ) -> Self {
        Self {
            time: state.time,
            number,
            configuration: &state.configuration,
            speeds: &state.speeds,
            travel,
            momenta: None,
            sample,
            is_within: false,
            carried: None,
        }
    }
}

/// The work done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Accepted steps.
    pub steps: usize,
    /// Refused steps.
    pub rejected: usize,
    /// Refused steps whose iteration did not converge.
    pub unconverged: usize,
    /// Steps that end where inputs or elements bend, as at the limit of an effort.
    pub bends: usize,
    /// Steps of fixed size that are too long for what acts on the mechanism as a function of time: two of them have a period of it or more, or a pulse between their ends.
    pub unseen: usize,
    /// Evaluations of the equations of motion.
    pub evaluations: usize,
    /// Iterations of implicit steps.
    pub iterations: usize,
    /// Evaluations of `∂(ϕ̇, ẏ)/∂(ϕ, y)` for them.
    pub jacobians: usize,
    /// Factorisations of their matrices.
    pub factorizations: usize,
}

/// Estimated errors of the accepted steps of a method with step control, each as a part of what the tolerance allows a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepErrors {
    /// Of all steps together.
    pub sum: f64,
    /// Of those that are far less than is allowed: something else than the tolerance decides how long these steps are.
    pub loose: f64,
}

impl StepErrors {
    /// Errors below this part of what is allowed are far less.
    const LOOSE: f64 = 1e-2;

    pub(super) const fn see(&mut self, error: f64) {
        self.sum += error;
        if error < Self::LOOSE {
            self.loose += error;
        }
    }
}

/// What an integration returns.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Where it ended.
    pub state: State,
    /// [`Step::travel`] there.
    pub travel: Vec<f64>,
    /// The states at the sample times that were reached, in order.
    pub samples: Vec<State>,
    /// The states at the ends of some steps, evenly over them, at most 32: where [`GlobalError`](super::GlobalError) compares motions with few samples.
    pub waypoints: Vec<State>,
    /// What crossed zero, and what joints with friction and limits did, in the order of time.
    pub events: Vec<Crossing>,
    /// The method that it began with.
    pub scheme: Scheme,
    /// The methods that took over on the way, where [`Integration::choosing`](super::Integration::choosing) allowed it.
    pub method_changes: Vec<MethodChange>,
    /// The work done.
    pub statistics: Statistics,
    /// What the steps tell of their errors.
    pub step_errors: StepErrors,
    /// How near each joint that has singular sets came to them, in the order of the joints.
    pub approaches: Vec<Approach>,
    /// The steps whose length rounding has decided, and not the tolerance: smaller tolerances make such motions no more accurate. `None` where there is none.
    pub rounding: Option<RoundingLimit>,
    /// Whether the observer or an event ended it before [`Options::t_end`](super::Options::t_end).
    pub stopped: bool,
}
