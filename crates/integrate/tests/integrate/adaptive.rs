//! The discrete gradient under step control: errors follow the tolerance, steps grow and shrink, and the energy stays.

use crate::common::joints;
use crate::common::trees::body;
use crate::stiff::wheel;
use crate::support::{at, distance, estimate, mixed, options, start};
use hamel_integrate::{
    Event, Form, Integration, Method, Options, Sampling, Scheme, Solution, State, Step, integrate,
    no_inputs, no_observer,
};
use hamel_runtime::dynamics::Recursive;
use hamel_runtime::elements::{Element, JointSpring};
use hamel_runtime::mechanism::Mechanism;
use hamel_runtime::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::sync::Arc;

const GRAVITY: Vector3<f64> = Vector3::new(0.0, -9.81, 0.0);

fn to(tolerance: f64) -> Method {
    Method::controlled(Scheme::DiscreteGradient, tolerance)
}

/// Pendulums about level axes, one on the other, and a spring of each of these stiffnesses at its joint, N m/rad.
fn pendulums(stiffnesses: &[f64]) -> Arc<Mechanism> {
    let mass = || {
        let com = Vector3::new(0.0, -0.5, 0.0);
        MassProperties::new(1.0, com, Matrix3::identity() * 0.1).expect("physical")
    };
    let bodies = (0..stiffnesses.len()).map(|i| {
        let at = Pose::from_translation(Vector3::new(0.0, if i > 0 { -1.0 } else { 0.0 }, 0.0));
        body(
            &format!("body {i}"),
            i.checked_sub(1),
            joints::revolute(),
            at,
            mass(),
        )
    });
    let mechanism = Mechanism::new(GRAVITY, bodies.collect()).expect("a tree");
    let springs = stiffnesses.iter().enumerate().map(|(body, &stiffness)| {
        let spring = JointSpring {
            name: format!("spring {body}"),
            body,
            stiffness: vec![stiffness],
            rest: vec![0.3],
        };
        Arc::new(spring) as Arc<dyn Element>
    });
    Arc::new(mechanism.with_elements(springs.collect()).expect("it fits"))
}

fn run(mechanism: &Arc<Mechanism>, initial: &State, options: &Options) -> Solution {
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let solution = integrate(
        &mut dynamics,
        initial,
        options,
        &mut no_inputs,
        &mut no_observer,
    );
    solution.expect("integrates")
}

/// The slope of the logarithm of the error over that of the tolerance is 1 from 1e-4 to 1e-7, and the error is of the size of the tolerance.
#[test]
fn errors_follow_the_tolerance() {
    let mixed = mixed();
    for (mechanism, initial, t_end) in [
        (&mixed, start(&mixed, 5), 0.05),
        (&pendulums(&[2.0, 30.0]), at(&[1.0, 0.4], &[0.3, 0.0]), 0.1),
    ] {
        let exact = Method::controlled(Scheme::Verner9, 1e-15);
        let exact = run(
            mechanism,
            &initial,
            &options(Form::Lagrangian, exact, t_end),
        )
        .state;
        let errors = [1e-4, 1e-5, 1e-6, 1e-7].map(|tolerance| {
            let options = options(Form::Hamiltonian, to(tolerance), t_end);
            let found = run(mechanism, &initial, &options).state;
            (tolerance, distance(&found, &exact))
        });
        println!("{errors:?}");
        let slope = (errors[0].1 / errors[3].1).log10() / 3.0;
        assert!((0.8..=1.2).contains(&slope), "{slope}: {errors:?}");
        for (tolerance, error) in errors {
            assert!(error < 10.0 * tolerance, "{errors:?}");
        }
    }
}

/// Stiff and soft springs side by side, under step control, keep their energy as with fixed steps.
#[test]
fn steps_of_any_length_keep_the_energy() {
    for (stiffnesses, initial, t_end) in [
        // 1 rad/s and 400 rad/s.
        (&[2.0, 3e4][..], at(&[1.0, 0.31], &[0.3, 0.0]), 0.2),
        // A stiff joint below two soft ones.
        (
            &[0.0, 5.0, 1e6],
            at(&[2.0, -0.4, 0.3], &[0.0, 1.0, 0.0]),
            0.2,
        ),
    ] {
        let mechanism = pendulums(stiffnesses);
        for tolerance in [1e-2, 1e-3] {
            let kept = crate::energy::drift_by(&mechanism, &initial, to(tolerance), t_end);
            println!("{stiffnesses:?}, {tolerance:e}: {kept:e}");
            // As for fixed steps: what comes to 16 roundings of energies of up to ten times the kinetic one.
            assert!(kept < 4e-14, "{kept:e}");
        }
    }
}

/// A pendulum that falls from nearly upright creeps, swings through, and creeps again; its energy stays where it was.
#[test]
fn steps_grow_again_after_a_fast_phase() {
    let mechanism = pendulums(&[0.0]);
    let initial = at(&[PI - 1e-3], &[0.0]);
    let mut steps: Vec<(f64, f64)> = Vec::new();
    let energy = |step: &Step<'_>| {
        let placed = mechanism.kinematics(step.configuration, step.speeds);
        placed.expect("sizes fit").energy()
    };
    let (mut last, mut first, mut worst) = (0.0, f64::NAN, 0.0_f64);
    let mut observe = |step: &Step<'_>| {
        if step.number == 0 {
            first = energy(step);
        }
        worst = worst.max((energy(step) - first).abs());
        if step.number > 0 {
            steps.push((step.time - last, step.configuration[0]));
        }
        last = step.time;
        ControlFlow::Continue(())
    };
    let options = options(Form::Hamiltonian, to(1e-5), 4.4);
    let mut dynamics = Recursive::new(Arc::clone(&mechanism));
    let solution = integrate(
        &mut dynamics,
        &initial,
        &options,
        &mut no_inputs,
        &mut observe,
    );
    let statistics = solution.expect("integrates").statistics;
    let longest = |is_there: fn(f64) -> bool| {
        let own = steps.iter().filter(|(_, angle)| is_there(*angle));
        own.fold(0.0_f64, |most, (step, _)| most.max(*step))
    };
    let before = longest(|angle| angle > 3.0);
    let fast = longest(|angle| angle.abs() < 0.5);
    let after = longest(|angle| angle < -3.0);
    println!("{before:e}, {fast:e}, {after:e}, {statistics:?}");
    assert!(
        before > 4.0 * fast && after > 4.0 * fast,
        "{before:e}, {fast:e}, {after:e}"
    );
    assert!(statistics.rejected < 10, "{statistics:?}");
    // The method leaves 16 roundings of 5 J and of the kinetic energy, 10 J; a few roundings of these are those of the energies here.
    assert!(worst < 7e-14, "{worst:e}");
}

fn moved(mechanism: &Arc<Mechanism>, initial: &State, options: &Options) -> Solution {
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let integration = Integration::new(&mut dynamics, initial, options);
    let integration = integration.sampling(Sampling::Dense);
    let level = Event::new("level", |_, q, _| q[0]);
    integration.event(level).run().expect("integrates")
}

/// Dense output and events are as accurate as the ends of steps.
#[test]
fn events_and_samples_follow_the_tolerance() {
    let mechanism = pendulums(&[2.0]);
    let initial = at(&[2.0], &[0.3]);
    let by = |form: Form, method: Method| {
        let samples = (1..20).map(|i| 0.1 * f64::from(i)).collect();
        let options = Options {
            samples,
            ..options(form, method, 2.0)
        };
        moved(&mechanism, &initial, &options)
    };
    let exact = by(Form::Lagrangian, Method::controlled(Scheme::Verner9, 1e-14));
    for tolerance in [1e-4, 1e-6] {
        let found = by(Form::Hamiltonian, to(tolerance));
        assert_eq!(found.events.len(), exact.events.len());
        for (found, exact) in found.events.iter().zip(&exact.events) {
            let error = (found.state.time - exact.state.time).abs();
            assert!(error < 10.0 * tolerance, "{tolerance:e}: {error:e}");
        }
        for (found, exact) in found.samples.iter().zip(&exact.samples) {
            let error = distance(found, exact);
            assert!(error < 10.0 * tolerance, "{tolerance:e}: {error:e}");
        }
    }
}

/// The error that is told of a motion is the one that it has, within a factor of three.
#[test]
fn the_error_is_estimated() {
    let mechanism = pendulums(&[2.0]);
    let initial = at(&[2.0], &[0.3]);
    let exact = Method::controlled(Scheme::Verner9, 1e-14);
    let exact = run(&mechanism, &initial, &options(Form::Lagrangian, exact, 2.0)).state;
    for tolerance in [1e-4, 1e-6] {
        let options = options(Form::Hamiltonian, to(tolerance), 2.0);
        let found = run(&mechanism, &initial, &options);
        let told = estimate(&mechanism, &initial, &options, &found);
        let error = distance(&found.state, &exact);
        println!("{tolerance:e}: {error:e}, {told:?}");
        assert_eq!(told.doubt, None);
        let ratio = told.end.total() / error;
        assert!((1.0 / 3.0..=3.0).contains(&ratio), "{tolerance:e}: {ratio}");
    }
}

/// A stiff damper takes nearly all of the energy away, so that rounding of what it took is much beside what is left.
#[test]
fn what_damps_away_is_followed_to_its_end() {
    let mechanism = wheel(1e8, 2e4);
    let initial = at(&[0.5], &[0.0]);
    for tolerance in [1e-4, 1e-6] {
        let found = run(
            &mechanism,
            &initial,
            &options(Form::Hamiltonian, to(tolerance), 0.1),
        );
        println!("{:?}, {:?}", found.state, found.statistics);
        // Critically damped at 1e4 rad/s: nothing is left of it.
        assert!(found.state.configuration[0].abs() < tolerance);
        assert!(found.state.speeds[0].abs() < tolerance);
    }
}

/// Two pendulums whose potential energies cancel, and in each the heights of pivot and centre of mass: rounding is that of each height.
#[test]
fn energies_that_cancel_are_rounded_as_each() {
    let com = Vector3::new(0.3, -1.0, 0.0);
    let mass = || MassProperties::new(1.0, com, Matrix3::identity() * 0.1).expect("physical");
    let pendulum = |name: &str, height: f64| {
        let at = Pose::from_translation(Vector3::new(0.0, height, 0.0));
        body(name, None, joints::revolute(), at, mass())
    };
    let bodies = ["level", "upper", "lower"]
        .into_iter()
        .zip([1.0, 3.0, -1.0]);
    let bodies = bodies
        .map(|(name, height)| pendulum(name, height))
        .collect();
    let mechanism = Arc::new(Mechanism::new(GRAVITY, bodies).expect("sound bodies"));
    let initial = at(&[0.0; 3], &[0.0; 3]);
    for tolerance in [1e-6, 1e-8] {
        let options = options(Form::Hamiltonian, to(tolerance), 0.2);
        let found = run(&mechanism, &initial, &options);
        let exact = Method::controlled(Scheme::Verner9, 1e-13);
        let exact = run(
            &mechanism,
            &initial,
            &self::options(Form::Lagrangian, exact, 0.2),
        );
        let error = distance(&found.state, &exact.state);
        println!("{tolerance:e}: {error:e}, {:?}", found.statistics);
        assert!(error < 10.0 * tolerance, "{tolerance:e}: {error:e}");
    }
}

/// Without any energy λ is not determined.
#[test]
fn what_rests_stays_at_rest() {
    let options = options(Form::Hamiltonian, to(1e-6), 10.0);
    let found = run(&wheel(1e4, 0.0), &at(&[0.0], &[0.0]), &options);
    assert_eq!(found.state.configuration, [0.0]);
    assert_eq!(found.state.speeds, [0.0]);
    assert!(found.statistics.steps < 20, "{:?}", found.statistics);
}
