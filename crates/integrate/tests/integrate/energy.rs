//! Discrete gradients keep the energy balance, at any speed and under inputs; the midpoint rule alone does not.

use crate::support::{mixed, on_axis, options, start};
use hamel_integrate::{Form, Method, Scheme, State, Step, integrate};
use hamel_runtime::dynamics::Recursive;
use hamel_runtime::elements::JointSpring;
use hamel_runtime::mechanism::Mechanism;
use nalgebra::{Matrix3, Vector3};
use std::ops::ControlFlow;
use std::sync::Arc;

/// The largest change of the energy over a run, as a part of the largest kinetic energy.
fn drift(mechanism: &Arc<Mechanism>, initial: &State, scheme: Scheme, dt: f64, t_end: f64) -> f64 {
    let method = Method::fixed(scheme, dt);
    drift_by(mechanism, initial, method, t_end)
}

/// [`drift`] by any method.
pub fn drift_by(mechanism: &Arc<Mechanism>, initial: &State, method: Method, t_end: f64) -> f64 {
    let torque = vec![0.0; mechanism.layout().freedoms];
    drift_under(mechanism, initial, (method, t_end), &torque)
}

/// [`drift`] under constant torques about the axes of joints that count turns, with their potential `−τ · q`.
fn drift_under(
    mechanism: &Arc<Mechanism>,
    initial: &State,
    (method, t_end): (Method, f64),
    torque: &[f64],
) -> f64 {
    let work = |q: &[f64]| -> f64 {
        let turned = q.iter().zip(&initial.configuration);
        torque
            .iter()
            .zip(turned)
            .map(|(t, (to, from))| t * (to - from))
            .sum()
    };
    let first = mechanism
        .kinematics(&initial.configuration, &initial.speeds)
        .expect("sizes fit");
    let (mut worst, mut kinetic) = (0.0_f64, 0.0_f64);
    let mut observe = |step: &Step<'_>| {
        let now = mechanism
            .kinematics(step.configuration, step.speeds)
            .expect("sizes fit");
        let change = now.energy() - first.energy() - work(step.configuration);
        worst = worst.max(change.abs());
        kinetic = kinetic.max(now.kinetic_energy());
        ControlFlow::Continue(())
    };
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let options = options(Form::Hamiltonian, method, t_end);
    let mut held = |_: f64, _: &[f64], _: &[f64], tau: &mut [f64]| tau.copy_from_slice(torque);
    integrate(&mut dynamics, initial, &options, &mut held, &mut observe).expect("integrates");
    worst / kinetic
}

#[test]
fn discrete_gradients_keep_the_energy() {
    let mechanism = mixed();
    for (seed, dt) in [(5, 0.02), (6, 0.005)] {
        let initial = start(&mechanism, seed);
        let kept = drift(&mechanism, &initial, Scheme::DiscreteGradient, dt, 2.0);
        let plain = drift(&mechanism, &initial, Scheme::Midpoint, dt, 2.0);
        println!("{dt}: {kept:e}, midpoint {plain:e}");
        // Sums of eleven speeds and five bodies, evaluated here in another way than there.
        assert!(kept < 1e-13, "{kept:e}");
        assert!(plain > 1e-7, "{plain:e}: a case that says nothing");
    }
}

/// A pendulum about a level axis on a spring, whose rest and whose lowest point are apart: its swings are not symmetric.
fn pendulum() -> Arc<Mechanism> {
    let body = on_axis(Vector3::new(0.0, -0.5, 0.0), Matrix3::identity() * 0.1);
    let gravity = Vector3::new(0.0, -9.81, 0.0);
    let mechanism = Mechanism::new(gravity, vec![body]).expect("one body");
    let spring = JointSpring {
        name: "spring".into(),
        body: 0,
        stiffness: vec![2.0],
        rest: vec![1.3],
    };
    Arc::new(
        mechanism
            .with_elements(vec![Arc::new(spring)])
            .expect("it fits"),
    )
}

/// One degree of freedom passes its fastest point twice a swing, where the momentum hardly changes in a step, and comes to rest twice.
#[test]
fn swings_of_one_joint_keep_their_energy() {
    let mechanism = pendulum();
    for (dt, start) in [(0.011, 2.0), (0.037, -1.1), (0.1, 2.9)] {
        let initial = State {
            time: 0.0,
            configuration: vec![start],
            speeds: vec![0.3],
        };
        let t_end = 20_000.0 * dt;
        let kept = drift(&mechanism, &initial, Scheme::DiscreteGradient, dt, t_end);
        println!("{dt}: {kept:e}");
        // The method leaves what comes to 16 roundings of energies that are up to ten times the kinetic one here.
        assert!(kept < 4e-14, "{dt}: {kept:e}");
    }
}

/// The work of inputs is that over the way that the joint goes in a step: a constant torque has a potential, and its sum with the energy stays.
#[test]
fn the_balance_with_constant_torques_holds() {
    let mechanism = pendulum();
    for (dt, torque) in [(0.011, 1.5), (0.037, -4.0), (0.1, 0.3)] {
        let initial = State {
            time: 0.0,
            configuration: vec![0.4],
            speeds: vec![-0.2],
        };
        let method = Method::fixed(Scheme::DiscreteGradient, dt);
        let by = (method, 5_000.0 * dt);
        let kept = drift_under(&mechanism, &initial, by, &[torque]);
        println!("{dt}, {torque} N m: {kept:e}");
        // Each of 5000 steps ends where its increments change by less than 4 roundings, which is work of up to 4 N m over kinetic energies of some 1 J.
        assert!(kept < 2e-11, "{dt}: {kept:e}");
    }
}

/// A sprung wheel obeys a linear equation: its swings look the same at every amplitude, also where a step takes four radians of them.
#[test]
fn swings_of_every_amplitude_keep_their_energy() {
    let body = on_axis(Vector3::zeros(), Matrix3::identity());
    let mechanism = Mechanism::new(Vector3::zeros(), vec![body]).expect("one body");
    let spring = JointSpring {
        name: "spring".into(),
        body: 0,
        stiffness: vec![1.0e4],
        rest: mechanism.home(),
    };
    let mechanism = mechanism.with_elements(vec![Arc::new(spring)]);
    let mechanism = Arc::new(mechanism.expect("it fits"));
    for amplitude in [1.0, 1e-4, 1e-8, 1e-12] {
        for step_in_radians in [0.1, 1.0, 4.0] {
            let initial = State {
                time: 0.0,
                configuration: vec![amplitude],
                speeds: vec![0.0],
            };
            let dt = step_in_radians / 100.0;
            let span = 2_000.0 * dt;
            let kept = drift(&mechanism, &initial, Scheme::DiscreteGradient, dt, span);
            // The midpoint rule keeps energies that are quadratic, up to the rounding of each step.
            let plain = drift(&mechanism, &initial, Scheme::Midpoint, dt, span);
            println!("{amplitude}, {step_in_radians}: {kept:e}, midpoint {plain:e}");
            // The method leaves what comes to 16 roundings of the energy and of the kinetic energy, and speeds and angles are rounded thereafter.
            assert!(kept < 2e-14, "{amplitude}, {step_in_radians}: {kept:e}");
            // A rounding in each of 2000 steps.
            assert!(plain < 5e-13, "{amplitude}, {step_in_radians}: {plain:e}");
        }
    }
}
