//! Every scene in both forms: the same motion, its conserved quantities, and rates that are those of the motion.

use hamel::dynamics::{Dynamics, Reference};
use hamel::integrate::{Form, Method, Solution};
use hamel::mechanism::Kinematics;
use hamel::nalgebra::{DMatrix, DVector};
use hamel_scene::Scene;
use hamel_tests::differences;
use hamel_tests::figures::{Largest, difference, state_distance};
use hamel_tests::scenes;
use std::sync::Arc;

/// Scenes are run for as long as they ask, up to this time, s.
const LONGEST: f64 = 10.0;
const TOLERANCE: f64 = 1e-10;

fn times(scene: &Scene) -> Vec<f64> {
    let end = scene.settings.t_end.min(LONGEST);
    (0..=20).map(|i| end * f64::from(i) / 20.0).collect()
}

fn run(scene: &Scene, form: Form, tolerance: f64) -> Solution {
    let method = Method::dormand_prince(tolerance);
    scenes::run(scene, form, method, &times(scene)).expect("the scene runs")
}

fn bodies(scene: &Scene, solution: &Solution) -> Vec<Kinematics> {
    let states = solution.samples.iter();
    states
        .map(|state| scenes::kinematics(scene, state).expect("sizes fit"))
        .collect()
}

/// Largest distance of two motions up to each sample.
fn distances(a: &[Kinematics], b: &[Kinematics]) -> Vec<f64> {
    assert_eq!(a.len(), b.len());
    let largest = |largest: &mut f64, (a, b)| {
        *largest = largest.max(state_distance(a, b));
        Some(*largest)
    };
    a.iter().zip(b).scan(0.0, largest).collect()
}

/// A scene's motion in both forms.
fn motions(scene: &Scene, tolerance: f64) -> [Vec<Kinematics>; 2] {
    [Form::Lagrangian, Form::Hamiltonian].map(|form| bodies(scene, &run(scene, form, tolerance)))
}

/// Up to each sample, the sum over both forms of what another tolerance changes.
fn changes(a: &[Vec<Kinematics>; 2], b: &[Vec<Kinematics>; 2]) -> Vec<f64> {
    let [first, second] = [0, 1].map(|i| distances(&a[i], &b[i]));
    first
        .iter()
        .zip(second)
        .map(|(first, second)| first + second)
        .collect()
}

/// The forms differ by no more than the errors of both. A tolerance ten times smaller shows 0.9 of the error that is due to the
/// tolerance, conditioning of the motion included; two tolerances that are next to nothing show what rounding does.
#[test]
fn both_forms_make_the_same_motion() {
    for scene in scenes::all() {
        let noise = changes(&motions(&scene, 1e-12), &motions(&scene, 0.8e-12));
        for tolerance in [1e-8, TOLERANCE] {
            let both = motions(&scene, tolerance);
            let errors = changes(&both, &motions(&scene, tolerance / 10.0));
            let found = distances(&both[0], &both[1]);
            let end = found.len() - 1;
            for i in [end / 2, end] {
                println!(
                    "{}, tolerance {tolerance:e}, sample {i}: forms differ by {:.1e}; errors {:.1e}, rounding {:.1e}",
                    scene.name, found[i], errors[i], noise[i]
                );
            }
            for (i, &found) in found.iter().enumerate() {
                // Factor 2 for the ups and downs of an error; rounding is random, and 1e-14 is that of the metric itself.
                let allowed = 2.0 * errors[i] + 10.0 * noise[i] + 1e-14;
                assert!(
                    found <= allowed,
                    "{}: {found:e} at sample {i} exceeds {allowed:e}",
                    scene.name
                );
            }
            // The comparison says something: up to half time, an error is at most some thousand tolerances.
            assert!(errors[end / 2] < 1e4 * tolerance, "{}", scene.name);
        }
    }
}

/// Components of the momentum about the world's origin, (angular; linear), that a scene conserves.
fn conserved(scene: &str) -> &'static [usize] {
    match scene {
        "free_body" => &[0, 1, 2, 3, 4, 5],
        // Gravity and what holds the mechanism act through the vertical axis through the origin.
        "ball_pendulum" | "plate_cart_arm" => &[2],
        _ => &[],
    }
}

#[test]
fn energy_and_momentum_are_conserved() {
    for scene in scenes::all() {
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let solution = run(&scene, form, TOLERANCE);
            let motion = bodies(&scene, &solution);
            let start = &motion[0];
            let unit = start.energy().abs().max(start.kinetic_energy());
            let mut energy = Largest::new("energy drift");
            let mut momentum = Largest::new("momentum drift");
            for (kinematics, state) in motion.iter().zip(&solution.samples) {
                let place = format!("{} s of {}, {form:?}", state.time, scene.name);
                energy.meet((kinematics.energy() - start.energy()).abs() / unit, &place);
                let change = kinematics.momentum() - start.momentum();
                for &component in conserved(&scene.name) {
                    momentum.meet(change[component].abs() / start.momentum().amax(), &place);
                }
            }
            // Each of n steps adds up to the tolerance, relative to speeds; energy is quadratic in them.
            let bound = 2.0 * TOLERANCE * solution.statistics.steps as f64;
            energy.assert_within(bound);
            if !conserved(&scene.name).is_empty() {
                momentum.assert_within(bound);
            }
        }
    }
}

/// H of the port-Hamiltonian form is the energy of the bodies.
#[test]
fn hamiltonian_is_the_energy() {
    for scene in scenes::all() {
        let mut dynamics = Reference::new(Arc::clone(&scene.mechanism));
        for state in &run(&scene, Form::Hamiltonian, TOLERANCE).samples {
            let mut momenta = vec![0.0; state.speeds.len()];
            dynamics
                .momenta(&state.configuration, &state.speeds, &mut momenta)
                .expect("sizes fit");
            let found = dynamics
                .hamiltonian(&state.configuration, &momenta)
                .expect("regular");
            let bodies = scenes::kinematics(&scene, state).expect("sizes fit");
            let size = bodies.kinetic_energy() + bodies.potential_energy().abs();
            // M̄⁻¹ M̄ v̄ has the rounding of its condition, 1e3 at most in these scenes.
            assert!(
                (found - bodies.energy()).abs() < 1e3 * f64::EPSILON * size,
                "{}",
                scene.name
            );
        }
    }
}

/// ϕ̇ and v̄̇ of the motion, by differences of order 6 over samples through Φ⁻¹, are those of (31) and (34): the integrator
/// solves the equations that it was given.
#[test]
fn rates_of_the_motion_are_those_of_the_equations() {
    let (middle, step) = (0.25, 1.0 / 512.0);
    for scene in scenes::all() {
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let samples: Vec<f64> = (-3..=3).map(|i| middle + step * f64::from(i)).collect();
            let solution = scenes::run(&scene, form, Method::dormand_prince(1e-13), &samples);
            let samples = solution.expect("the scene runs").samples;
            let at = |t: f64| &samples[((t / step).round() + 3.0) as usize];
            let mechanism = &scene.mechanism;
            let local = differences::local_rate(mechanism, step, |t| at(t).configuration.clone());
            let rates = differences::derivative(step, |t| {
                DMatrix::from_column_slice(at(t).speeds.len(), 1, &at(t).speeds)
            });
            let state = at(0.0);
            let expansion = Reference::new(Arc::clone(mechanism))
                .expansion(&state.configuration)
                .expect("sizes fit");
            let speeds = DVector::from_column_slice(&state.speeds);
            let expected = expansion.local_rate(&(&expansion.speed_basis * &speeds));
            let no_efforts = DVector::zeros(expected.len());
            let accelerations = expansion
                .reduced_accelerations(mechanism, &speeds, &no_efforts)
                .expect("regular");
            let mut worst = Largest::new("rates of the motion by differences");
            let place = format!("{}, {form:?}", scene.name);
            worst.meet(
                difference(local.as_slice(), expected.as_slice()),
                format!("ϕ̇ of {place}"),
            );
            let error = difference(rates.as_slice(), accelerations.as_slice());
            worst.meet(
                error / accelerations.amax().max(1.0),
                format!("v̄̇ of {place}"),
            );
            // Errors of the samples, some 1e-13, over the step; truncation (ωh)⁶ / 140 with ω = 13: 2e-12 of a rate.
            worst.assert_within(2e-10);
        }
    }
}
