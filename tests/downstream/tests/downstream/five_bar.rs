//! A five-bar on a tilted plane against a reference of 24 digits: accelerations at the start by the library's joint, whose cranks are independent, by one that is read by its left rod and right crank, and by one that is read by its left side;
//! motions by three readings after each other. A surface of configurations has no two coordinates that serve everywhere: along this motion the rods come in line at 0.15 s, the left crank and the right
//! rod at 0.61 s, the links of the right side at 0.36, 0.62 and 1.34 s. Where one choice of speeds nears its end, the state goes to a joint with another.

use hamel::compiled::{Compiled, Equations};
use hamel::dynamics::{Dynamics, MassMatrix, Recursive, Reference};
use hamel::integrate::{
    Form, Method, Options, Scheme, State, StepControl, integrate, no_inputs, no_observer,
};
use hamel_scene::Scene;
use hamel_tests::figures::{Largest, attitude_error, vector_error};
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::sync::Arc;

/// A joint of the five-bar: its name, the links whose rates are its speeds, its scene and its equations.
struct Reading {
    joint: &'static str,
    independent: [usize; 2],
    scene: &'static str,
    equations: &'static Equations,
}

macro_rules! reading {
    ($name:ident, $joint:literal, $independent:expr) => {
        #[expect(
            dead_code,
            reason = "sizes, for who calls the functions without a mechanism"
        )]
        mod $name {
            include!(concat!(env!("OUT_DIR"), "/by_", $joint, ".rs"));
        }
        impl Reading {
            const fn $name() -> Self {
                Self {
                    joint: $joint,
                    independent: $independent,
                    scene: include_str!(concat!(env!("OUT_DIR"), "/by_", $joint, ".toml")),
                    equations: &$name::EQUATIONS,
                }
            }
        }
    };
}

reading!(cranks, "five_bar", [0, 2]);
reading!(left, "five_bar_left", [0, 1]);
reading!(rods, "five_bar_rods", [1, 2]);

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

impl Reading {
    /// The mechanism at the start of the motion.
    fn scene(&self) -> Scene {
        let scene = Scene::parse(self.scene, "five_bar.toml", &crate::common::registry());
        scene.unwrap_or_else(|errors| panic!("{errors}"))
    }

    /// Its speeds at a configuration where the links turn at these rates.
    fn speeds(&self, rates: &[f64; 4]) -> Vec<f64> {
        self.independent.map(|link| rates[link]).to_vec()
    }
}

/// Ten roundings of the largest acceleration, times the condition of the mass matrix.
#[test]
fn accelerations_at_the_start_are_those_of_multipliers() {
    let reference = reference();
    let accelerations = against_ground(&reference["accelerations"]);
    let largest = accelerations
        .iter()
        .fold(0.0_f64, |most, own| own.abs().max(most));
    for reading in [Reading::cranks(), Reading::left(), Reading::rods()] {
        let (joint, scene) = (reading.joint, reading.scene());
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
            let errors = reading.independent.into_iter().zip(rates);
            let errors = errors.map(|(link, rate)| (rate - accelerations[link]).abs() / largest);
            let error = errors.fold(0.0, f64::max);
            println!("{joint}: accelerations within {error:e}, of {bound:e}");
            assert!(error <= bound, "{joint}: {error:e}, not {bound:e}");
        }
    }
}

/// Which reading is used up to which time, s: of the reading's dependent links, the sine of the angle between is at least 0.35.
const PIECES: [(Reading, f64); 4] = [
    (Reading::rods(), 0.55),
    (Reading::left(), 0.75),
    (Reading::cranks(), 1.15),
    (Reading::left(), 1.5),
];

/// Rates of the links, rad/s, from the rates of their directions.
fn link_rates(scene: &Scene, state: &State) -> [f64; 4] {
    let joint = scene.mechanism.bodies()[0].joint();
    let q = &state.configuration;
    let mut moving = vec![0.0; q.len()];
    joint.configuration_rate(q, &state.speeds, &mut moving);
    std::array::from_fn(|link| {
        let (cos, sin) = (2 * link, 2 * link + 1);
        q[cos] * moving[sin] - q[sin] * moving[cos]
    })
}

/// Meets the floors of a sample: its conditioning is what one relative change of an input makes of it, and half a rounding is what doubles do to one.
fn compare(scene: &Scene, state: &State, sample: &Value, worst: &mut Largest, place: &str) {
    let floor = 0.5 * f64::EPSILON * sample["conditioning"].as_f64().expect("a number");
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
            worst.meet(error / floor, format!("{} s, {place}", state.time));
        }
    }
}

/// The motion by the pieces, in a form, by the tree or by compiled equations.
fn motion(form: Form, compiled: bool, samples: &[Value]) -> Largest {
    let place = format!("{form:?}, compiled: {compiled}");
    let mut worst = Largest::new("floors of the five-bar");
    let mut reached: Option<(f64, Vec<f64>, [f64; 4])> = None;
    for (reading, until) in PIECES {
        let scene = reading.scene();
        let mut state = scene.start();
        if let Some((time, configuration, rates)) = reached.take() {
            state = State {
                time,
                configuration,
                speeds: reading.speeds(&rates),
            };
        }
        let time = |sample: &Value| sample["t"].as_f64().expect("a time");
        let within = |sample: &&Value| (state.time..until + 1e-9).contains(&time(sample));
        let own: Vec<&Value> = samples.iter().filter(within).collect();
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
            t_end: until,
            samples: own.iter().map(|sample| time(sample)).collect(),
            form,
        };
        let mechanism = || Arc::clone(&scene.mechanism);
        let mut dynamics: Box<dyn Dynamics> = match compiled {
            true => Box::new(Compiled::new(mechanism(), reading.equations).expect("its scene")),
            false => Box::new(Recursive::new(mechanism())),
        };
        let found = integrate(
            &mut *dynamics,
            &state,
            &options,
            &mut no_inputs,
            &mut no_observer,
        );
        let found = found.unwrap_or_else(|error| panic!("{place}: {error}"));
        for (state, sample) in found.samples.iter().zip(own) {
            compare(&scene, state, sample, &mut worst, &place);
        }
        let rates = link_rates(&scene, &found.state);
        reached = Some((until, found.state.configuration, rates));
    }
    worst
}

#[test]
fn motions_are_those_of_multipliers() {
    let reference = reference();
    let samples = reference["samples"].as_array().expect("samples");
    for compiled in [false, true] {
        motion(Form::Lagrangian, compiled, samples).assert_within(10.0);
        motion(Form::Hamiltonian, compiled, samples).assert_within(30.0);
    }
}
