//! The joint torque regressor and the energy regressor against inverse dynamics, energies, differences in parameters, and closed forms.

use hamel::dynamics::{Dynamics, JointTorqueRegressor, Recursive};
use hamel::erased::AnyJoint;
use hamel::mechanism::{BodySpec, Mechanism, StateError};
use hamel::nalgebra::{DVector, Matrix3, Vector3};
use hamel::spatial::{MassProperties, Pose};
use hamel_tests::derivatives::Equipped;
use hamel_tests::figures::{Largest, size};
use hamel_tests::random::{Case, cases, library, slender_cases};
use std::sync::Arc;

/// Some dozen roundings of the largest of the terms that are summed, for each body on the way to the root; trees are up to 20 joints deep.
const ROUNDING: f64 = 1e-13;

fn all() -> Vec<Case> {
    let library = library();
    let equipped = cases(&library, 12, 80).map(|case| Equipped::fully(case).case);
    let bare = cases(&library, 20, 160);
    bare.chain(equipped)
        .chain(slender_cases(&library, 6, 40))
        .collect()
}

fn place(case: &Case) -> String {
    let root = case.mechanism.bodies()[0].joint().name();
    let count = case.mechanism.bodies().len();
    format!("case {} of {count} bodies on {root}", case.seed)
}

/// The sum of the absolute values of the terms of `Y π + τ₀`, of the largest row.
fn terms(regressor: &JointTorqueRegressor, parameters: &[f64]) -> f64 {
    let parameters = DVector::from_column_slice(parameters).abs();
    let sums = regressor.matrix().abs() * parameters;
    sums.max() + size(regressor.rest())
}

#[test]
fn the_regressor_times_the_parameters_is_inverse_dynamics() {
    let mut met = Largest::new("Y π + τ₀ against inverse dynamics, of its terms");
    for case in all() {
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let mut regressor = JointTorqueRegressor::new(&case.mechanism);
        let (q, v, a) = (&case.q, &case.speeds, &case.rates);
        dynamics
            .joint_torque_regressor(q, v, a, &mut regressor)
            .expect("a state");
        let parameters = case.mechanism.inertial_parameters();
        let (mut found, mut expected) = (vec![0.0; v.len()], vec![0.0; v.len()]);
        regressor.efforts(&parameters, &mut found).expect("sizes");
        dynamics
            .inverse_dynamics(q, v, a, &mut expected)
            .expect("a state");
        let scale = terms(&regressor, &parameters);
        for (found, expected) in found.iter().zip(&expected) {
            met.meet((found - expected).abs() / scale, place(&case));
        }
    }
    met.assert_within(ROUNDING);
}

/// The mechanism with other inertial parameters of one body.
fn with_parameters(mechanism: &Mechanism, body: usize, parameters: &[f64; 10]) -> Mechanism {
    let bodies = mechanism.bodies().iter().enumerate();
    let specs = bodies.map(|(index, own)| BodySpec {
        name: own.name().to_owned(),
        joint_name: own.joint_name().to_owned(),
        parent: own.parent(),
        joint: own.shared_joint(),
        placement: *own.placement(),
        child_placement: *own.child_placement(),
        mass: match index == body {
            true => MassProperties::from_inertial_parameters(parameters).expect("physical"),
            false => *own.mass(),
        },
    });
    Mechanism::new(*mechanism.gravity(), specs.collect()).expect("as before")
}

/// Heavy enough that a unit more of any parameter is a body too.
const HEAVY: [f64; 10] = [16.0, 1.0, -2.0, 3.0, 40.0, 1.0, 44.0, -2.0, 1.0, 48.0];

#[test]
fn columns_are_differences_in_the_parameters() {
    let mut met = Largest::new("columns of Y against differences of step 1, of the efforts");
    for case in cases(&library(), 5, 74) {
        let body = case.seed as usize % case.mechanism.bodies().len();
        let (q, v, a) = (&case.q, &case.speeds, &case.rates);
        let mut regressor = JointTorqueRegressor::new(&case.mechanism);
        Recursive::new(Arc::clone(&case.mechanism))
            .joint_torque_regressor(q, v, a, &mut regressor)
            .expect("a state");
        let efforts = |parameters: &[f64; 10]| {
            let mechanism = with_parameters(&case.mechanism, body, parameters);
            let mut efforts = vec![0.0; v.len()];
            Recursive::new(Arc::new(mechanism))
                .inverse_dynamics(q, v, a, &mut efforts)
                .expect("a state");
            efforts
        };
        let before = efforts(&HEAVY);
        for parameter in 0..10 {
            let mut more = HEAVY;
            more[parameter] += 1.0;
            let after = efforts(&more);
            let scale = 1.0 + size(&before) + size(&after);
            for (row, (after, before)) in after.iter().zip(&before).enumerate() {
                let entry = regressor.entry(row, 10 * body + parameter);
                met.meet((entry - (after - before)).abs() / scale, place(&case));
            }
        }
    }
    met.assert_within(ROUNDING);
}

#[test]
fn energies_are_linear_in_the_parameters() {
    let mut met = Largest::new("energies by their regressor, of their terms");
    for case in all() {
        let state = case
            .mechanism
            .kinematics(&case.q, &case.speeds)
            .expect("a state");
        let regressor = case
            .mechanism
            .energy_regressor(&case.q, &case.speeds)
            .expect("a state");
        let parameters = case.mechanism.inertial_parameters();
        let sum = |row: &[f64], rest: f64| {
            let terms = row.iter().zip(&parameters).map(|(a, b)| a * b);
            let size = terms.clone().map(f64::abs).sum::<f64>() + rest.abs();
            (terms.sum::<f64>() + rest, size)
        };
        for (row, rest, expected) in [
            (
                &regressor.kinetic,
                regressor.kinetic_rest,
                state.kinetic_energy(),
            ),
            (
                &regressor.potential,
                regressor.potential_rest,
                state.potential_energy(),
            ),
        ] {
            let (found, size) = sum(row, rest);
            met.meet(
                (found - expected).abs() / size.max(f64::MIN_POSITIVE),
                place(&case),
            );
        }
    }
    met.assert_within(ROUNDING);
}

fn revolute() -> Arc<dyn AnyJoint> {
    let registry = hamel_joints::registry();
    let entry = registry.get("revolute").expect("in the library");
    (entry.build)(&[]).expect("no parameters")
}

/// A pendulum about the world's z axis, gravity along −y.
fn pendulum() -> Mechanism {
    let bob = BodySpec {
        name: "bob".into(),
        joint_name: "pivot".into(),
        parent: None,
        joint: revolute(),
        placement: Pose::identity(),
        child_placement: Pose::identity(),
        mass: MassProperties::new(1.0, Vector3::x(), Matrix3::identity()).expect("physical"),
    };
    Mechanism::new(Vector3::new(0.0, -9.81, 0.0), vec![bob]).expect("a pendulum")
}

#[test]
fn a_pendulum_has_the_regressor_of_its_textbook_equation() {
    // I_zz q̈ + g (mc_x cos q − mc_y sin q) = τ.
    let mechanism = Arc::new(pendulum());
    let mut regressor = JointTorqueRegressor::new(&mechanism);
    let mut dynamics = Recursive::new(mechanism);
    for (angle, speed, rate) in [(0.3_f64, 2.0, -1.5), (-2.1, -0.7, 0.0), (1.0, 0.0, 4.0)] {
        dynamics
            .joint_torque_regressor(&[angle], &[speed], &[rate], &mut regressor)
            .expect("a state");
        let mut expected = [0.0; 10];
        expected[1] = 9.81 * angle.cos();
        expected[2] = -9.81 * angle.sin();
        expected[9] = rate;
        for (found, expected) in regressor.entries().iter().zip(expected) {
            // Cosines of the joint's own and a product.
            assert!(
                (found - expected).abs() < 1e-14,
                "{found} against {expected}"
            );
        }
        assert_eq!(regressor.rest(), [0.0]);
    }
}

#[test]
fn wrong_input_is_told() {
    let mechanism = Arc::new(pendulum());
    let mut regressor = JointTorqueRegressor::new(&mechanism);
    let mut dynamics = Recursive::new(Arc::clone(&mechanism));
    let mut refused = |q: &[f64], v: &[f64], a: &[f64], regressor: &mut JointTorqueRegressor| {
        dynamics
            .joint_torque_regressor(q, v, a, regressor)
            .expect_err("it is refused")
    };
    let error = refused(&[0.0], &[0.0, 1.0], &[0.0], &mut regressor);
    assert_eq!(
        error.to_string(),
        "speeds of the mechanism has 2 entries: it must have 1"
    );
    let error = refused(&[0.0], &[0.0], &[f64::NAN], &mut regressor);
    assert!(matches!(error, StateError::NotFinite { .. }), "{error}");
    let twice = hamel_tests::scenes::load("double_ball_pendulum").mechanism;
    let mut other = JointTorqueRegressor::new(&twice);
    let error = refused(&[0.0], &[0.0], &[0.0], &mut other);
    assert_eq!(
        error.to_string(),
        "regressor of the mechanism has 6 entries: it must have 1"
    );
    let error = regressor
        .efforts(&[0.0; 9], &mut [0.0])
        .expect_err("one is missing");
    assert_eq!(
        error.to_string(),
        "inertial parameters of the mechanism has 9 entries: it must have 10"
    );
    // What no row and no column has.
    assert_eq!(regressor.entry(1, 0), 0.0);
    assert_eq!(regressor.entry(0, 10), 0.0);
    assert_eq!(dynamics.mechanism().bodies().len(), 1);
}
