//! Motions that are known: closed forms, conserved quantities, computed reference values.

use crate::common::joints;
use crate::common::random::Random;
use crate::common::trees::{GRAVITY, body, mass};
use crate::support::{distance, mixed, options, run, start};
use hamel_integrate::{Event, Form, Integration, Method, Sampling, Scheme, State};
use hamel_runtime::dynamics::Reference;
use hamel_runtime::mechanism::{BodySpec, Mechanism};
use hamel_runtime::spatial::{MassProperties, Pose, so3};
use nalgebra::{Matrix3, Vector3};
use std::ops::ControlFlow;
use std::sync::Arc;

#[test]
fn both_forms_give_the_same_motion_and_keep_the_energy() {
    let mechanism = mixed();
    let initial = start(&mechanism, 6);
    let energy = |state: &State| {
        mechanism
            .kinematics(&state.configuration, &state.speeds)
            .expect("sizes fit")
            .energy()
    };
    let method = Method::dormand_prince(1e-11);
    let lagrangian = run(
        &mechanism,
        &initial,
        &options(Form::Lagrangian, method, 0.5),
    )
    .state;
    let hamiltonian = run(
        &mechanism,
        &initial,
        &options(Form::Hamiltonian, method, 0.5),
    )
    .state;
    // Some fifty steps of 1e-11, amplified by the motion over half a second.
    assert!(distance(&lagrangian, &hamiltonian) < 1e-7);
    for state in [&lagrangian, &hamiltonian] {
        let drift = (energy(state) - energy(&initial)).abs();
        assert!(drift < 1e-8 * energy(&initial).abs(), "drift {drift:e}");
    }
}

/// An axisymmetric free rotor: ω precesses about the axis, the axis about the angular momentum.
#[test]
fn free_rotor_precesses() {
    let (axial, transverse) = (0.4, 1.0);
    let inertia = Matrix3::from_diagonal(&Vector3::new(transverse, transverse, axial));
    let mass = MassProperties::new(1.0, Vector3::zeros(), inertia).expect("physical");
    let rotor = body("rotor", None, joints::ball(), Pose::identity(), mass);
    let mechanism = Arc::new(Mechanism::new(Vector3::zeros(), vec![rotor]).expect("valid"));
    let omega = Vector3::new(0.7, 0.0, 2.0);
    let initial = State {
        time: 0.0,
        configuration: mechanism.home(),
        speeds: omega.as_slice().to_vec(),
    };
    let momentum = inertia * omega;
    let time = 5.0;
    // R(t) = exp(t L/I₁) exp(t (1 − I₃/I₁) ω₃ e₃) from R(0) = I
    let spin = Vector3::new(0.0, 0.0, (1.0 - axial / transverse) * omega.z);
    let expected = so3::exp(&(momentum / transverse * time)) * so3::exp(&(spin * time));
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let end = run(
            &mechanism,
            &initial,
            &options(form, Method::dormand_prince(1e-12), time),
        )
        .state;
        let found = Matrix3::from_row_slice(&end.configuration);
        // Five hundred steps of 1e-12.
        assert!(
            (found - expected).amax() < 1e-9,
            "{:e}",
            (found - expected).amax()
        );
        assert_eq!(mechanism.check_configuration(&end.configuration), Ok(()));
    }
}

/// A cart with its centre of mass on the axle's middle rolls on a circle, at any of sixty speeds.
#[test]
fn balanced_cart_rolls_on_a_circle() {
    let mass = MassProperties::new(3.0, Vector3::zeros(), Matrix3::identity()).expect("physical");
    let cart = body("cart", None, joints::cart(), Pose::identity(), mass);
    let mechanism =
        Arc::new(Mechanism::new(GRAVITY.component_mul(&Vector3::z()), vec![cart]).expect("valid"));
    let options = options(Form::Hamiltonian, Method::rk4(0.1), 4.0);
    for turn in (0..60).map(|i| 0.5 + 0.013 * f64::from(i)) {
        let initial = State {
            time: 0.0,
            configuration: mechanism.home(),
            speeds: vec![turn, 3.0 * turn],
        };
        let end = run(&mechanism, &initial, &options).state;
        let (sin, cos) = (4.0 * turn).sin_cos();
        let expected = [cos, -sin, 3.0 * sin, sin, cos, 3.0 * (1.0 - cos)];
        // Φ is the motion itself, so that the method makes no error at all; what rounding makes was measured: 2e-14 in the median, 3e-13 at most.
        for (found, expected) in end.configuration.iter().zip(expected) {
            let error = (found - expected).abs();
            assert!(error < 1e-12, "{turn}: {error:e}");
        }
    }
}

fn inertia(rows: [[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

/// The mechanism of the paper's Fig. 5, in SI units.
fn plate_cart_arm() -> Vec<BodySpec> {
    let properties = |mass, com: [f64; 3], rows| {
        MassProperties::new(mass, com.into(), inertia(rows)).expect("physical")
    };
    let plate = properties(
        12.0,
        [0.1, -0.05, -0.03],
        [[0.9, 0.02, 0.0], [0.02, 1.1, -0.01], [0.0, -0.01, 1.9]],
    );
    let cart = properties(
        4.0,
        [0.06, 0.02, 0.12],
        [[0.05, 0.002, 0.001], [0.002, 0.09, 0.0], [0.001, 0.0, 0.11]],
    );
    let arm = properties(
        1.7,
        [0.05, -0.08, 0.3],
        [
            [0.03, 0.001, -0.002],
            [0.001, 0.025, 0.0015],
            [-0.002, 0.0015, 0.012],
        ],
    );
    let at = |x: [f64; 3]| Pose::from_translation(x.into());
    vec![
        body("plate", None, joints::revolute(), at([0.0; 3]), plate),
        body("cart", Some(0), joints::cart(), at([0.0, 0.0, 0.08]), cart),
        body("arm", Some(1), joints::ball(), at([0.15, -0.02, 0.22]), arm),
    ]
}

/// State of the arm at 4 s, computed reference values: two formulations in 128-bit arithmetic that agree to 2e-24.
#[test]
fn plate_cart_arm_reaches_the_reference() {
    let gravity = Vector3::new(0.0, 0.0, -9.81);
    let mechanism = Arc::new(Mechanism::new(gravity, plate_cart_arm()).expect("valid"));
    let attitude = so3::exp(&Vector3::new(0.2, -0.4, 0.1));
    let spin = attitude * Vector3::new(1.5, -0.5, 2.0);
    let cart = Pose::new(
        so3::exp(&Vector3::new(0.0, 0.0, 0.7)),
        Vector3::new(0.5, -0.4, 0.0),
    );
    let mut q = vec![0.3];
    q.extend(
        mechanism
            .configuration_from_pose(1, &cart)
            .expect("in the plane"),
    );
    q.extend(
        mechanism
            .configuration_from_pose(2, &Pose::from_rotation(attitude))
            .expect("a rotation"),
    );
    let initial = State {
        time: 0.0,
        configuration: q,
        speeds: vec![0.8, -1.1, 0.6, spin.x, spin.y, spin.z],
    };
    let position = Vector3::new(0.09917093718836448, 2.010767422118979, 0.5939227639145388);
    let velocity = Vector3::new(-1.6807846689502415, 0.6854190559940981, -0.4018369205129292);
    let angular = Vector3::new(
        -2.6664708032047493,
        -2.6696510346820697,
        -12.191613356158367,
    );
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let solution = run(
            &mechanism,
            &initial,
            &options(form, Method::dormand_prince(1e-12), 4.0),
        );
        let end = solution.state;
        let kinematics = mechanism
            .kinematics(&end.configuration, &end.speeds)
            .expect("sizes fit");
        let arm = kinematics.bodies[2];
        let error = (arm.position_com - position).norm()
            + (arm.velocity_com - velocity).norm()
            + (arm.angular_velocity_body() - angular).norm() / angular.norm();
        assert!(error < 1e-9, "{form:?}: {error:e}");
        assert!((kinematics.energy() - 18.293367863979856).abs() < 1e-9);
    }
}

/// A tumbling body for twenty thousand steps: the rotation matrix stays one, time stays exact.
#[test]
fn long_runs_stay_on_the_manifold() {
    let free = body(
        "free",
        None,
        joints::ball(),
        Pose::identity(),
        mass(&mut Random::new(1)),
    );
    let mechanism = Arc::new(Mechanism::new(Vector3::zeros(), vec![free]).expect("valid"));
    let initial = start(&mechanism, 2);
    let end = run(
        &mechanism,
        &initial,
        &options(Form::Lagrangian, Method::rk4(1e-3), 20.0),
    );
    assert_eq!(end.statistics.steps, 20_000);
    let rotation = Matrix3::from_row_slice(&end.state.configuration);
    assert!((rotation.transpose() * rotation - Matrix3::identity()).amax() < 4.0 * f64::EPSILON);
}

/// A disc on a plane that spins at 4 rad/s.
fn spinning(rate: f64) -> (Arc<Mechanism>, State) {
    let mass = MassProperties::new(1.0, Vector3::zeros(), Matrix3::identity()).expect("physical");
    let disc = body("disc", None, joints::planar(), Pose::identity(), mass);
    let mechanism = Arc::new(Mechanism::new(Vector3::zeros(), vec![disc]).expect("valid"));
    let initial = State {
        time: 0.0,
        configuration: mechanism.home(),
        speeds: vec![rate, 0.0, 0.0],
    };
    (mechanism, initial)
}

/// At the ends of steps, at samples within them, and where an event ends the motion, over base points that move after every half a radian.
#[test]
fn the_travel_of_a_joint_counts_its_turns() {
    let (mechanism, initial) = spinning(4.0);
    let mut options = options(Form::Lagrangian, Method::dormand_prince(1e-8), 10.0);
    options.samples = vec![0.1, 3.3, 7.2];
    let assert_turned = |time: f64, travel: &[f64]| {
        // Thirty rad, rounded at each of some hundred base points.
        let error = travel[0] - 4.0 * time;
        assert!(error.abs() < 1e-12, "at {time} s: {error:e}");
    };
    let mut dynamics = Reference::new(Arc::clone(&mechanism));
    let mut seen = 0;
    let solution = Integration::new(&mut dynamics, &initial, &options)
        .sampling(Sampling::Dense)
        .event(Event::new("there", |time, _, _| time - 7.31).stopping())
        .observer(|step| {
            assert_turned(step.time, step.travel);
            seen += usize::from(step.is_within);
            ControlFlow::Continue(())
        })
        .run()
        .expect("integrates");
    assert_eq!((seen, solution.stopped), (3, true));
    assert_turned(solution.state.time, &solution.travel);
}

/// Φ and its inverse tell rotations within half a turn alone.
#[test]
fn no_composed_step_turns_by_more_than_half_a_turn() {
    let (mechanism, initial) = spinning(30.0);
    let moved = |step: f64| {
        let mut dynamics = Reference::new(Arc::clone(&mechanism));
        let method = Method::fixed(Scheme::CommutatorFree4, step);
        let options = options(Form::Lagrangian, method, 1.2);
        Integration::new(&mut dynamics, &initial, &options).run()
    };
    let error = moved(0.12).expect_err("3.6 rad in a step").to_string();
    assert!(error.contains("joint `disc joint` turns by 3.6"), "{error}");
    let travel = moved(0.08).expect("integrates").travel;
    assert!((travel[0] - 36.0).abs() < 1e-12, "{travel:?}");
}
