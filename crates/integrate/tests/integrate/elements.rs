//! Springs, dampers, wrenches, rotors and drives: the forms of the dynamics agree on them, and energy is accounted for.

use crate::common::actuation::{driven, equipped, losses, springs};
use crate::common::random::Random;
use crate::common::readings::{assert_same, readings};
use crate::common::trees::{configuration, trees};
use hamel_integrate::{
    Form, Integration, Method, Options, Sampling, State, integrate, no_inputs, no_observer,
};
use hamel_runtime::dynamics::{Dynamics, MassMatrix, Recursive, Reference};
use hamel_runtime::elements::{BodyWrench, Element, JointDamper, WrenchAxes};
use hamel_runtime::time_function::TimeFunction;
use nalgebra::{DVector, Vector3};
use std::sync::Arc;

/// As in the comparison without elements, whose condition these mechanisms share.
const ROUNDING: f64 = 1e-12;

/// Tolerance 1e-12 a step and up to some hundred steps of forces of size 10.
const DRIFT: f64 = 1e-8;

fn same(found: &[f64], expected: &[f64], what: &str) {
    assert_same(found, expected, ROUNDING, what);
}

#[test]
fn forms_agree_with_and_without_drives() {
    for (seed, tree) in trees().into_iter().enumerate() {
        let equipped = equipped(seed as u64, &tree, losses);
        for mechanism in [equipped.clone(), driven(equipped)] {
            let mechanism = Arc::new(mechanism);
            let mut random = Random::new(seed as u64);
            let q = configuration(&mut random, &mechanism);
            let v = random.vec(mechanism.layout().speeds);
            let tau = random.vec(mechanism.layout().freedoms);
            let found = readings(&mut Recursive::new(Arc::clone(&mechanism)), &q, &v, &tau);
            let expected = readings(&mut Reference::new(Arc::clone(&mechanism)), &q, &v, &tau);
            same(&found, &expected, &format!("tree {seed}"));
            let kinematics = mechanism.kinematics(&q, &v).expect("sizes fit");
            same(
                &[kinematics.energy()],
                &[*found.last().expect("energy")],
                "energy",
            );
        }
    }
}

#[test]
fn inverse_dynamics_inverts_forward_dynamics() {
    for (seed, tree) in trees().into_iter().enumerate() {
        let mechanism = Arc::new(equipped(seed as u64, &tree, losses));
        let mut random = Random::new(seed as u64);
        let q = configuration(&mut random, &mechanism);
        let v = random.vec(mechanism.layout().speeds);
        let tau = random.vec(mechanism.layout().freedoms);
        let mut dynamics = Recursive::new(Arc::clone(&mechanism));
        let (mut rates, mut found) = (vec![0.0; v.len()], vec![0.0; v.len()]);
        dynamics
            .forward_dynamics(&q, &v, &tau, &mut rates)
            .expect("regular");
        dynamics
            .inverse_dynamics(&q, &v, &rates, &mut found)
            .expect("sizes fit");
        let expansion = Reference::new(Arc::clone(&mechanism))
            .expansion(&q)
            .expect("sizes");
        let expected = expansion
            .speed_basis
            .tr_mul(&DVector::from_column_slice(&tau));
        same(&found, expected.as_slice(), "efforts");
        let mut mass = MassMatrix::new(&mechanism);
        dynamics.mass_matrix(&q, &mut mass).expect("sizes fit");
        let expected = expansion.reduced_mass_matrix();
        same(
            mass.matrix().as_slice(),
            expected.as_slice(),
            "mass matrix with rotors",
        );
    }
}

#[test]
fn springs_keep_the_energy_in_both_forms() {
    for (seed, tree) in trees().into_iter().enumerate() {
        let mechanism = Arc::new(equipped(seed as u64, &tree, springs));
        let initial = State {
            time: 0.0,
            configuration: mechanism.home(),
            speeds: Random::new(seed as u64).vec(mechanism.layout().speeds),
        };
        let before = mechanism
            .kinematics(&initial.configuration, &initial.speeds)
            .expect("sizes fit");
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let options = Options {
                form,
                method: Method::dormand_prince(1e-12),
                t_end: 0.3,
                samples: Vec::new(),
            };
            let mut dynamics = Recursive::new(Arc::clone(&mechanism));
            let solution = integrate(
                &mut dynamics,
                &initial,
                &options,
                &mut no_inputs,
                &mut no_observer,
            )
            .expect("runs");
            let state = &solution.state;
            let after = mechanism
                .kinematics(&state.configuration, &state.speeds)
                .expect("sizes fit");
            let drift = (after.energy() - before.energy()).abs() / before.kinetic_energy().max(1.0);
            assert!(drift < DRIFT, "tree {seed}, {form:?}: {drift:e}");
        }
    }
}

#[test]
fn driven_joint_follows_its_law() {
    let tree = &trees()[0];
    let mechanism = Arc::new(driven((**tree).clone()));
    // The law holds from the start, whatever the initial speeds are.
    let initial = State {
        time: 0.0,
        configuration: mechanism.home(),
        speeds: vec![0.0; mechanism.layout().speeds],
    };
    let options = Options {
        form: Form::Hamiltonian,
        method: Method::dormand_prince(1e-12),
        t_end: 2.0,
        samples: (1..30).map(|i| f64::from(i) / 15.7).collect(),
    };
    let mut dynamics = Recursive::new(Arc::clone(&mechanism));
    let integration = Integration::new(&mut dynamics, &initial, &options);
    let solution = integration.sampling(Sampling::Dense).run().expect("runs");
    let TimeFunction::Sine(law) = mechanism.drives()[0].laws[0] else {
        panic!("the motions of these tests are sines");
    };
    let displacement =
        |t: f64| law.rate * t + law.amplitude * (law.frequency * t + law.phase).sin();
    let own = mechanism.bodies()[mechanism.drives()[0].body]
        .ranges()
        .clone();
    // At the end as well as between the ends of steps.
    for state in solution.samples.iter().chain([&solution.state]) {
        let turned = state.configuration[own.configuration.start];
        let exact = displacement(state.time) - displacement(0.0);
        // Some fifty steps at 1e-12.
        assert!((turned - exact).abs() < 1e-10);
        let speed = state.speeds[own.speeds.start];
        // The speed is that of the law; its momentum is what is kept.
        assert!((speed - law.velocity(state.time)).abs() < 1e-15);
    }
    assert_eq!(solution.samples.len(), 29);
}

#[test]
fn misfits_are_named() {
    let tree = &trees()[1];
    let damper = |body: usize, c: f64| -> Arc<dyn Element> {
        Arc::new(JointDamper {
            name: "damper".into(),
            body,
            coefficients: vec![c],
        })
    };
    let errors = (**tree)
        .clone()
        .with_elements(vec![damper(99, 1.0), damper(0, -1.0)])
        .expect_err("misfits");
    let texts: Vec<String> = errors.iter().map(ToString::to_string).collect();
    let count = tree.bodies().len();
    assert_eq!(
        texts[0],
        format!("damper: there is no body of index 99, the mechanism has {count}")
    );
    assert_eq!(texts.len(), 2, "{texts:?}");
    let push = BodyWrench {
        name: "push".into(),
        body: 0,
        point: Vector3::new(f64::NAN, 0.0, 0.0),
        force: Vector3::zeros(),
        moment: Vector3::zeros(),
        axes: WrenchAxes::World,
    };
    let errors = (**tree)
        .clone()
        .with_elements(vec![Arc::new(push)])
        .expect_err("NaN");
    assert_eq!(
        errors[0].to_string(),
        "push: point is NaN, it must be finite"
    );
}
