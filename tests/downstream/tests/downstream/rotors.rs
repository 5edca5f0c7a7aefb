//! Rotors at ports of linkages: as bodies of the joint that turn with the port, and in all forms of the dynamics.

use crate::common::registry;
use hamel::dynamics::{Dynamics, Recursive, Reference, Refined};
use hamel::integrate::{Form, Integration, Method, Options, Scheme, Solution, State};
use hamel::mechanism::Mechanism;
use hamel_compiler::scene_of;
use hamel_scene::{Scene, SceneDescription};
use hamel_tests::c99::{Extent, agree};
use hamel_tests::compiled::{Functions, Point};
use std::path::Path;
use std::sync::Arc;

/// A crank-rocker with a pendulum on its coupler; `{crank}` and `{rocker}` are inertias about the pins, `{forces}` what acts at the joint.
const LINKAGE: &str = r#"
hamel = 1
name = "linkage"
gravity = [0.0, -9.81, 0.0]

[[body]]
name = "linkage"
parent = "world"
joint = { type = "crank_rocker", ground = 0.9, crank = 0.3, coupler = 1.0, rocker = 0.8 }
initial = { phi = [0.4], speeds = [3.0] }
bodies.crank = { mass = 1.3, com = [0.05, 0.0, 0.0], inertia = [[0.3, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, {crank}]] }
bodies.coupler = { mass = 0.8, com = [0.46, 0.1, 0.0], inertia = [[0.01, 0.0, 0.0], [0.0, 0.095, 0.0], [0.0, 0.0, 0.101]] }
bodies.rocker = { mass = 1.1, com = [0.4, 0.0, 0.0], inertia = [[0.3, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, {rocker}]] }
{forces}

[[body]]
name = "bob"
parent = "linkage.coupler"
mass = 0.4
com = [0.0, -0.2, 0.0]
inertia = [[0.01, 0.0, 0.0], [0.0, 0.005, 0.0], [0.0, 0.0, 0.01]]
joint = { type = "revolute" }
"#;

/// A car whose motor turns with the rear wheels (nonholonomic).
const CAR: &str = r#"
hamel = 1
name = "car"
gravity = [0.0, 0.0, -9.81]

[[body]]
name = "car"
parent = "world"
joint = { type = "car_wheels", base = 2.5, half = 0.7, radius = 0.3 }
initial = { speeds = [4.0, 0.3] }
bodies.chassis = { mass = 900.0, com = [1.2, 0.0, 0.2], inertia = [[150.0, 0.0, 0.0], [0.0, 700.0, 0.0], [0.0, 0.0, 800.0]] }
bodies.front_left = { mass = 15.0, inertia = [[0.5, 0.0, 0.0], [0.0, 0.8, 0.0], [0.0, 0.0, 0.5]] }
bodies.front_right = { mass = 15.0, inertia = [[0.5, 0.0, 0.0], [0.0, 0.8, 0.0], [0.0, 0.0, 0.5]] }
bodies.rear_left = { mass = 15.0, inertia = [[0.5, 0.0, 0.0], [0.0, 0.8, 0.0], [0.0, 0.0, 0.5]] }
bodies.rear_right = { mass = 15.0, inertia = [[0.5, 0.0, 0.0], [0.0, 0.8, 0.0], [0.0, 0.0, 0.5]] }
ports.motor = { armature = 30.0 }
"#;

/// Rotors at all ports: of angles to the ground and between links, and of a height.
const ALL: &str = "ports.crank = { armature = 0.03 }
ports.rocker = { armature = 0.2 }
ports.knee = { armature = 0.11, effort = 0.4 }
ports.lift = { armature = 0.7, spring = { stiffness = 30.0, rest = 0.4 } }";

const AT_CRANK: &str = "ports.crank.armature = 0.17";
const AT_ROCKER: &str = "ports.rocker.armature = 0.17";
/// The inertias of crank and rocker without and with the rotor in them.
const OWN: [f64; 2] = [0.055, 0.064];
const ROTOR: f64 = 0.17;

fn text([crank, rocker]: [f64; 2], forces: &str) -> String {
    LINKAGE
        .replace("{crank}", &crank.to_string())
        .replace("{rocker}", &rocker.to_string())
        .replace("{forces}", forces)
}

fn built(text: &str) -> Scene {
    let scene = Scene::parse(text, "scene.toml", &registry());
    scene.unwrap_or_else(|errors| panic!("{errors}"))
}

fn motion(
    dynamics: &mut dyn Dynamics,
    scene: &Scene,
    (form, method): (Form, Method),
    t_end: f64,
) -> Solution {
    let options = Options {
        form,
        method,
        t_end,
        samples: (1..40).map(|n| t_end * f64::from(n) / 40.0).collect(),
    };
    let initial = scene.start();
    let integration = Integration::new(dynamics, &initial, &options);
    integration.run().expect("no failure")
}

fn run(scene: &Scene, form: Form, t_end: f64) -> Vec<State> {
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let method = Method::dormand_prince(1e-11);
    motion(&mut dynamics, scene, (form, method), t_end).samples
}

fn energy(mechanism: &Mechanism, state: &State) -> f64 {
    let kinematics = mechanism.kinematics(&state.configuration, &state.speeds);
    kinematics.expect("sizes fit").energy()
}

/// All that a form of the dynamics says of a state: v̄̇, p̄, v̄ of p̄, p̄̇ and the energy.
fn all_of(dynamics: &mut dyn Dynamics, state: &State) -> Vec<f64> {
    let (q, v) = (&state.configuration, &state.speeds);
    let count = v.len();
    let mut found = vec![];
    let mut room = vec![0.0; count];
    let efforts: Vec<f64> = (0..dynamics.mechanism().layout().freedoms)
        .map(|n| 0.7 - n as f64)
        .collect();
    dynamics
        .forward_dynamics(q, v, &efforts, &mut room)
        .expect("regular");
    found.extend(&room);
    let mut momenta = vec![0.0; count];
    dynamics.momenta(q, v, &mut momenta).expect("sizes fit");
    found.extend(&momenta);
    let mut speeds = vec![0.0; count];
    dynamics
        .momentum_rates(
            q,
            &momenta,
            &mut |_, tau| tau.copy_from_slice(&efforts),
            &mut speeds,
            &mut room,
        )
        .expect("regular");
    found.extend(&speeds);
    found.extend(&room);
    found.push(dynamics.hamiltonian(q, &momenta).expect("regular"));
    found
}

#[track_caller]
fn agrees(found: &[f64], expected: &[f64], bound: f64) {
    for (n, (found, expected)) in found.iter().zip(expected).enumerate() {
        let error = (found - expected).abs() / expected.abs().max(1.0);
        assert!(
            error < bound,
            "entry {n}: {found} and {expected}, {error:e}"
        );
    }
}

/// A rotor that turns with the crank, or with the rocker, is inertia of that link: about a pin that rests, whatever the port is to v.
#[test]
fn a_rotor_is_a_body_that_turns_with_the_port() {
    let places = [(AT_CRANK, [ROTOR, 0.0]), (AT_ROCKER, [0.0, ROTOR])];
    for (at_port, more) in places {
        let geared = built(&text(OWN, at_port));
        let heavy = built(&text([OWN[0] + more[0], OWN[1] + more[1]], ""));
        for state in run(&heavy, Form::Lagrangian, 2.0) {
            let expected = all_of(&mut Reference::new(Arc::clone(&heavy.mechanism)), &state);
            let mechanism = || Arc::clone(&geared.mechanism);
            let forms: [&mut dyn Dynamics; 3] = [
                &mut Recursive::new(mechanism()),
                &mut Reference::new(mechanism()),
                &mut Refined::new(mechanism()),
            ];
            for form in forms {
                // Rounding times the condition of M̄, below 100.
                agrees(&all_of(form, &state), &expected, 1e-12);
            }
            let [found, expected] = [&geared, &heavy].map(|scene| {
                let energy = energy(&scene.mechanism, &state);
                let [rates, efforts, forces] = needed(scene, &state);
                [vec![energy], rates, efforts, forces].concat()
            });
            agrees(&found, &expected, 1e-12);
        }
    }
}

/// v̄̇ without inputs, the efforts that inverse dynamics finds for 1, −2 as v̄̇, and the multipliers of the relations then.
fn needed(scene: &Scene, state: &State) -> [Vec<f64>; 3] {
    let (q, v) = (&state.configuration, &state.speeds);
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let (mut rates, mut efforts) = (vec![0.0; 2], vec![0.0; 2]);
    dynamics
        .forward_dynamics(q, v, &[0.0; 2], &mut rates)
        .expect("regular");
    dynamics
        .inverse_dynamics(q, v, &[1.0, -2.0], &mut efforts)
        .expect("sizes fit");
    let forces = dynamics.relation_forces(0, q, v).expect("regular");
    [rates, efforts, forces]
}

/// A rotor at the crank's port is one at its degree of freedom.
#[test]
fn a_rotor_at_a_port_is_one_at_the_same_degree_of_freedom() {
    let at_port = built(&text(OWN, AT_CRANK));
    let at_freedom = built(&text(OWN, "armature = 0.17"));
    for state in run(&at_port, Form::Lagrangian, 1.0) {
        let [found, expected] = [&at_port, &at_freedom]
            .map(|scene| all_of(&mut Recursive::new(Arc::clone(&scene.mechanism)), &state));
        agrees(&found, &expected, 1e-13);
    }
}

/// The recursion against the theorems, at all ports and on a nonholonomic joint.
#[test]
fn forms_agree() {
    for scene in [built(&text(OWN, ALL)), built(CAR)] {
        for state in run(&scene, Form::Lagrangian, 2.0) {
            let mechanism = || Arc::clone(&scene.mechanism);
            let expected = all_of(&mut Reference::new(mechanism()), &state);
            // Rounding times the condition of M̄, some hundreds.
            agrees(
                &all_of(&mut Recursive::new(mechanism()), &state),
                &expected,
                1e-11,
            );
            agrees(
                &all_of(&mut Refined::new(mechanism()), &state),
                &expected,
                1e-11,
            );
        }
    }
}

/// Energy is kept by what is exact, in both forms, and to rounding by the discrete gradient.
#[test]
fn energy_is_kept() {
    let still = ALL.replace("effort = 0.4", "damping = 0.0");
    for scene in [built(&text(OWN, &still)), built(CAR)] {
        let mechanism = &scene.mechanism;
        let first = energy(mechanism, &scene.start());
        let scale = scene
            .start()
            .speeds
            .iter()
            .map(|v| v * v)
            .sum::<f64>()
            .max(first.abs());
        let gain = |states: &[State]| {
            let each = states.iter().map(|state| energy(mechanism, state) - first);
            each.fold(0.0, |most: f64, own| most.max(own.abs())) / scale
        };
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let gained = gain(&run(&scene, form, 2.0));
            // Some hundred steps with a tolerance of 1e-11 each.
            assert!(gained < 1e-8, "{form:?}: {gained:e}");
        }
        let mut dynamics = Recursive::new(Arc::clone(mechanism));
        let method = Method::fixed(Scheme::DiscreteGradient, 0.004);
        let solution = motion(&mut dynamics, &scene, (Form::Hamiltonian, method), 2.0);
        let gained = gain(&[solution.state]);
        // Rounding of an energy that is some times the scale, at each of the steps but not adding up.
        assert!(gained < 1e-13, "discrete gradient: {gained:e}");
    }
}

/// The forms give one motion.
#[test]
fn forms_move_alike() {
    for scene in [built(&text(OWN, ALL)), built(CAR)] {
        let [one, other] = [Form::Lagrangian, Form::Hamiltonian].map(|form| run(&scene, form, 1.0));
        for (one, other) in one.iter().zip(&other) {
            // Some hundred steps with a tolerance of 1e-11 each, on motions that do not part fast.
            agrees(&one.configuration, &other.configuration, 1e-7);
            agrees(&one.speeds, &other.speeds, 1e-7);
        }
    }
}

fn described(text: &str) -> SceneDescription {
    let found = Scene::from_toml(text, "scene.toml");
    found.unwrap_or_else(|errors| panic!("{errors}"))
}

/// In C bit by bit as evaluated, and against the tree.
#[test]
fn compiled_scenes_are_the_tree() {
    let texts = [("linkage", text(OWN, ALL)), ("car", CAR.to_owned())];
    let cases: Vec<_> = texts
        .into_iter()
        .map(|(name, text)| {
            let model = scene_of(name, described(&text))
                .specs(Path::new(env!("CARGO_MANIFEST_DIR")).join("joints"))
                .library(hamel_joints::specs())
                .model();
            let model = model.unwrap_or_else(|error| panic!("{error}"));
            (built(&text).mechanism, model)
        })
        .collect();
    for (mechanism, model) in &cases {
        let functions = Functions::new(model);
        for seed in 0..4 {
            let point = || Point::random(model.clone(), mechanism, seed);
            point().agrees_with(&functions);
            point().derivatives_agree_with(&functions);
        }
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("c99/rotors");
    agree(&folder, &cases, Extent::FEW_SCENES);
}
