//! The mechanism of Example 7 against reference values, in both forms, with the settings of its scene.

use hamel::integrate::{Form, Method};
use hamel::mechanism::BodyState;
use hamel::nalgebra::{Matrix3, Vector3};
use hamel_tests::figures::{Largest, attitude_error, vector_error};
use hamel_tests::scenes;
use serde_json::Value;

const REFERENCE: &str = include_str!("../../data/plate_cart_arm.json");

/// What is asked for in every quantity. The scene's tolerance is 1e-12 a step; its 4 s take some 500 steps, and errors grow
/// 35-fold on the way (the `conditioning` of the reference).
const ALLOWED: f64 = 1e-9;

fn numbers(value: &Value) -> Vec<f64> {
    let entries = value.as_array().expect("a list");
    entries
        .iter()
        .map(|entry| entry.as_f64().expect("a number"))
        .collect()
}

fn vector(body: &Value, key: &str) -> Vector3<f64> {
    Vector3::from_column_slice(&numbers(&body[key]))
}

/// Errors of a body in attitude, position, velocity and angular velocity.
fn errors(found: &BodyState, expected: &Value) -> [f64; 4] {
    let rotation = Matrix3::from_row_slice(&numbers(&expected["rotation_body_to_world_rowmajor"]));
    [
        attitude_error(&rotation, &found.pose.rotation),
        vector_error(&found.position_com, &vector(expected, "position_com")),
        vector_error(&found.velocity_com, &vector(expected, "velocity_com_world")),
        vector_error(
            &found.angular_velocity_body(),
            &vector(expected, "angular_velocity_body"),
        ),
    ]
}

fn check(form: Form, method: Method, allowed: f64) {
    let reference: Value = serde_json::from_str(REFERENCE).expect("the file is JSON");
    let samples = reference["samples"].as_array().expect("a list");
    let times: Vec<f64> = samples
        .iter()
        .map(|sample| sample["t"].as_f64().expect("a time"))
        .collect();
    assert_eq!(times, [0.0, 1.0, 4.0]);
    let scene = scenes::load("plate_cart_arm");
    let names = scene.mechanism.bodies().iter().map(|body| body.name());
    assert!(
        names.eq(reference["bodies"]
            .as_array()
            .expect("a list")
            .iter()
            .filter_map(Value::as_str))
    );

    let solution = scenes::run(&scene, form, method, &times).expect("the scene runs");
    let energy = reference["total_energy"].as_f64().expect("a number");
    let start = scenes::kinematics(&scene, &solution.samples[0]).expect("sizes fit");
    let unit = energy.abs().max(start.kinetic_energy());
    println!("{form:?}: {:?}", solution.statistics);
    let laws = ["attitude", "position", "velocity", "angular velocity"];
    let mut largest = laws.map(Largest::new);
    let mut energies = Largest::new("energy");
    for (state, expected) in solution.samples.iter().zip(samples) {
        let kinematics = scenes::kinematics(&scene, state).expect("sizes fit");
        energies.meet((kinematics.energy() - energy).abs() / unit, state.time);
        let expected = expected["bodies"].as_array().expect("a list");
        assert_eq!(kinematics.bodies.len(), expected.len());
        for ((body, expected), spec) in kinematics
            .bodies
            .iter()
            .zip(expected)
            .zip(scene.mechanism.bodies())
        {
            let place = format!("{} at {} s", spec.name(), state.time);
            for (largest, error) in largest.iter_mut().zip(errors(body, expected)) {
                largest.meet(error, &place);
            }
        }
    }
    largest
        .iter()
        .for_each(|largest| largest.assert_within(allowed));
    energies.assert_within(allowed);
}

#[test]
fn lagrangian_form_reaches_the_reference() {
    check(
        Form::Lagrangian,
        scenes::load("plate_cart_arm").settings.method,
        ALLOWED,
    );
}

#[test]
fn hamiltonian_form_reaches_the_reference() {
    check(
        Form::Hamiltonian,
        scenes::load("plate_cart_arm").settings.method,
        ALLOWED,
    );
}

/// Another method, with a fixed step: (ω dt)⁴ / 120 a unit of angle, with ω up to 13 rad/s, is 1e-12; it turns by 40 rad and
/// errors grow 35-fold.
#[test]
fn fixed_steps_reach_the_reference() {
    check(Form::Lagrangian, Method::rk4(0.25e-3), ALLOWED);
}
