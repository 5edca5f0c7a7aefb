//! Lie-group Runge–Kutta integration of Munthe-Kaas type, through the joints' own Φ (§V of the paper, (31)).
//!
//! Steps live in the flat space of (ϕ, y) with y = v̄ or p̄, where each joint's ϕ is measured from a base point Q_b: stage i has
//! `Q_i = Φ(Q_b, ϕ_i)` and `ϕ̇_i = S(Q_b, ϕ_i)⁻¹ S̄(Q_i) v̄_i`, so that any explicit tableau keeps its order. A joint that has moved
//! by half a radian gets `Φ(Q_b, ϕ)`, projected onto the manifold against rounding, for its base point, where ϕ begins at 0 again. Nothing is
//! ever added to Q.

mod approach;
mod clock;
mod collocation;
mod commutator_free;
mod control;
mod discrete_gradient;
mod dop853;
mod driver;
mod error;
mod explicit;
mod exponential;
mod flow;
mod jacobian;
mod linear;
mod options;
mod phi;
mod residue;
mod solution;
mod standing;
mod stepper;
mod tableau;
mod turns;
mod verner;

pub use approach::{Approach, Near};
pub use error::{IntegrateError, StepFailure};
pub use linear::LinearStep;
pub use options::{Control, Form, Method, Options, Scheme};
pub use solution::{Solution, State, Statistics, Step};
pub use tableau::{Estimate, Tableau};

use crate::dynamics::Dynamics;
use core::ops::ControlFlow;

/// Efforts τ (one entry a freedom) from time, q and v̄; entries are zero when it is called.
pub type Inputs<'a> = dyn FnMut(f64, &[f64], &[f64], &mut [f64]) + 'a;

/// Sees the initial state and every accepted step; breaks to end the integration there.
pub type Observer<'a> = dyn FnMut(&Step<'_>) -> ControlFlow<()> + 'a;

/// Inputs of a mechanism that is left alone.
pub fn no_inputs(_time: f64, _q: &[f64], _speeds: &[f64], _efforts: &mut [f64]) {}

/// An observer that only lets go on.
pub fn no_observer(_step: &Step<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Moves a mechanism from `initial` to [`Options::t_end`].
///
/// Sample times are hit exactly, by shortening steps. The initial state is checked, not projected; speeds of
/// joints whose motion is prescribed are those of their laws, whatever it says.
///
/// # Errors
/// Options out of range; `t_end` before the initial time; an initial state of the wrong size, not finite, or off the
/// joints' manifolds; a singular mass matrix; a step that fails at fixed size, or shrinks to nothing under step control.
pub fn integrate(
    dynamics: &mut dyn Dynamics,
    initial: &State,
    options: &Options,
    inputs: &mut Inputs<'_>,
    observer: &mut Observer<'_>,
) -> Result<Solution, IntegrateError> {
    start(dynamics, initial, options, None, inputs)?.run(observer)
}

/// As [`integrate`], with inputs that are taken at the initial time and after each `period` (s), and held in between: what a digital
/// controller does. Steps end at these instants.
///
/// # Errors
/// As those of [`integrate`]; a period that is not positive and finite.
pub fn integrate_held(
    dynamics: &mut dyn Dynamics,
    initial: &State,
    options: &Options,
    period: f64,
    inputs: &mut Inputs<'_>,
    observer: &mut Observer<'_>,
) -> Result<Solution, IntegrateError> {
    if !(period > 0.0 && period.is_finite()) {
        return Err(IntegrateError::Option {
            option: "period",
            value: period,
            requirement: "positive and finite",
        });
    }
    start(dynamics, initial, options, Some(period), inputs)?.run(observer)
}

/// An integration that has been checked and stands at its initial state.
fn start<'a>(
    dynamics: &'a mut dyn Dynamics,
    initial: &State,
    options: &'a Options,
    period: Option<f64>,
    inputs: &'a mut Inputs<'a>,
) -> Result<driver::Driver<'a>, IntegrateError> {
    options.check(initial.time)?;
    let mechanism = dynamics.mechanism();
    mechanism.check_configuration(&initial.configuration)?;
    mechanism.check_speeds("speeds", &initial.speeds)?;
    options.check_scheme(mechanism)?;
    driver::Driver::new(dynamics, initial, options, period, inputs)
}
