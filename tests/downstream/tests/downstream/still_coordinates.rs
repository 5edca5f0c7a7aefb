//! Joints with coordinates that move no body: wheel angles that share their speeds with it, and a steering angle that carries no inertia.

use hamel::dynamics::{Dynamics, Recursive, Reference};
use hamel::mechanism::{BodySpec, Mechanism};
use hamel::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

const MASS: f64 = 1.3;
/// About the z axis, kg·m².
const INERTIA: f64 = 0.4;

fn on_wheels(joint: &str, parameters: &[f64]) -> Arc<Mechanism> {
    let registry = hamel_downstream::held_out();
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.2, 0.3, INERTIA));
    let body = BodySpec {
        name: "chassis".into(),
        joint_name: "wheels".into(),
        parent: None,
        joint: (registry.get(joint).expect("registered").build)(parameters).expect("valid"),
        placement: Pose::identity(),
        child_placement: Pose::identity(),
        mass: MassProperties::new(MASS, Vector3::zeros(), inertia).expect("valid"),
    };
    let mechanism = Mechanism::new(Vector3::new(0.0, 0.0, -9.81), vec![body]);
    Arc::new(mechanism.unwrap_or_else(|errors| panic!("{errors:?}")))
}

fn accelerations(
    dynamics: &mut dyn Dynamics,
    mechanism: &Mechanism,
    efforts: &[f64],
) -> Result<Vec<f64>, String> {
    let mut found = vec![0.0; 2];
    dynamics
        .forward_dynamics(&mechanism.home(), &[0.0, 0.0], efforts, &mut found)
        .map(|()| found)
        .map_err(|error| error.to_string())
}

/// With wheels of radius r at distance t, torques τ on both accelerate them by 2 τ / (m r²), and opposite ones by ± τ t² / (2 J r²).
#[test]
fn torques_on_wheels_drive_and_turn() {
    let (radius, track) = (0.15, 0.6);
    let mechanism = on_wheels("differential_drive", &[radius, track]);
    let forms: [&mut dyn Dynamics; 2] = [
        &mut Recursive::new(Arc::clone(&mechanism)),
        &mut Reference::new(Arc::clone(&mechanism)),
    ];
    let torque = 0.7;
    let straight = 2.0 * torque / (MASS * radius * radius);
    let turning = torque * track * track / (2.0 * INERTIA * radius * radius);
    for dynamics in forms {
        let cases = [
            ([torque, torque], [straight, straight]),
            ([-torque, torque], [-turning, turning]),
        ];
        for (torques, expected) in cases {
            let efforts = [0.0, 0.0, 0.0, torques[0], torques[1]];
            let found = accelerations(dynamics, &mechanism, &efforts).expect("regular");
            for (found, expected) in found.iter().zip(expected) {
                // Some ten operations on numbers of order 50.
                assert!((found - expected).abs() < 1e-12, "{found} and {expected}");
            }
        }
    }
}

/// A rotor behind the steering: its own effort alone turns it, and while it turns both forms agree on what the car does.
#[test]
fn an_armature_carries_a_steering_angle() {
    let rotor = 0.4;
    let mechanism = (*on_wheels("car_steering", &[2.5])).clone();
    let mechanism = mechanism.with_armature(0, &[0.0, 0.0, 0.0, rotor]);
    let mechanism = Arc::new(mechanism.expect("the rate of steering is a speed"));
    let forms: [&mut dyn Dynamics; 2] = [
        &mut Recursive::new(Arc::clone(&mechanism)),
        &mut Reference::new(Arc::clone(&mechanism)),
    ];
    let mut q = mechanism.home();
    let joint = mechanism.bodies()[0].joint();
    let from = q.clone();
    joint.retract(&from, &[0.3, 0.1, 0.2, 0.4], &mut q);
    let found = forms.map(|dynamics| {
        let mut found = [0.0; 2];
        dynamics
            .forward_dynamics(&q, &[3.0, 0.7], &[0.0, 0.0, 0.0, 1.2], &mut found)
            .expect("regular");
        found
    });
    for rates in found {
        assert!((rates[1] - 1.2 / rotor).abs() < 1e-14, "{rates:?}");
    }
    // A dozen operations on numbers of order 1.
    assert!((found[0][0] - found[1][0]).abs() < 1e-14, "{found:?}");
    assert!(
        found[0][0].abs() > 1e-3,
        "it yaws faster as the wheels turn: {found:?}"
    );
}

/// A steering angle of no inertia has no acceleration; the error says which speed that is, and what helps.
#[test]
fn a_speed_without_inertia_is_named() {
    let mechanism = on_wheels("car_steering", &[2.5]);
    let forms: [&mut dyn Dynamics; 2] = [
        &mut Recursive::new(Arc::clone(&mechanism)),
        &mut Reference::new(Arc::clone(&mechanism)),
    ];
    for dynamics in forms {
        let error = accelerations(dynamics, &mechanism, &[0.0; 4]).expect_err("singular");
        for part in ["wheels", "steer_rate", "inertia"] {
            assert!(error.contains(part), "{error}");
        }
    }
}
