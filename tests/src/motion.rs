//! Simulations of random trees without efforts: the energy stays, and both forms make the same motion.

use crate::figures::{Largest, state_distance};
use crate::random::{Case, cases};
use hamel::dynamics::Reference;
use hamel::erased::AnyJoint;
use hamel::integrate::{Form, Method, Options, Solution, State, integrate, no_inputs, no_observer};
use hamel::mechanism::Kinematics;
use std::sync::Arc;

/// How long, s: a joint under gravity moves by a third of a metre, so that none meets its exception.
const DURATION: f64 = 0.25;
const LARGEST: usize = 3;
const TOLERANCE: f64 = 1e-9;

fn run(case: &Case, form: Form, tolerance: f64) -> Solution {
    let initial = State {
        time: 0.0,
        configuration: case.q.clone(),
        speeds: case.speeds.clone(),
    };
    let options = Options {
        form,
        method: Method::dormand_prince(tolerance),
        t_end: DURATION,
        samples: vec![],
    };
    let mut dynamics = Reference::new(Arc::clone(&case.mechanism));
    let solution = integrate(
        &mut dynamics,
        &initial,
        &options,
        &mut no_inputs,
        &mut no_observer,
    );
    solution.unwrap_or_else(|error| panic!("{}, {form:?}: {error}", place(case)))
}

fn place(case: &Case) -> String {
    let bodies = case.mechanism.bodies().iter();
    let names: Vec<&str> = bodies.map(|body| body.joint().name()).collect();
    format!("case {} of {}", case.seed, names.join(", "))
}

fn bodies(case: &Case, q: &[f64], speeds: &[f64]) -> Kinematics {
    case.mechanism.kinematics(q, speeds).expect("sizes fit")
}

fn end(case: &Case, solution: &Solution) -> Kinematics {
    let state = &solution.state;
    bodies(case, &state.configuration, &state.speeds)
}

/// The energy at the end is that of the start, in both forms, on trees with each kind at the root of some.
///
/// # Panics
/// With the figure and the case, where it does not hold.
pub fn energy_is_kept(kinds: &[Arc<dyn AnyJoint>]) {
    let mut worst = Largest::new("energy drift over its allowance");
    for case in cases(kinds, LARGEST, 2 * kinds.len() as u64) {
        let start = bodies(&case, &case.q, &case.speeds);
        let unit = start.energy().abs().max(start.kinetic_energy());
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let solution = run(&case, form, TOLERANCE);
            let drift = (end(&case, &solution).energy() - start.energy()).abs() / unit;
            // Each step adds up to the tolerance, relative to speeds of order 1; energy is quadratic in them.
            let allowed = 2.0 * TOLERANCE * solution.statistics.steps as f64;
            worst.meet(drift / allowed, place(&case));
        }
    }
    worst.assert_within(1.0);
}

/// Both forms end in the same state, up to the errors of both, which a tolerance ten times smaller shows.
///
/// # Panics
/// With the figure and the case, where they do not.
pub fn forms_agree(kinds: &[Arc<dyn AnyJoint>]) {
    let mut worst = Largest::new("difference of both forms over their errors");
    for case in cases(kinds, LARGEST, 2 * kinds.len() as u64) {
        let at = |form, tolerance| end(&case, &run(&case, form, tolerance));
        let [lagrangian, hamiltonian] =
            [Form::Lagrangian, Form::Hamiltonian].map(|form| at(form, TOLERANCE));
        let error = |form, coarse| state_distance(coarse, &at(form, TOLERANCE / 10.0));
        let errors = error(Form::Lagrangian, &lagrangian) + error(Form::Hamiltonian, &hamiltonian);
        // The finer run shows 0.9 of an error, and errors go up and down with the steps: factor 2. Rounding of some hundred
        // steps, each solved with an M̄ of condition up to 1e3: 1e-11, a hundredth of the tolerance.
        let allowed = 2.0 * errors + 1e-11;
        worst.meet(
            state_distance(&lagrangian, &hamiltonian) / allowed,
            place(&case),
        );
        // The comparison says something: an error is at most some thousand tolerances.
        assert!(
            errors < 1e4 * TOLERANCE,
            "{}: errors {errors:e}",
            place(&case)
        );
    }
    worst.assert_within(1.0);
}
