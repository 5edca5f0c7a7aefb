//! Base parameters of arms from textbooks, and of mixed trees of joints by hand.

use crate::common::joints::revolute;
use crate::common::random::Random;
use crate::common::trees::{body, configuration, mass, tree, trees};
use hamel_runtime::dynamics::parameters::{BaseParameters, PARAMETER_TOLERANCE, ParameterError};
use hamel_runtime::dynamics::{JointTorqueRegressor, Recursive};
use hamel_runtime::mechanism::Mechanism;
use hamel_runtime::spatial::{Pose, so3};
use nalgebra::{DVector, Vector3};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// `Y π` against `Y_b B π`, of the sum of absolute values of their terms: some dozen roundings in each entry of B and Y, trees up to six joints deep.
const ROUNDING: f64 = 1e-12;

/// A chain of revolute joints, each at a turn (a vector) and an offset in the body before.
fn arm(gravity: Vector3<f64>, frames: &[([f64; 3], [f64; 3])]) -> Arc<Mechanism> {
    let mut random = Random::new(7);
    let bodies = frames.iter().enumerate().map(|(index, (turn, offset))| {
        let placement = Pose::new(so3::exp(&Vector3::from(*turn)), Vector3::from(*offset));
        let parent = index.checked_sub(1);
        let name = format!("link{}", index + 1);
        body(&name, parent, revolute(), placement, mass(&mut random))
    });
    Arc::new(Mechanism::new(gravity, bodies.collect()).expect("an arm"))
}

/// The frames of the Franka Emika Panda.
fn panda(gravity: Vector3<f64>) -> Arc<Mechanism> {
    let (none, back, ahead) = ([0.0; 3], [-FRAC_PI_2, 0.0, 0.0], [FRAC_PI_2, 0.0, 0.0]);
    let frames = [
        (none, [0.0, 0.0, 0.333]),
        (back, none),
        (ahead, [0.0, -0.316, 0.0]),
        (ahead, [0.0825, 0.0, 0.0]),
        (back, [-0.0825, 0.384, 0.0]),
        (ahead, none),
        (ahead, [0.088, 0.0, 0.0]),
    ];
    arm(gravity, &frames)
}

fn found(mechanism: &Arc<Mechanism>) -> BaseParameters {
    let base = BaseParameters::new(mechanism).expect("joints that move");
    let certificate = base.certificate();
    println!(
        "{} of {}: {certificate:?}, {:?}",
        base.count(),
        base.matrix().ncols(),
        base.margin()
    );
    base
}

fn sums(base: &BaseParameters) -> Vec<String> {
    let all = 0..base.count();
    all.map(|own| base.combination(own).to_string()).collect()
}

const DOWN: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

#[test]
fn seven_joints_have_43() {
    // Gaz, Cognetti, Oliva, Robuffo Giordano, De Luca, "Dynamic identification of the Franka Emika Panda robot", IEEE RA-L 4 (2019): 43.
    let base = found(&panda(DOWN));
    assert_eq!(base.count(), 43);
    assert!(base.certificate().is_minimal());
    // One of the first link, seven of each other.
    let of_first = base.kept().iter().filter(|place| **place < 10).count();
    assert_eq!(of_first, 1);
    // Three of each joint but the first are of N_X, which joints by hand do not tell all.
    assert_eq!(base.left_out().len(), 27);
    // Gravity across the first axis: two more are felt.
    let slanted = found(&panda(Vector3::new(1.0, 0.0, -9.76)));
    assert_eq!(slanted.count(), 45);
    assert!(slanted.certificate().is_minimal());
    // Without gravity, what is on the axis of the first joint wherever the others are is not felt either.
    let weightless = found(&panda(Vector3::zeros()));
    assert_eq!(weightless.count(), 39);
    assert!(weightless.certificate().is_minimal());
}

#[test]
fn two_parallel_axes_have_the_textbook_parameters() {
    let frames = [([0.0; 3], [0.0; 3]), ([0.0; 3], [0.5, 0.0, 0.0])];
    let vertical = found(&arm(Vector3::new(0.0, -9.81, 0.0), &frames));
    assert_eq!(
        sums(&vertical),
        [
            "mc_x(link1) + 0.5 m(link2)",
            "mc_y(link1)",
            "I_zz(link1) + 0.25 m(link2)",
            "mc_x(link2)",
            "mc_y(link2)",
            "I_zz(link2)",
        ]
    );
    assert!(vertical.certificate().is_minimal());
    // In a horizontal plane the first moments of the first link are not felt.
    let horizontal = found(&arm(DOWN, &frames));
    assert_eq!(
        sums(&horizontal),
        [
            "I_zz(link1) + 0.25 m(link2)",
            "mc_x(link2)",
            "mc_y(link2)",
            "I_zz(link2)",
        ]
    );
    assert!(horizontal.certificate().is_minimal());
}

#[test]
fn efforts_are_those_of_the_base_parameters() {
    for (seed, mechanism) in trees().into_iter().enumerate() {
        let base = found(&mechanism);
        assert!(base.certificate().is_minimal(), "tree {seed}");
        let mut random = Random::new(seed as u64);
        let q = configuration(&mut random, &mechanism);
        let speeds = random.vec(mechanism.layout().speeds);
        let rates = random.vec(mechanism.layout().speeds);
        let mut regressor = JointTorqueRegressor::new(&mechanism);
        Recursive::new(Arc::clone(&mechanism))
            .joint_torque_regressor(&q, &speeds, &rates, &mut regressor)
            .expect("a state");
        let parameters = mechanism.inertial_parameters();
        let values = base.values(&parameters).expect("ten a body");
        let of_base = base.regressor(&regressor).expect("the same mechanism");
        let whole = regressor.matrix();
        let all = DVector::from_vec(parameters);
        let terms = &of_base.abs() * (base.matrix().abs() * all.abs());
        let difference = (&of_base * values - whole * all).abs();
        for (difference, terms) in difference.iter().zip(&terms) {
            assert!(
                *difference <= ROUNDING * terms.max(1.0),
                "tree {seed}: {difference:e} of {terms:e}"
            );
        }
    }
}

#[test]
fn a_wrong_tolerance_is_told() {
    let mechanism = tree(&mut Random::new(1), &[revolute()]);
    for tolerance in [-1.0, 1.0, f64::NAN] {
        let error = BaseParameters::within(&mechanism, tolerance).expect_err("no tolerance");
        assert!(matches!(error, ParameterError::Tolerance { .. }), "{error}");
    }
    let strict = BaseParameters::within(&mechanism, PARAMETER_TOLERANCE).expect("it is one");
    assert_eq!(strict.count(), 3);
}

#[test]
fn axes_that_are_nearly_parallel_count_as_the_tolerance_says() {
    // A right angle as it is often rounded: 3.7e-6 rad off.
    let turns = [[0.0; 3], [1.2, 0.0, 0.0], [-FRAC_PI_2, 0.0, 0.0]];
    let tilted = |first: f64| {
        let frames = turns.map(|turn| (turn, [0.3, 0.0, 0.1]));
        let mut frames = frames.to_vec();
        frames[0].0[0] = first;
        arm(DOWN, &frames)
    };
    let exact = found(&tilted(0.0)).count();
    assert_eq!(found(&tilted(3.7e-6)).count(), exact + 2);
    let coarse = BaseParameters::within(&tilted(3.7e-6), 1e-4).expect("joints that move");
    assert_eq!(coarse.count(), exact);
}
