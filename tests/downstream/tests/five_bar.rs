//! A five-bar on a tilted plane against a reference of 24 digits: accelerations at the start by the library's joint, whose cranks are independent, and by one that is read by its left rod and right crank;
//! motions by the second up to 0.6 s. Along this motion the rods come in line at 0.15 s, where the first ends, and the left crank with the right rod at 0.615 s.

mod common;

use hamel::dynamics::{Dynamics, MassMatrix, Recursive, Reference};
use hamel::integrate::{
    Form, Method, Options, Scheme, StepControl, integrate, no_inputs, no_observer,
};
use hamel_scene::Scene;
use hamel_tests::figures::{Largest, attitude_error, vector_error};
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::sync::Arc;

const CRANKS: &str = "five_bar";
const ROD_AND_CRANK: &str = "five_bar_rods";

fn reference() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/five_bar.json");
    let text = fs::read_to_string(path).expect("the reference");
    serde_json::from_str(&text).expect("the file is JSON")
}

fn numbers(value: &Value) -> impl Iterator<Item = f64> {
    let list = value.as_array().expect("a list");
    list.iter().map(|entry| entry.as_f64().expect("a number"))
}

/// Angles of left crank and rod and right crank and rod against the ground, from those of the reference, where rods are told against their cranks.
fn against_ground(told: &Value) -> [f64; 4] {
    let at = |name: &str| told[name].as_f64().expect("a number");
    let (left, right) = (at("left_pivot"), at("right_pivot"));
    [
        left,
        left + at("left_elbow"),
        right,
        right + at("right_elbow"),
    ]
}

/// The links whose angles are independent, of the four.
fn independent(joint: &str) -> [usize; 2] {
    match joint {
        CRANKS => [0, 2],
        _ => [1, 2],
    }
}

/// The mechanism by one of the joints, at the start: the cranks turn at 1.5 and −2 rad/s.
fn scene(joint: &str, reference: &Value) -> Scene {
    let angles = against_ground(&reference["angles"]);
    let configuration: Vec<f64> = angles
        .iter()
        .flat_map(|angle| [angle.cos(), angle.sin()])
        .collect();
    let rates = against_ground(&reference["rates"]);
    let speeds = independent(joint).map(|link| rates[link]);
    let text = format!(
        "hamel = 1
gravity = [0.7, -0.9, -9.7]
[[body]]
name = \"linkage\"
parent = \"world\"
joint = {{ type = \"{joint}\", ground = 0.3, left_crank = 0.2, left_rod = 0.3, right_crank = 0.22, right_rod = 0.28 }}
at = {{ rpy = [0.5, -0.3, 0.25] }}
initial = {{ configuration = {configuration:?}, speeds = {speeds:?} }}
bodies.left_crank = {{ mass = 0.9, com = [0.09, 0.014, 0.005], inertia = [[0.002, 0.0004, -0.0002], [0.0004, 0.005, 0.0001], [-0.0002, 0.0001, 0.006]] }}
bodies.left_rod = {{ mass = 0.7, com = [0.14, -0.02, 0.004], inertia = [[0.001, 0.0005, 0.0001], [0.0005, 0.007, 0.0002], [0.0001, 0.0002, 0.0076]] }}
bodies.right_crank = {{ mass = 1.0, com = [0.12, -0.02, -0.006], inertia = [[0.002, -0.0005, 0.0002], [-0.0005, 0.006, 0.0003], [0.0002, 0.0003, 0.007]] }}
bodies.right_rod = {{ mass = 0.8, com = [0.15, 0.03, 0.007], inertia = [[0.0015, 0.0004, -0.0003], [0.0004, 0.007, 0.0002], [-0.0003, 0.0002, 0.0078]] }}
"
    );
    let scene = Scene::parse(&text, "five_bar.toml", &common::registry());
    scene.unwrap_or_else(|errors| panic!("{errors}"))
}

/// Ten roundings of the largest acceleration, times the condition of the mass matrix.
#[test]
fn accelerations_at_the_start_are_those_of_multipliers() {
    let reference = reference();
    let accelerations = against_ground(&reference["accelerations"]);
    let largest = accelerations
        .iter()
        .fold(0.0_f64, |most, own| own.abs().max(most));
    for joint in [CRANKS, ROD_AND_CRANK] {
        let scene = scene(joint, &reference);
        let mechanism = || Arc::clone(&scene.mechanism);
        let mut mass = MassMatrix::new(&scene.mechanism);
        let mut tree = Recursive::new(mechanism());
        let found = tree.mass_matrix(&scene.configuration, &mut mass);
        found.expect("regular");
        let values = mass.matrix().singular_values();
        let bound = 10.0 * f64::EPSILON * values.max() / values.min();
        let forms: [Box<dyn Dynamics>; 2] = [Box::new(tree), Box::new(Reference::new(mechanism()))];
        for mut form in forms {
            let mut rates = [0.0; 2];
            let found =
                form.forward_dynamics(&scene.configuration, &scene.speeds, &[0.0; 2], &mut rates);
            found.expect("regular");
            let errors = independent(joint).into_iter().zip(rates);
            let errors = errors.map(|(link, rate)| (rate - accelerations[link]).abs() / largest);
            let error = errors.fold(0.0, f64::max);
            println!("{joint}: accelerations within {error:e}, of {bound:e}");
            assert!(error <= bound, "{joint}: {error:e}, not {bound:e}");
        }
    }
}

/// Floors of a sample: its conditioning is what one relative change of an input makes of it, and half a rounding is what doubles do to one.
#[test]
fn motions_are_those_of_multipliers() {
    let reference = reference();
    let scene = scene(ROD_AND_CRANK, &reference);
    let samples = reference["samples"].as_array().expect("samples");
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let control = StepControl {
            tolerance: 2e-15,
            max_step: f64::INFINITY,
            first_step: None,
        };
        let options = Options {
            method: Method::Controlled {
                scheme: Scheme::Verner9,
                control,
            },
            t_end: 0.6,
            samples: samples
                .iter()
                .map(|sample| sample["t"].as_f64().expect("a time"))
                .collect(),
            form,
        };
        let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
        let found = integrate(
            &mut dynamics,
            &scene.start(),
            &options,
            &mut no_inputs,
            &mut no_observer,
        );
        let found = found.unwrap_or_else(|error| panic!("{error}"));
        let mut worst = Largest::new("floors of the five-bar");
        for (state, sample) in found.samples.iter().zip(samples) {
            let conditioning = sample["conditioning"].as_f64().expect("a number");
            let kinematics = scene
                .mechanism
                .kinematics(&state.configuration, &state.speeds);
            let kinematics = kinematics.expect("sizes fit");
            let expected = sample["bodies"].as_array().expect("bodies");
            for (body, expected) in kinematics.bodies.iter().zip(expected) {
                let vector = |key: &str| Vector3::from_iterator(numbers(&expected[key]));
                let rotation = numbers(&expected["rotation_body_to_world_rowmajor"]);
                let rotation = Matrix3::from_row_iterator(rotation);
                let errors = [
                    attitude_error(&rotation, &body.pose.rotation),
                    vector_error(&body.position_com, &vector("position_com")),
                    vector_error(&body.velocity_com, &vector("velocity_com_world")),
                    vector_error(
                        &body.angular_velocity_body(),
                        &vector("angular_velocity_body"),
                    ),
                ];
                for error in errors {
                    let floor = 0.5 * f64::EPSILON * conditioning;
                    worst.meet(error / floor, format!("{} s, {form:?}", state.time));
                }
            }
        }
        worst.assert_within(10.0);
    }
}
