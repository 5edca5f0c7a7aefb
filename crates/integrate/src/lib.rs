//! Integration on the joints' manifolds, through their own Φ (§V of the paper, (31)).
//!
//! Steps live in the flat space of (ϕ, y) with y = v̄ or p̄, where each joint's ϕ is measured from a base point Q_b: stage i has
//! `Q_i = Φ(Q_b, ϕ_i)` and `ϕ̇_i = S(Q_b, ϕ_i)⁻¹ S̄(Q_i) v̄_i`, so that any tableau keeps its order, explicit or implicit (H. Munthe-Kaas). A
//! joint that has moved by half a radian gets `Φ(Q_b, ϕ)`, projected onto the manifold against rounding, for its base point, where ϕ begins at 0 again. Nothing is
//! ever added to Q.
//!
//! What a scheme does to go from one state to the next is a `Stepper`; all of them share the state and its charts (`StepState`), the equations as a
//! vector field (`Flow`), the control of steps and the way over the samples (`Driver`), and dense output with the events on it.
//!
//! Joints with dry friction or limits move by pieces (`hybrid`): in each of them some are held, and whatever the scheme does is smooth.
//!
//! | mechanism | scheme |
//! |---|---|
//! | most | [`Scheme::DormandPrince`]; [`Scheme::DormandPrince8`] from 1e-6 down, [`Scheme::Verner9`] near rounding |
//! | stiff and damped | [`Scheme::Radau5`]: its steps do not depend on the stiffness |
//! | stiff and undamped | [`Scheme::Exponential`], which follows the oscillation; [`Scheme::Gauss2`] and [`Scheme::Midpoint`] step over it |
//! | bodies that nothing but gravity acts on | [`Scheme::Exponential`]: in closed form, over any number of turns |
//! | any of these | [`Choice`] looks at the first state, and says why |
//! | long runs | [`Scheme::Gauss3`], or [`Scheme::DiscreteGradient`] where the balance of energy shall hold to rounding |
#![forbid(unsafe_code)]
#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

mod approach;
mod bends;
mod carried;
mod choice;
mod clock;
mod collocation;
mod commutator_free;
mod compensation;
mod dense;
mod discrete_gradient;
mod dop853;
mod driver;
pub mod eigen;
mod error;
mod event;
mod event_location;
mod explicit;
mod exponential;
mod fixed_steps;
mod flow;
mod free_motion;
mod global_error;
mod hybrid;
mod inputs;
mod integration;
mod jacobian;
mod kinks;
mod linear;
mod lobatto;
mod nearby;
mod options;
mod outputs;
mod pacing;
mod phi;
mod pieces;
mod positions;
mod product;
mod prospect;
mod rates_of_loops;
mod reconsider;
mod returns;
mod root;
mod rounding;
mod search;
mod solution;
mod spectrum;
mod stages;
mod stalls;
mod step_control;
mod step_probe;
mod step_state;
mod stepper;
mod tableau;
mod turns;
mod verner;
mod waypoints;

pub use approach::{Approach, Near};
pub use choice::{Choice, Wanted};
pub use error::{IntegrateError, StepFailure};
pub use event::{Crossing, Direction, Event};
pub use fixed_steps::FixedSteps;
pub use global_error::{Doubt, ErrorParts, GlobalError, Tuned};
pub use inputs::{HeldInputs, InputBends, Inputs, PortInputs};
pub use integration::{Integration, Sampling};
pub use linear::LinearStep;
pub use options::{Form, Method, Options, Scheme, StepControl};
pub use reconsider::MethodChange;
pub use rounding::RoundingLimit;
pub use solution::{Solution, State, Statistics, Step, StepErrors};
pub use spectrum::{Mode, Spectrum};
pub use tableau::{Estimate, Tableau};

use core::ops::ControlFlow;
use hamel_runtime::dynamics::Dynamics;

/// Sees the initial state, every accepted step, and samples of dense output within them; breaks to end the integration there.
pub type Observer<'a> = dyn FnMut(&Step<'_>) -> ControlFlow<()> + 'a;

/// Inputs of a mechanism that is left alone.
pub fn no_inputs(_time: f64, _q: &[f64], _speeds: &[f64], _efforts: &mut [f64]) {}

/// An observer that only lets go on.
pub fn no_observer(_step: &Step<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Moves a mechanism from `initial` to [`Options::t_end`]: [`Integration`] with inputs and an observer.
///
/// Sample times are hit exactly, by shortening steps.
///
/// # Errors
/// As those of [`Integration::run`].
pub fn integrate(
    dynamics: &mut dyn Dynamics,
    initial: &State,
    options: &Options,
    inputs: &mut Inputs<'_>,
    observer: &mut Observer<'_>,
) -> Result<Solution, IntegrateError> {
    Integration::new(dynamics, initial, options)
        .inputs(inputs)
        .observer(observer)
        .run()
}

/// As [`integrate`], with inputs that are held over `period` (s): [`Integration::held`].
///
/// # Errors
/// As those of [`Integration::run`].
pub fn integrate_held(
    dynamics: &mut dyn Dynamics,
    initial: &State,
    options: &Options,
    period: f64,
    inputs: &mut Inputs<'_>,
    observer: &mut Observer<'_>,
) -> Result<Solution, IntegrateError> {
    Integration::new(dynamics, initial, options)
        .inputs(inputs)
        .held(period)
        .observer(observer)
        .run()
}
