//! Energy over ten seconds, in both forms.

use super::Case;
use hamel::dynamics::Recursive;
use hamel::integrate::{Form, Method, Options, Scheme, State, integrate, no_inputs, no_observer};
use hamel::mechanism::Mechanism;
use std::sync::Arc;

const TOLERANCE: f64 = 1e-11;

/// Local coordinates that a joint may move by for this long without coming to an end of its motion: a third of its reach in each direction.
const SHARE: f64 = 0.3;

/// Seconds.
const LONG: f64 = 10.0;

/// Holds a motion that begins at home to its energy. Mechanisms are without gravity here, so that slow ones stay within their reach.
///
/// # Panics
/// Where energy changes by more than the tolerance of all steps.
pub fn is_kept(mechanism: &Arc<Mechanism>, case: &Case<'_>) {
    let speed = SHARE * case.reach / LONG;
    let count = mechanism.layout().speeds;
    let speeds = (0..count).map(|n| if n % 2 == 0 { speed } else { -0.7 * speed });
    let initial = State {
        time: 0.0,
        configuration: mechanism.home(),
        speeds: speeds.collect(),
    };
    let energy = |state: &State| {
        let bodies = mechanism.kinematics(&state.configuration, &state.speeds);
        bodies.expect("sizes fit").kinetic_energy()
    };
    let first = energy(&initial);
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let options = Options {
            form,
            method: Method::controlled(Scheme::DormandPrince8, TOLERANCE),
            t_end: LONG,
            samples: vec![],
        };
        let mut dynamics = Recursive::new(Arc::clone(mechanism));
        let (inputs, observer) = (&mut no_inputs, &mut no_observer);
        let solution = integrate(&mut dynamics, &initial, &options, inputs, observer);
        let solution = solution.unwrap_or_else(|error| panic!("{}: {error}", case.name));
        // Each step adds up to the tolerance, relative to speeds of order 1, to speeds of this size; energy is quadratic in them.
        let allowed = 2.0 * TOLERANCE * solution.statistics.steps as f64 / speed;
        let drift = (energy(&solution.state) - first).abs() / first;
        println!("{}, {form:?}: {:.1e} of {allowed:.1e}", case.name, drift);
        assert!(drift <= allowed, "{}, {form:?}: {drift:e}", case.name);
    }
}
