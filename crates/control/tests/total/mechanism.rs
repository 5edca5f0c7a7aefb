//! Mechanisms: what they are made from, their states, and what asks for a body by its index.

use crate::common::joints;
use crate::common::trees::{GRAVITY, body};
use crate::support::{
    NOT_FINITE, NOWHERE, at, bare, elements, equipped, refused, wrong, wrong_sizes,
};
use hamel_runtime::elements::{Drive, PointConstraint};
use hamel_runtime::mechanism::{Mechanism, MechanismError, NamedFrame, dependent_columns};
use hamel_runtime::spatial::{MassProperties, Pose};
use hamel_runtime::time_function::Law;
use nalgebra::{DMatrix, Matrix3, Vector3, Vector6};

fn ball(mass: f64) -> MassProperties {
    MassProperties {
        mass,
        com: Vector3::zeros(),
        inertia_com: Matrix3::identity(),
    }
}

#[test]
fn bodies_of_any_numbers_make_a_mechanism_or_errors() {
    for number in [
        1e300,
        1e200,
        1e155,
        1e-300,
        5e-324,
        -1.0,
        f64::NAN,
        f64::INFINITY,
    ] {
        for place in 0..6 {
            let mut mass = ball(1.0);
            let mut placement = Pose::identity();
            let mut gravity = GRAVITY;
            let mut child = Pose::identity();
            match place {
                0 => mass.mass = number,
                1 => mass.com.x = number,
                2 => mass.inertia_com[(0, 1)] = number,
                3 => placement.translation.y = number,
                4 => child.translation.z = number,
                _ => gravity.z = number,
            }
            let mut arm = body("arm", None, joints::ball(), placement, mass);
            arm.child_placement = child;
            // What comes of it is no matter here; `Mechanism` says what is wrong with what it refuses.
            let tip = body("tip", Some(0), joints::ball(), placement, ball(number));
            match Mechanism::new(gravity, vec![arm, tip]) {
                Ok(mechanism) => {
                    assert!(mechanism.kinematics(&mechanism.home(), &[0.0; 6]).is_ok())
                }
                Err(errors) => assert!(!errors.is_empty() && !errors[0].to_string().is_empty()),
            }
        }
    }
}

/// 1e200 kg at 1e100 m have a moment of inertia of 1e400 kg m².
#[test]
fn what_leaves_the_range_of_numbers_is_named() {
    let mut arm = body("arm", None, joints::ball(), Pose::identity(), ball(1e200));
    arm.child_placement = Pose::from_translation(Vector3::x() * 1e100);
    let errors = Mechanism::new(GRAVITY, vec![arm]).expect_err("too heavy, too far");
    assert_eq!(
        errors[0].to_string(),
        "body `arm`: its inertia about its joint is beyond the range of numbers"
    );
    let far = |distance: f64| Pose::from_translation(Vector3::x() * distance);
    let mut arm = body("arm", None, joints::ball(), Pose::identity(), ball(0.0));
    arm.child_placement = far(0.8e308);
    let tip = body("tip", Some(0), joints::ball(), far(1.2e308), ball(1.0));
    let errors = Mechanism::new(GRAVITY, vec![arm, tip]).expect_err("too far");
    let MechanismError::Overflow { body, .. } = &errors[0] else {
        panic!("{errors:?}");
    };
    assert_eq!(body, "tip");
}

#[test]
fn bodies_that_are_not_there_are_errors() {
    let mechanism = equipped();
    let own = vec![0.0];
    for index in NOWHERE {
        refused(mechanism.body(index));
        assert!(mechanism.armature(index).is_empty());
        assert!(!mechanism.is_driven(index));
        refused(mechanism.configuration_from_pose(index, &Pose::identity()));
        refused(mechanism.configuration_from_local(index, &own));
        refused(mechanism.velocity_from_twist(index, &own, &Vector6::zeros()));
        refused(mechanism.speeds_from_velocity(index, &own, &own));
        refused((*mechanism).clone().with_armature(index, &own));
        for element in elements(index) {
            let added = (*mechanism).clone().with_elements(vec![element]);
            assert!(added.is_err());
        }
        let drive = Drive {
            name: "drive".into(),
            body: index,
            laws: vec![Law::default().into()],
        };
        assert!((*mechanism).clone().with_drives(vec![drive]).is_err());
        let constraint = PointConstraint {
            name: "edge".into(),
            body: index,
            point: Vector3::zeros(),
            direction: Vector3::x(),
        };
        let coupled = (*mechanism).clone();
        let coupled = coupled.with_constraints(vec![constraint], &at(&mechanism));
        assert!(coupled.is_err());
        let frame = NamedFrame {
            name: "tool".into(),
            body: Some(index),
            at: Pose::identity(),
        };
        assert!((*mechanism).clone().with_frames(vec![frame]).is_err());
    }
}

#[test]
fn states_of_other_sizes_or_not_finite_are_errors() {
    let mechanism = equipped();
    let layout = *mechanism.layout();
    let (q, speeds) = (at(&mechanism), vec![0.1; layout.speeds]);
    for bad in wrong(layout.configuration) {
        refused(mechanism.check_configuration(&bad));
        refused(mechanism.kinematics(&bad, &speeds));
        refused(mechanism.velocity_from_speeds(&bad, &speeds));
        refused(mechanism.project(&mut bad.clone()));
        for body in mechanism.bodies() {
            body.configuration(&bad);
        }
    }
    for bad in wrong(layout.speeds) {
        refused(mechanism.check_speeds("speeds", &bad));
        refused(mechanism.kinematics(&q, &bad));
        refused(mechanism.velocity_from_speeds(&q, &bad));
    }
    for mut bad in wrong_sizes(layout.speeds) {
        refused(mechanism.set_driven_speeds(0.0, &mut bad));
    }
    for mut bad in wrong_sizes(layout.freedoms) {
        refused(mechanism.set_driven_accelerations(0.0, &mut bad));
    }
    for (index, body) in mechanism.bodies().iter().enumerate() {
        let sizes = body.joint().layout();
        let own = body.configuration(&q);
        for bad in wrong(sizes.configuration) {
            refused(mechanism.velocity_from_twist(index, &bad, &Vector6::zeros()));
            refused(mechanism.speeds_from_velocity(index, &bad, &vec![0.0; sizes.freedoms]));
        }
        for bad in wrong(sizes.freedoms) {
            refused(mechanism.configuration_from_local(index, &bad));
            refused(mechanism.speeds_from_velocity(index, own, &bad));
        }
        for number in NOT_FINITE {
            refused(mechanism.velocity_from_twist(index, own, &Vector6::repeat(number)));
            let far = Pose::from_translation(Vector3::repeat(number));
            refused(mechanism.configuration_from_pose(index, &far));
        }
    }
}

#[test]
fn actuation_of_other_sizes_or_not_finite_is_an_error() {
    let mechanism = bare();
    for bad in wrong(1) {
        refused((*mechanism).clone().with_armature(3, &bad));
    }
    for number in NOT_FINITE {
        let laws = [(number, 0.0), (0.0, number)].map(|(rate, phase)| Law {
            rate,
            phase,
            ..Law::default()
        });
        for law in laws {
            let drive = Drive {
                name: "drive".into(),
                body: 3,
                laws: vec![law.into()],
            };
            assert!((*mechanism).clone().with_drives(vec![drive]).is_err());
        }
    }
    for direction in [f64::NAN, f64::INFINITY, 0.0, 1e200] {
        let constraint = PointConstraint {
            name: "edge".into(),
            body: 3,
            point: Vector3::zeros(),
            direction: Vector3::repeat(direction),
        };
        let coupled = (*mechanism).clone();
        assert!(
            coupled
                .with_constraints(vec![constraint], &at(&mechanism))
                .is_err()
        );
    }
    for bad in wrong(mechanism.layout().configuration) {
        let constraint = PointConstraint {
            name: "edge".into(),
            body: 4,
            point: Vector3::zeros(),
            direction: Vector3::x(),
        };
        let coupled = (*mechanism).clone();
        assert!(coupled.with_constraints(vec![constraint], &bad).is_err());
    }
}

#[test]
fn dependent_columns_are_found_or_refused_for_any_matrix() {
    for (rows, columns) in [(0, 0), (0, 3), (2, 0), (3, 2), (2, 3)] {
        for number in [0.0, 1.0, f64::NAN, f64::INFINITY, 1e308, 5e-324] {
            let matrix = DMatrix::from_element(rows, columns, number);
            let found = dependent_columns(matrix, |_| false);
            assert!(found.is_err() || rows <= 1, "{rows}×{columns} of {number}");
        }
    }
}

#[test]
fn a_mechanism_without_bodies_has_a_state() {
    let empty = Mechanism::new(GRAVITY, vec![]).expect("nothing is wrong with it");
    assert!(empty.kinematics(&[], &[]).is_ok());
    assert!(empty.home().is_empty());
}
