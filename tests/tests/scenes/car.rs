//! A car whose steering angle moves no body: the rotor of its motor carries the inertia of steering.

use hamel::dynamics::{Dynamics, DynamicsError, Recursive};
use hamel::integrate::{Form, Method, Solution};
use hamel_scene::Scene;
use hamel_tests::scenes;
use std::sync::Arc;

const BASE: f64 = 2.5;
const STEER: f64 = 0.3;
const DRIVE: f64 = 8.0;

/// Tolerance a step, and what some hundred steps of it leave of a way of 80 m. The error is that of the steps: at 1e-12 it is 1.03e-9 m.
const TOLERANCE: f64 = 1e-13;
const ERROR: f64 = 1e-9;

fn car(lines: &str) -> Scene {
    let text = format!(
        "hamel = 1\nname = \"car\"\ngravity = [0.0, 0.0, -9.81]\n[[body]]\nname = \"car\"\nparent = \"world\"\nmass = 900.0\ncom = [1.1, 0.0, 0.4]\n\
         inertia_xx_yy_zz_xy_xz_yz = [250.0, 1100.0, 1200.0, 0.0, 0.0, 0.0]\n\
         joint = {{ type = \"car_steering\", base = {BASE} }}\ninitial.phi = [0.0, 0.0, 0.0, {STEER}]\n{lines}\n"
    );
    let registry = hamel_joints::registry();
    Scene::parse(&text, "car.toml", &registry).unwrap_or_else(|errors| panic!("{errors}"))
}

fn run(scene: &Scene, form: Form) -> Solution {
    let times: Vec<f64> = (0..=10).map(f64::from).collect();
    let method = Method::dormand_prince(TOLERANCE);
    scenes::run(scene, form, method, &times).expect("the scene runs")
}

/// The rear axle goes around the point `(0, base / tan(steer))`.
fn assert_circle(scene: &Scene, form: Form) {
    let radius = BASE / STEER.tan();
    let rate = DRIVE * STEER.sin() / BASE;
    for state in &run(scene, form).samples {
        let angle = rate * state.time;
        let expected = [radius * angle.sin(), radius * (1.0 - angle.cos())];
        // Q by rows: 2×3.
        for (found, expected) in [state.configuration[2], state.configuration[5]]
            .iter()
            .zip(expected)
        {
            let error = (found - expected).abs();
            assert!(error < ERROR, "{form:?}: {error:e} m at {} s", state.time);
        }
        let error = (state.configuration[6] - STEER).abs();
        assert!(error < ERROR, "{form:?}: steering {error:e} rad");
    }
}

#[test]
fn a_car_with_its_wheels_held_drives_in_a_circle() {
    let by_rotor = car(&format!(
        "initial.speeds = [{DRIVE}, 0.0]\narmature = [0.0, 0.0, 0.0, 0.4]"
    ));
    let prescribed = car(&format!("motion.speeds = [{DRIVE}, 0.0]"));
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        assert_circle(&by_rotor, form);
        assert_circle(&prescribed, form);
    }
}

#[test]
fn a_speed_without_inertia_is_refused_by_name() {
    let scene = car(&format!("initial.speeds = [{DRIVE}, 0.0]"));
    let start = scene.start();
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let found = dynamics.forward_dynamics(
        &start.configuration,
        &start.speeds,
        &[0.0; 4],
        &mut [0.0; 2],
    );
    match found {
        Err(DynamicsError::SingularMass { joint, speed, .. }) => {
            assert_eq!((joint.as_str(), speed), ("car", "steer_rate"));
        }
        other => panic!("{other:?}"),
    }
}
