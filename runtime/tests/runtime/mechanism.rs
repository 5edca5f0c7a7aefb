//! Mechanisms: what they refuse, where their bodies are, and how a joint's state is found from poses and twists.

use crate::common::joints;
use crate::common::random::Random;
use crate::common::trees::{GRAVITY, body, configuration, mass, pose, tree, trees};
use hamel_runtime::mechanism::{Mechanism, MechanismError, StateError};
use hamel_runtime::spatial::{MassProperties, Pose, so3};
use nalgebra::{Vector3, Vector6};

fn single(joint: std::sync::Arc<dyn hamel_runtime::erased::AnyJoint>) -> Mechanism {
    let body = body(
        "body",
        None,
        joint,
        Pose::identity(),
        mass(&mut Random::new(0)),
    );
    Mechanism::new(GRAVITY, vec![body]).expect("valid")
}

#[test]
fn all_errors_come_at_once() {
    let good = mass(&mut Random::new(0));
    let heavy = MassProperties { mass: -1.0, ..good };
    let mut bent = Pose::identity();
    bent.rotation[(0, 0)] = 2.0;
    let bodies = vec![
        body("a", Some(0), joints::revolute(), Pose::identity(), heavy),
        body("b", Some(7), joints::ball(), bent, good),
        body("a", Some(0), joints::ball(), Pose::identity(), good),
    ];
    let errors =
        Mechanism::new(Vector3::new(0.0, f64::NAN, 0.0), bodies).expect_err("wrong in six ways");
    let messages: Vec<_> = errors.iter().map(ToString::to_string).collect();
    assert_eq!(
        messages,
        [
            "gravity component y is NaN, not a finite number",
            "body 2 has the name `a`, which body 0 has already",
            "body `a` (index 0) has parent index 0: a parent comes before its children",
            "body `a`: mass is -1 kg: it must be at least 0",
            "body `b` (index 1) has parent index 7: a parent comes before its children",
            "body `b`, placement: rotation matrix is not orthonormal: RᵀR differs from the identity by 3e0, more than 1e-9",
        ]
    );
    assert!(matches!(
        errors[5],
        MechanismError::Placement {
            which: "placement",
            ..
        }
    ));
}

#[test]
fn shares_lie_one_after_the_other() {
    let mechanism = tree(
        &mut Random::new(3),
        &[joints::cart(), joints::ball(), joints::revolute()],
    );
    let layout = mechanism.layout();
    assert_eq!(
        (
            layout.configuration,
            layout.freedoms,
            layout.speeds,
            layout.constraints
        ),
        (16, 7, 6, 1)
    );
    let ranges = mechanism.bodies()[1].ranges();
    assert_eq!(
        (ranges.configuration.clone(), ranges.freedoms.clone()),
        (6..15, 3..6)
    );
    assert_eq!(
        (ranges.speeds.clone(), ranges.constraints.clone()),
        (2..5, 1..1)
    );
    assert_eq!(mechanism.body_index("body 2"), Some(2));
    assert_eq!(mechanism.body_index("body 3"), None);
    assert_eq!(mechanism.check_configuration(&mechanism.home()), Ok(()));
}

/// Twists of bodies against differences of their poses along the motion, energy's rate against momentum.
#[test]
fn kinematics_are_consistent() {
    let step = 1e-5;
    for (seed, mechanism) in trees().into_iter().enumerate() {
        let mut random = Random::new(seed as u64);
        let q = configuration(&mut random, &mechanism);
        let speeds = random.vec(mechanism.layout().speeds);
        let velocity = mechanism
            .velocity_from_speeds(&q, &speeds)
            .expect("sizes fit");
        let at = |time: f64| {
            let mut moved = q.clone();
            for (_, body) in mechanism.joints() {
                let ranges = body.ranges();
                let own = body.configuration(&q);
                let mut rate = vec![0.0; own.len()];
                body.joint()
                    .configuration_rate(own, &velocity[ranges.freedoms.clone()], &mut rate);
                for (entry, rate) in moved[ranges.configuration.clone()].iter_mut().zip(rate) {
                    *entry += time * rate;
                }
            }
            mechanism.kinematics(&moved, &speeds).expect("sizes fit")
        };
        let (now, ahead, behind) = (at(0.0), at(step), at(-step));
        for (i, state) in now.bodies.iter().enumerate() {
            let slope =
                (ahead.bodies[i].position_com - behind.bodies[i].position_com) / (2.0 * step);
            // Central differences: h²/6 of third derivatives (up to 1e3), ε/h: 1e-7 covers both.
            assert!((slope - state.velocity_com).amax() < 1e-7);
            let slope =
                (ahead.bodies[i].pose.rotation - behind.bodies[i].pose.rotation) / (2.0 * step);
            let spin =
                state.pose.rotation * hamel_runtime::spatial::hat(&state.angular_velocity_body());
            assert!((slope - spin).amax() < 1e-7);
            let world = state.pose.rotation * state.angular_velocity_body();
            assert_eq!(state.angular_velocity_world(), world);
        }
        let momentum = now.momentum();
        let rate = (ahead.center_of_mass - behind.center_of_mass) / (2.0 * step);
        assert!((momentum.fixed_rows::<3>(3) - rate * now.mass).amax() < 1e-6);
        let about_com = now.momentum_com();
        let shift = now
            .center_of_mass
            .cross(&momentum.fixed_rows::<3>(3).into_owned());
        assert!(
            (momentum.fixed_rows::<3>(0) - shift - about_com.fixed_rows::<3>(0)).amax() < 1e-12
        );
        let height = -now.mass * GRAVITY.dot(&now.center_of_mass);
        assert!((now.potential_energy() - height).abs() < 1e-12 * height.abs().max(1.0));
    }
}

#[test]
fn configurations_are_checked_and_projected() {
    let mechanism = single(joints::ball());
    let mut q = mechanism.home();
    q[1] = 1e-6;
    let error = mechanism
        .check_configuration(&q)
        .expect_err("off the manifold");
    assert!(
        matches!(error, StateError::OffManifold { limit: 1e-9, .. }),
        "{error}"
    );
    mechanism.project(&mut q).expect("size fits");
    assert_eq!(mechanism.check_configuration(&q), Ok(()));
    q[4] = f64::NAN;
    let error = mechanism.check_configuration(&q).expect_err("not finite");
    assert_eq!(
        error.to_string(),
        "joint `body joint`: configuration entry `q22` is NaN, not a finite number"
    );
    let error = mechanism
        .check_configuration(&q[..8])
        .expect_err("one short");
    assert_eq!(
        error.to_string(),
        "configuration of the mechanism has 8 entries: it must have 9"
    );
    let error = mechanism
        .check_speeds("speeds", &[0.0, f64::INFINITY, 0.0])
        .expect_err("infinite");
    assert_eq!(
        error.to_string(),
        "joint `body joint`: speeds entry `e2` is inf, not a finite number"
    );
}

#[test]
fn poses_within_reach_are_found_to_rounding() {
    let all = [
        joints::revolute(),
        joints::ball(),
        joints::planar(),
        joints::planar_euclidean(),
        joints::cart(),
        joints::drift(),
    ];
    for joint in all {
        let mechanism = single(joint);
        for seed in 0..30 {
            let mut random = Random::new(seed);
            let phi: Vec<_> = random
                .vec(mechanism.layout().freedoms)
                .iter()
                .map(|x| 3.0 * x)
                .collect();
            let q = mechanism.configuration_from_local(0, &phi).expect("finite");
            let target = mechanism.bodies()[0].joint().pose(&q);
            let found = mechanism
                .configuration_from_pose(0, &target)
                .expect("within reach");
            assert_eq!(mechanism.check_configuration(&found), Ok(()));
            let error = mechanism.bodies()[0].joint().pose(&found).matrix() - target.matrix();
            assert!(
                error.amax() < 1e-14,
                "quadratic convergence ends at rounding of entries of order 3"
            );
        }
    }
}

#[test]
fn poses_out_of_reach_tell_what_remains() {
    let mechanism = single(joints::planar());
    let target = Pose::from_translation(Vector3::new(1.0, 2.0, 0.25));
    let error = mechanism
        .configuration_from_pose(0, &target)
        .expect_err("a plane has no height");
    let StateError::OutOfReach {
        angle, distance, ..
    } = &error
    else {
        panic!("another error: {error}");
    };
    assert!(*angle < 1e-9 && (distance - 0.25).abs() < 1e-9, "{error}");
    let mut mirror = Pose::identity();
    mirror.rotation[(2, 2)] = -1.0;
    let error = mechanism
        .configuration_from_pose(0, &mirror)
        .expect_err("a reflection");
    assert!(matches!(error, StateError::Pose { .. }));
    assert!(matches!(
        mechanism.configuration_from_pose(1, &target),
        Err(StateError::UnknownBody { index: 1, count: 1 })
    ));
}

#[test]
fn twists_become_velocities() {
    let mechanism = single(joints::ball());
    let mut random = Random::new(9);
    let rotation = so3::exp(&random.rotation_vector());
    let q = mechanism
        .configuration_from_pose(0, &Pose::from_rotation(rotation))
        .expect("a rotation");
    let angular = random.vector::<3>();
    let twist = hamel_runtime::spatial::join(&angular, &Vector3::zeros());
    let velocity = mechanism
        .velocity_from_twist(0, &q, &twist)
        .expect("a rotation");
    // The ball reads its velocity in parent axes.
    assert!(
        (Vector3::from_column_slice(&velocity) - rotation * angular).amax() < 1e-14,
        "a few roundings"
    );
    let error = mechanism
        .velocity_from_twist(0, &q, &Vector6::new(1.0, 0.0, 0.0, 0.0, 0.5, 0.0))
        .expect_err("a ball joint does not slide");
    let StateError::TwistOutsideFreedoms { residual, .. } = &error else {
        panic!("another error: {error}");
    };
    assert!((residual - 0.5).abs() < 1e-14);
}

#[test]
fn velocities_become_speeds_where_the_constraint_allows() {
    let mechanism = single(joints::drift());
    let q = [0.3, 1.5, -2.0];
    // ẏ = x θ̇
    let speeds = mechanism
        .speeds_from_velocity(0, &q, &[0.8, -0.4, 1.2])
        .expect("allowed");
    assert!((speeds[0] - 0.8).abs() + (speeds[1] + 0.4).abs() < 1e-15);
    let back = mechanism
        .velocity_from_speeds(&q, &speeds)
        .expect("sizes fit");
    assert!((back[2] - 1.2).abs() < 1e-15);
    let error = mechanism
        .speeds_from_velocity(0, &q, &[0.8, -0.4, 1.3])
        .expect_err("forbidden");
    let StateError::ConstraintViolated { joint, value, .. } = &error else {
        panic!("another error: {error}");
    };
    assert_eq!(joint, "body joint");
    assert!((value - 0.1).abs() < 1e-15);
    let error = mechanism
        .speeds_from_velocity(0, &q, &[0.8])
        .expect_err("too short");
    assert_eq!(
        error.to_string(),
        "velocity of body joint has 1 entries: it must have 3"
    );
}

#[test]
fn body_frames_need_not_be_joint_frames() {
    let mut random = Random::new(12);
    let (placement, child) = (pose(&mut random), pose(&mut random));
    let mut spec = body(
        "arm",
        None,
        joints::revolute(),
        placement,
        mass(&mut random),
    );
    spec.child_placement = child;
    let mechanism = Mechanism::new(GRAVITY, vec![spec]).expect("valid");
    let state = mechanism
        .kinematics(&[0.7], &[1.1])
        .expect("sizes fit")
        .bodies[0];
    let turned = Pose::from_rotation(so3::exp(&Vector3::new(0.0, 0.0, 0.7)));
    let expected = placement * turned * child;
    assert!((state.pose.matrix() - expected.matrix()).amax() < 1e-15);
    let axis = placement.rotation * Vector3::z() * 1.1;
    assert!(
        (state.angular_velocity_world() - axis).amax() < 1e-15,
        "a few roundings"
    );
}
