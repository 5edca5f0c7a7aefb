//! What rounding of accelerations adds to the error of a motion.
//!
//! Where a light body turns against a heavy one, as a rotor of 1e-13 kg m² in its link, both accelerations are 1e12 times that of the link, which is what rounding
//! leaves of their sum. Beside accelerations whose residuals are in double-double it is seen how much the equations lose, at a configuration that is a rounding off: stiff springs make
//! accelerations of that, and so do those between bodies that are far from the origin of the world.

use crate::flow::{Flow, retract};
use crate::inputs::Given;
use crate::positions;
use crate::{Form, State};
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::{Dynamics, DynamicsError, Refined};
use hamel_runtime::mechanism::Mechanism;
use nalgebra::Vector3;

/// States at which it is looked at, at most: one look takes up to a hundred evaluations.
const MOST_LOOKS: usize = 8;

const HALF_ULP: f64 = 0.5 * f64::EPSILON;

/// The root of the mean square, over the time from `start` on, of what rounding makes of the accelerations of bodies at some of these states, in the unit of errors
/// of velocities, 1/s: that of the worst body. Each state stands for the time since the one before: the first steps of what is stiff are short, and many.
/// States at which the equations have no value do not count.
pub(super) fn rounding(dynamics: &mut dyn Dynamics, start: f64, states: &[State]) -> f64 {
    let mut refined = Refined::new(Arc::clone(dynamics.mechanism()));
    let stride = states.len().div_ceil(MOST_LOOKS).max(1);
    // The last state is among them.
    let first = (states.len().max(1) - 1) % stride;
    let (mut sum, mut time, mut last) = (0.0, 0.0, start);
    for state in states.iter().skip(first).step_by(stride) {
        let span = state.time - last;
        last = state.time;
        if let Some(difference) = difference(dynamics, &mut refined, state) {
            sum += span * difference * difference;
            time += span;
        }
    }
    match time > 0.0 {
        true => num_traits::Float::sqrt(sum / time),
        false => 0.0,
    }
}

/// The largest difference over the bodies, as a part of max(1 SI unit, velocity).
fn difference(dynamics: &mut dyn Dynamics, refined: &mut Refined, state: &State) -> Option<f64> {
    let mechanism = Arc::clone(dynamics.mechanism());
    let exact = accelerations(refined, state).ok()?;
    let found = accelerations(dynamics, &rounded(&mechanism, state)).ok()?;
    // Besides what the equations lose, each of the numbers is one rounding off.
    let roundings = [HALF_ULP, -HALF_ULP].into_iter().cycle();
    let pairs = found.iter().zip(&exact).zip(roundings);
    let wrong: Vec<f64> = pairs.map(|((a, b), part)| (a - b) + part * a).collect();
    let q = &state.configuration;
    // Velocities of bodies are linear in the speeds, and so are changes of both.
    let wrong = mechanism.kinematics(q, &wrong).ok()?;
    let moving = mechanism.kinematics(q, &state.speeds).ok()?;
    let part = |wrong: Vector3<f64>, moving: Vector3<f64>| wrong.norm() / moving.norm().max(1.0);
    let pairs = wrong.bodies.iter().zip(&moving.bodies);
    let parts = pairs.flat_map(|(wrong, moving)| {
        [
            part(wrong.velocity_com, moving.velocity_com),
            part(
                wrong.angular_velocity_body(),
                moving.angular_velocity_body(),
            ),
        ]
    });
    let largest = parts.fold(0.0, |most, part| if part <= most { most } else { part });
    largest.is_finite().then_some(largest)
}

/// The state with a rounding of its configuration, and of where bodies are.
fn rounded(mechanism: &Mechanism, state: &State) -> State {
    let mut rounded = state.clone();
    let phi = positions::roundings(mechanism, &state.configuration);
    retract(
        mechanism,
        &state.configuration,
        &phi,
        &mut rounded.configuration,
    );
    rounded
}

/// v̄̇ without inputs, whose rounding is their own.
fn accelerations(dynamics: &mut dyn Dynamics, state: &State) -> Result<Vec<f64>, DynamicsError> {
    let layout = *dynamics.mechanism().layout();
    let (mut efforts, mut rates) = (vec![0.0; layout.freedoms], vec![0.0; layout.speeds]);
    let (q, speeds) = (&state.configuration, &state.speeds);
    let mut flow = Flow::new(dynamics, Given::default(), Form::Lagrangian);
    flow.within = state.time;
    flow.efforts(state.time, q, speeds, &mut efforts);
    flow.dynamics()
        .forward_dynamics(q, speeds, &efforts, &mut rates)?;
    Ok(rates)
}
