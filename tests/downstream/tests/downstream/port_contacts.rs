//! Limits and dry friction at ports of linkages, and springs there that rest at home.

use crate::common::registry;
use hamel::dynamics::Recursive;
use hamel::integrate::{Form, Integration, Method, Options, Solution, State};
use hamel::mechanism::Mechanism;
use hamel_compiler::scene_of;
use hamel_scene::Scene;
use std::path::Path;
use std::sync::Arc;

/// A crank-rocker in the plane across gravity: what acts at its joint, and its initial state, are left open.
const LINKAGE: &str = r#"
hamel = 1
name = "linkage"
gravity = [0.0, 0.0, -9.81]

[[body]]
name = "linkage"
parent = "world"
joint = { type = "crank_rocker", ground = 0.9, crank = 0.3, coupler = 1.0, rocker = 0.8 }
initial = { {initial} }
bodies.crank = { mass = 1.3, com = [0.05, 0.0, 0.0], inertia = [[0.02, 0.0, 0.0], [0.0, 0.04, 0.0], [0.0, 0.0, 0.055]] }
bodies.coupler = { mass = 0.8, com = [0.46, 0.1, 0.0], inertia = [[0.01, 0.0, 0.0], [0.0, 0.095, 0.0], [0.0, 0.0, 0.101]] }
bodies.rocker = { mass = 1.1, com = [0.4, 0.0, 0.0], inertia = [[0.01, 0.0, 0.0], [0.0, 0.06, 0.0], [0.0, 0.0, 0.064]] }
{forces}
"#;

const ROCKER: usize = 1;

fn text(initial: &str, forces: &str) -> String {
    LINKAGE
        .replace("{initial}", initial)
        .replace("{forces}", forces)
}

fn scene(initial: &str, forces: &str) -> Scene {
    let built = Scene::parse(&text(initial, forces), "linkage.toml", &registry());
    built.unwrap_or_else(|errors| panic!("{errors}"))
}

fn run(scene: &Scene, form: Form, (t_end, samples): (f64, u32)) -> Solution {
    let options = Options {
        form,
        method: Method::dormand_prince(1e-11),
        t_end,
        samples: (0..=samples)
            .map(|n| t_end * f64::from(n) / f64::from(samples))
            .collect(),
    };
    let initial = scene.start();
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let integration = Integration::new(&mut dynamics, &initial, &options);
    integration.run().expect("no failure")
}

fn energy(mechanism: &Mechanism, state: &State) -> f64 {
    let kinematics = mechanism.kinematics(&state.configuration, &state.speeds);
    kinematics.expect("sizes fit").energy()
}

/// The angle of the rocker.
fn rocker(mechanism: &Mechanism, state: &State) -> f64 {
    let q = mechanism.bodies()[0].configuration(&state.configuration);
    mechanism.port_values(0, q).expect("on the manifold")[ROCKER]
}

/// A stop without damping gives back what it takes, and turns the linkage round: the rocker stays as far beyond as the energy says.
#[test]
fn a_limit_gives_way_and_turns_back() {
    let limit = 2.0;
    let forces = format!(
        "ports.rocker = {{ limit = {{ lower = 0.0, upper = {limit:?}, stiffness = 400.0 }} }}"
    );
    let scene = scene("phi = [0.3], speeds = [4.0]", &forces);
    let mechanism = &scene.mechanism;
    assert!(rocker(mechanism, &scene.start()) < limit);
    let first = energy(mechanism, &scene.start());
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let solution = run(&scene, form, (2.0, 400));
        let angles = solution
            .samples
            .iter()
            .map(|state| rocker(mechanism, state));
        let most = angles.fold(f64::NEG_INFINITY, f64::max);
        // ½ k x² is at most all of the energy.
        assert!(
            most > limit && most < limit + (2.0 * first / 400.0).sqrt(),
            "{most}"
        );
        let backwards = solution.samples.iter().any(|state| state.speeds[0] < -1.0);
        assert!(backwards, "it is turned round");
        for state in &solution.samples {
            // Some hundred steps with a tolerance of 1e-11 each.
            let gained = (energy(mechanism, state) - first).abs() / first;
            assert!(gained < 1e-8, "{form:?}: {gained:e}");
        }
    }
}

/// At the port that is v, friction is that of the degree of freedom.
#[test]
fn friction_at_the_port_of_a_degree_of_freedom_is_its_own() {
    let initial = "phi = [0.3], speeds = [4.0]";
    let [at_port, at_freedom] = ["ports.crank.friction = 0.3", "friction = 0.3"]
        .map(|forces| run(&scene(initial, forces), Form::Lagrangian, (4.0, 40)));
    assert_eq!(at_port.events.len(), at_freedom.events.len());
    for (one, other) in at_port.samples.iter().zip(&at_freedom.samples) {
        let error = (one.speeds[0] - other.speeds[0]).abs();
        // The same up to the rounding of a factor 1.
        assert!(error < 1e-12, "{error:e} at {}", one.time);
    }
}

/// Friction at the rocker takes f times the way that the rocker goes, to and fro, until it sticks.
#[test]
fn friction_takes_the_work_of_the_way() {
    let friction = 0.8;
    let forces = format!("ports.rocker.friction = {friction:?}");
    let scene = scene("phi = [0.3], speeds = [5.0]", &forces);
    let mechanism = &scene.mechanism;
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let solution = run(&scene, form, (6.0, 20_000));
        let mut way = 0.0;
        for pair in solution.samples.windows(2) {
            way += (rocker(mechanism, &pair[1]) - rocker(mechanism, &pair[0])).abs();
        }
        let lost = energy(mechanism, &scene.start()) - energy(mechanism, &solution.state);
        // Where the rocker turns back between two samples 3e-4 s apart, as much as a·h² of its way is not seen: below 1e-5 with some ten turns.
        let error = (lost - friction * way).abs();
        assert!(error < 1e-5, "{form:?}: {lost} and {}", friction * way);
        let last = solution.events.last().expect("it comes to rest");
        assert_eq!(last.name, "linkage: sticks");
        assert_eq!(solution.state.speeds, [0.0]);
    }
}

/// At rest friction holds up to `|P| f` against efforts at v, and gives way beyond.
#[test]
fn friction_holds_what_it_can() {
    let bare = scene("phi = [0.3]", "");
    let q = &bare.configuration;
    let map = bare.mechanism.port_map(0, q).expect("on the manifold");
    let holds = map[(ROCKER, 0)].abs() * 0.8;
    for (effort, moves) in [(0.99 * holds, false), (1.01 * holds, true)] {
        let forces = format!("ports.rocker.friction = 0.8\neffort = [{effort:?}]");
        let solution = run(&scene("phi = [0.3]", &forces), Form::Lagrangian, (0.5, 10));
        assert_eq!(solution.state.speeds[0] != 0.0, moves, "{effort}");
    }
}

/// Without `rest`, a spring at a port rests where the port is at the joint's home.
#[test]
fn springs_rest_at_home() {
    let at_home = scene("", "");
    let q = at_home.mechanism.home();
    let home = at_home.mechanism.port_values(0, &q).expect("home")[ROCKER];
    let spring = |rest: &str| format!("ports.rocker.spring = {{ stiffness = 4.0{rest} }}");
    let given = scene("speeds = [1.0]", &spring(&format!(", rest = {home:?}")));
    let left_out = scene("speeds = [1.0]", &spring(""));
    let [one, other] = [&given, &left_out].map(|scene| run(scene, Form::Lagrangian, (1.0, 4)));
    assert_eq!(one.state.speeds, other.state.speeds);
    // Home is found by iteration, which the scene compiler has not.
    let described = Scene::from_toml(&text("", &spring("")), "linkage.toml");
    let compiled = scene_of(
        "linkage",
        described.unwrap_or_else(|errors| panic!("{errors}")),
    )
    .specs(Path::new(env!("CARGO_MANIFEST_DIR")).join("joints"))
    .library(hamel_joints::specs())
    .model();
    let message = compiled.expect_err("it is refused").to_string();
    let expected = "joint `linkage`: home of `crank_rocker` is found by Newton's method, and what ports are there is not compiled: give the `rest` of springs at ports";
    assert!(message.contains(expected), "{message}");
}

/// What moves in several ways has no friction that sticks, at its ports neither.
#[test]
fn friction_of_several_degrees_of_freedom_is_refused_by_name() {
    let wheels = ["front_left", "front_right", "rear_left", "rear_right"];
    let body = |name: &str| {
        format!(
            "bodies.{name} = {{ mass = 1.0, inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]] }}\n"
        )
    };
    let bodies: String = wheels
        .iter()
        .chain(&["chassis"])
        .map(|name| body(name))
        .collect();
    let text = format!(
        "hamel = 1\ngravity = [0.0, 0.0, -9.81]\n[[body]]\nname = \"car\"\nparent = \"world\"\n\
         joint = {{ type = \"car_wheels\", base = 2.5, half = 0.7, radius = 0.3 }}\n{bodies}ports.motor.friction = 0.3\n"
    );
    let refused = Scene::parse(&text, "car.toml", &registry()).expect_err("it is refused");
    let message = refused.to_string();
    let expected = "joint `car`: friction at port `motor` needs a single degree of freedom, and `car_wheels` has 8, with constraints";
    assert!(message.contains(expected), "{message}");
    assert!(message.contains("give `damping`"), "{message}");
}
