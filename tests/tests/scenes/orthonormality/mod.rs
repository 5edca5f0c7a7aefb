//! Rotation matrices stay rotation matrices: ‖RᵀR − I‖ ≤ 1e-14 at each of a million steps, in both forms.

mod body;

use body::OneBody;
use chacha20::ChaCha8Rng;
use hamel::dynamics::{Dynamics, Reference};
use hamel::integrate::{Form, Method, Options, State, Step, integrate, no_inputs};
use hamel::mechanism::{BodySpec, Mechanism};
use hamel::nalgebra::{Matrix3, Vector3};
use hamel::spatial::{MassProperties, Pose};
use hamel_tests::figures::{difference, size};
use hamel_tests::random::{configuration, library, numbers};
use rand::SeedableRng;
use std::ops::ControlFlow;
use std::sync::Arc;

const STEPS: usize = 1_000_000;
const ALLOWED: f64 = 1e-14;

/// An asymmetric body on one joint, without gravity.
fn mechanism(joint: &str) -> Arc<Mechanism> {
    let joint = library()
        .into_iter()
        .find(|other| other.name() == joint)
        .expect("in the library");
    let inertia = Matrix3::new(0.9, 0.1, 0.0, 0.1, 1.2, -0.2, 0.0, -0.2, 1.6);
    let body = BodySpec {
        name: "body".into(),
        joint_name: "joint".into(),
        parent: None,
        joint,
        placement: Pose::identity(),
        child_placement: Pose::identity(),
        mass: MassProperties::new(1.5, Vector3::new(0.1, 0.0, -0.1), inertia).expect("physical"),
    };
    Arc::new(Mechanism::new(Vector3::zeros(), vec![body]).expect("valid"))
}

/// `‖RᵀR − I‖`, by Frobenius.
fn deviation(rotation: &Matrix3<f64>) -> f64 {
    (rotation.tr_mul(rotation) - Matrix3::identity()).norm()
}

fn check<const K: usize>(joint: &str, form: Form, speeds: &[f64; K]) {
    let mechanism = mechanism(joint);
    let body = &mechanism.bodies()[0];
    let (mut worst, mut last, mut turned) = (0.0_f64, 0, 0.0_f64);
    let mut observe = |step: &Step<'_>| {
        let rotation = body.joint().pose(step.configuration).rotation;
        let deviation = deviation(&rotation);
        assert!(!deviation.is_nan());
        worst = worst.max(deviation);
        turned = turned.max((rotation - Matrix3::identity()).norm());
        last = step.number;
        ControlFlow::Continue(())
    };
    let dt = 1e-2;
    let options = Options {
        form,
        method: Method::rk4(dt),
        t_end: dt * STEPS as f64,
        samples: Vec::new(),
    };
    let initial = State {
        time: 0.0,
        configuration: mechanism.home(),
        speeds: speeds.to_vec(),
    };
    let mut dynamics = OneBody::<K>::new(Arc::clone(&mechanism));
    integrate(
        &mut dynamics,
        &initial,
        &options,
        &mut no_inputs,
        &mut observe,
    )
    .expect("the body turns on");
    println!("{joint}, {form:?}: {worst:.1e} in {last} steps");
    assert!(last >= STEPS, "{last} steps");
    assert!(worst <= ALLOWED, "{joint}: {worst:e}");
    // The largest that this norm can be is 2√2, at half a turn: the body has been everywhere.
    assert!(turned > 2.8, "{joint}: {turned}");
}

#[test]
fn free_body() {
    check("free", Form::Lagrangian, &[0.3, 2.0, -0.4, 0.1, 0.0, -0.2]);
}

#[test]
fn free_body_in_momenta() {
    check("free", Form::Hamiltonian, &[0.3, 2.0, -0.4, 0.1, 0.0, -0.2]);
}

#[test]
fn ball_joint() {
    check("ball", Form::Lagrangian, &[0.3, 2.0, -0.4]);
}

#[test]
fn ball_joint_in_momenta() {
    check("ball", Form::Hamiltonian, &[0.3, 2.0, -0.4]);
}

/// The equations that the million steps take are those of the reference form.
fn compare<const K: usize>(joint: &str) {
    let mechanism = mechanism(joint);
    for seed in 0..10 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let q = configuration(&mut random, &mechanism);
        let (y, efforts) = (numbers(&mut random, K), numbers(&mut random, K));
        let mut one_body = OneBody::<K>::new(Arc::clone(&mechanism));
        let mut reference = Reference::new(Arc::clone(&mechanism));
        let forms: [&mut dyn Dynamics; 2] = [&mut one_body, &mut reference];
        let results = forms.map(|form| {
            let mut out = vec![0.0; 4 * K];
            let (rates, rest) = out.split_at_mut(K);
            let (momenta, rest) = rest.split_at_mut(K);
            let (speeds, momentum_rates) = rest.split_at_mut(K);
            form.forward_dynamics(&q, &y, &efforts, rates)
                .expect("regular");
            form.momenta(&q, &y, momenta).expect("sizes fit");
            let mut apply = |_: &[f64], tau: &mut [f64]| tau.copy_from_slice(&efforts);
            form.momentum_rates(&q, momenta, &mut apply, speeds, momentum_rates)
                .expect("regular");
            let energy = form.hamiltonian(&q, momenta).expect("regular");
            out.push(energy);
            out
        });
        // Some ten roundings, and M with a condition below 10.
        let error = difference(&results[0], &results[1]) / size(&results[1]);
        assert!(error < 1e-14, "{joint}: {error:e}");
    }
}

#[test]
fn equations_are_those_of_the_reference_form() {
    compare::<6>("free");
    compare::<3>("ball");
}
