//! Ports of linkages: their rates, what efforts at them do, scenes that name them, and compiled scenes.

use crate::common::registry;
use hamel::dynamics::{Dynamics, Recursive, Reference};
use hamel::integrate::{
    Form, Integration, Method, Options, State, integrate, no_inputs, no_observer,
};
use hamel::mechanism::Mechanism;
use hamel_compiler::model::Model;
use hamel_compiler::{Error, scene_of};
use hamel_scene::{Scene, SceneDescription};
use hamel_tests::c99::{Extent, agree};
use hamel_tests::compiled::{Functions, Point};
use std::path::Path;
use std::sync::Arc;

/// A crank-rocker with a pendulum on its coupler; `{ports}` and `{initial}` are left open.
const LINKAGE: &str = r#"
hamel = 1
name = "linkage"
gravity = [0.0, -9.81, 0.0]

[[body]]
name = "linkage"
parent = "world"
joint = { type = "crank_rocker", ground = 0.9, crank = 0.3, coupler = 1.0, rocker = 0.8 }
initial = { {initial} }
bodies.crank = { mass = 1.3, com = [0.05, 0.0, 0.0], inertia = [[0.02, 0.0, 0.0], [0.0, 0.04, 0.0], [0.0, 0.0, 0.055]] }
bodies.coupler = { mass = 0.8, com = [0.46, 0.1, 0.0], inertia = [[0.01, 0.0, 0.0], [0.0, 0.095, 0.0], [0.0, 0.0, 0.101]] }
bodies.rocker = { mass = 1.1, com = [0.4, 0.0, 0.0], inertia = [[0.01, 0.0, 0.0], [0.0, 0.06, 0.0], [0.0, 0.0, 0.064]] }
{ports}

[[body]]
name = "bob"
parent = "linkage.coupler"
mass = 0.4
com = [0.0, -0.2, 0.0]
inertia = [[0.01, 0.0, 0.0], [0.0, 0.005, 0.0], [0.0, 0.0, 0.01]]
joint = { type = "revolute" }
"#;

fn text(initial: &str, ports: &str) -> String {
    LINKAGE
        .replace("{initial}", initial)
        .replace("{ports}", ports)
}

fn described(initial: &str, ports: &str) -> SceneDescription {
    let found = Scene::from_toml(&text(initial, ports), "linkage.toml");
    found.unwrap_or_else(|errors| panic!("{errors}"))
}

fn scene(initial: &str, ports: &str) -> Scene {
    let built = described(initial, ports).build(&registry());
    built.unwrap_or_else(|errors| panic!("{errors}"))
}

/// What a scene is refused with.
fn refusal(initial: &str, ports: &str) -> String {
    match described(initial, ports).build(&registry()) {
        Ok(_) => panic!("the scene is refused"),
        Err(errors) => errors.to_string(),
    }
}

const ALL: &str = "ports.crank = { effort = 0.9, damping = 0.2 }
ports.rocker = { limit = { lower = -0.5, upper = 2.2, stiffness = 30.0 } }
ports.knee = { spring = { stiffness = 3.0, rest = 2.0 }, damping = 0.1, limit = { lower = 1.2, upper = 1.9, stiffness = 20.0, damping = 0.3 } }
ports.lift = { spring = { stiffness = 40.0, rest = 0.3 }, effort = -2.0, armature = 0.7 }";

/// States along a motion, the first and the last among them.
fn run(scene: &Scene, form: Form, t_end: f64) -> Vec<State> {
    let initial = State {
        time: 0.0,
        configuration: scene.configuration.clone(),
        speeds: scene.speeds.clone(),
    };
    let options = Options {
        form,
        method: Method::dormand_prince(1e-11),
        t_end,
        samples: (1..40).map(|n| t_end * f64::from(n) / 40.0).collect(),
    };
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let (inputs, observer) = (&mut no_inputs, &mut no_observer);
    let solution = integrate(&mut dynamics, &initial, &options, inputs, observer);
    let solution = solution.expect("no failure");
    let mut states = vec![initial.clone()];
    states.extend(solution.samples.clone());
    states.push(solution.state);
    states
}

fn energy(mechanism: &Mechanism, state: &State) -> f64 {
    let kinematics = mechanism.kinematics(&state.configuration, &state.speeds);
    kinematics.expect("sizes fit").energy()
}

/// The values of the linkage's ports.
fn values(mechanism: &Mechanism, state: &State) -> Vec<f64> {
    let q = mechanism.bodies()[0].configuration(&state.configuration);
    mechanism.port_values(0, q).expect("on the manifold")
}

/// The derivative of each port's value along the motion, by central differences, is its rate.
#[test]
fn rates_are_those_of_the_values() {
    let scene = scene("speeds = [3.0]", ALL);
    let mechanism = &scene.mechanism;
    for state in run(&scene, Form::Lagrangian, 2.0) {
        let rates = mechanism
            .port_rates(0, &state.configuration, &state.speeds)
            .expect("sizes fit");
        let step = 1e-5;
        let moved = |sign: f64| {
            let mut moved = state.clone();
            let joint = mechanism.bodies()[0].joint();
            let own = mechanism.bodies()[0].ranges().configuration.clone();
            let q = state.configuration[own.clone()].to_vec();
            joint.retract(
                &q,
                &[sign * step * state.speeds[0]],
                &mut moved.configuration[own],
            );
            values(mechanism, &moved)
        };
        let (after, before) = (moved(1.0), moved(-1.0));
        let ports = mechanism.bodies()[0].joint().ports();
        for (n, port) in ports.iter().enumerate() {
            let found = port.deflection(after[n], before[n]) / (2.0 * step);
            // h² f‴ / 6 with rates of some ten per second, and 1e-16 / h of rounding.
            let error = (found - rates[n]).abs();
            assert!(
                error < 1e-6,
                "{}: {found} and {} at {state:?}",
                port.name,
                rates[n]
            );
        }
    }
}

/// Efforts at ports have the power of `Pᵀ f` at v, whatever they are.
#[test]
fn power_is_the_same_at_ports_and_at_v() {
    let scene = scene("speeds = [3.0]", "");
    let mechanism = &scene.mechanism;
    for (n, state) in run(&scene, Form::Lagrangian, 1.0).iter().enumerate() {
        let efforts: Vec<f64> = (0..4)
            .map(|port| f64::from(port + n as i32) - 2.5)
            .collect();
        let q = mechanism.bodies()[0].configuration(&state.configuration);
        let tau = mechanism
            .efforts_from_ports(0, q, &efforts)
            .expect("sizes fit");
        let rates = mechanism
            .port_rates(0, &state.configuration, &state.speeds)
            .expect("sizes fit");
        let at_ports: f64 = efforts.iter().zip(&rates).map(|(f, w)| f * w).sum();
        let error = (at_ports - tau[0] * state.speeds[0]).abs();
        // A few products, each of some ten to hundred.
        assert!(error < 1e-12 * at_ports.abs().max(1.0), "{error:e}");
    }
}

/// A constant effort does the work `f Δy`; springs keep energy; the way of an angle that wraps adds up over turns.
#[test]
fn energy_changes_by_the_work_at_ports() {
    let efforts = "ports.crank = { effort = 0.9 }
ports.knee = { spring = { stiffness = 3.0, rest = 2.0 } }
ports.lift = { spring = { stiffness = 40.0, rest = 0.3 }, effort = -2.0 }";
    let scene = scene("speeds = [6.0]", efforts);
    let mechanism = &scene.mechanism;
    let [crank, lift] = ["crank", "lift"].map(|name| {
        mechanism
            .port_index(0, name)
            .expect("a port of the linkage")
    });
    let ports = mechanism.bodies()[0].joint().ports();
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let states = run(&scene, form, 2.0);
        let mut turned = 0.0;
        for pair in states.windows(2) {
            let [before, after] = [&pair[0], &pair[1]].map(|state| values(mechanism, state));
            turned += ports[crank].deflection(after[crank], before[crank]);
            let risen = after[lift] - values(mechanism, &states[0])[lift];
            let work = 0.9 * turned - 2.0 * risen;
            let gained = energy(mechanism, &pair[1]) - energy(mechanism, &states[0]);
            // Some thousand steps with a tolerance of 1e-11 each.
            let error = (gained - work).abs();
            assert!(error < 1e-7, "{form:?}: {error:e} at {}", pair[1].time);
        }
        assert!(
            turned > std::f64::consts::TAU,
            "the crank goes round: {turned}"
        );
    }
}

/// Efforts that are functions of time, as the same efforts at v are by hand.
#[test]
fn efforts_change_with_time() {
    let timed = scene(
        "speeds = [2.0]",
        r#"ports.rocker = { effort = "2 * sin(3 * t)" }"#,
    );
    let at_v = scene("speeds = [2.0]", "");
    let states = run(&timed, Form::Lagrangian, 1.0);
    let (mut found, mut expected) = (vec![0.0; 2], vec![0.0; 2]);
    for state in &states {
        let (q, v) = (&state.configuration, &state.speeds);
        let mut dynamics = Recursive::new(Arc::clone(&timed.mechanism));
        dynamics.set_moment(state.time.into());
        dynamics
            .forward_dynamics(q, v, &[0.0; 2], &mut found)
            .expect("regular");
        let own = at_v.mechanism.bodies()[0].configuration(q);
        let effort = 2.0 * (3.0 * state.time).sin();
        let tau = at_v
            .mechanism
            .efforts_from_ports(0, own, &[0.0, effort, 0.0, 0.0])
            .expect("sizes fit");
        Reference::new(Arc::clone(&at_v.mechanism))
            .forward_dynamics(q, v, &[tau[0], 0.0], &mut expected)
            .expect("regular");
        for (found, expected) in found.iter().zip(&expected) {
            // The reference form's matrices have a condition below 100.
            let error = (found - expected).abs();
            assert!(error < 1e-11 * expected.abs().max(1.0), "{error:e}");
        }
    }
}

#[test]
fn speeds_follow_from_rates_at_ports() {
    for (name, rate) in [("rocker", -1.5), ("lift", 0.4), ("crank", 2.0)] {
        let scene = scene(&format!("phi = [0.6], rates.{name} = {rate:?}"), "");
        let rates = scene
            .mechanism
            .port_rates(0, &scene.configuration, &scene.speeds)
            .expect("sizes fit");
        let port = scene.mechanism.port_index(0, name).expect("a port");
        assert!((rates[port] - rate).abs() < 1e-13, "{name}: {rates:?}");
    }
}

/// Where crank and coupler are in line, the rocker turns back, and its rate says nothing of the crank's.
#[test]
fn rates_that_determine_nothing_are_refused_by_name() {
    // Stretched: by the law of cosines, with sides 0.9, 1.3 and 0.8.
    let cos: f64 = (0.9_f64.powi(2) + 1.3_f64.powi(2) - 0.8_f64.powi(2)) / (2.0 * 0.9 * 1.3);
    let sin = (1.0 - cos * cos).sqrt();
    let rocker = [(1.3 * cos - 0.9) / 0.8, 1.3 * sin / 0.8];
    let place = format!(
        "configuration = [{cos}, {sin}, {cos}, {sin}, {}, {}]",
        rocker[0], rocker[1]
    );
    let message = refusal(&format!("{place}, rates.rocker = 1.0"), "");
    let expected = "the rates of these ports determine 0 of its speeds here, it has 1";
    assert!(message.contains(expected), "{message}");
    let message = refusal("rates = { crank = 1.0, rocker = 5.0 }", "");
    assert!(
        message.contains("cannot have these rates together"),
        "{message}"
    );
    let message = refusal("rates.cranc = 1.0", "");
    let expected = "a joint of type `crank_rocker` has no port `cranc`";
    assert!(message.contains(expected), "{message}");
    assert!(message.contains("did you mean `crank`?"), "{message}");
}

#[test]
fn unknown_ports_are_refused_by_name() {
    let message = refusal("", "ports.motor = { effort = 1.0 }");
    let expected = "joint `linkage`: a joint of type `crank_rocker` has no port `motor`";
    assert!(message.contains(expected), "{message}");
    assert!(message.contains("its ports are `crank`"), "{message}");
}

#[test]
fn scenes_with_ports_are_written_as_they_were_read() {
    let friction = "damping = 0.2, friction = { sliding = 0.1, sticking = 0.2 } }";
    let all = ALL.replace("damping = 0.2 }", friction);
    let first = described("rates = { crank = 2.0 }", &all);
    let again = Scene::from_toml(&first.to_toml(&[], |_| vec![]), "again.toml");
    let again = again.unwrap_or_else(|errors| panic!("{errors}"));
    let forces = |scene: &SceneDescription| scene.bodies[0].forces.ports.clone();
    let bare = |scene: &SceneDescription| {
        let named = forces(scene).into_iter();
        let named = named.map(|own| {
            let friction = own.friction.map(|own| own.value);
            let limit = own.limit.map(|own| own.value);
            (
                own.name.value,
                own.effort,
                own.spring,
                [own.damping, own.armature],
                friction,
                limit,
            )
        });
        named.collect::<Vec<_>>()
    };
    assert_eq!(bare(&first), bare(&again));
    let built = [first, again].map(|scene| scene.build(&registry()).expect("sound").speeds);
    assert_eq!(built[0], built[1]);
}

/// What is compiled of a scene with these ports.
fn compiled(ports: &str) -> Result<Model, Error> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("joints");
    scene_of("linkage", described("", ports))
        .specs(folder)
        .library(hamel_joints::specs())
        .model()
}

/// In C bit by bit as evaluated, and against the tree.
#[test]
fn compiled_scenes_in_c_are_the_tree() {
    let model = compiled(ALL).unwrap_or_else(|error| panic!("{error}"));
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("c99/ports");
    agree(
        &folder,
        &[(scene("", ALL).mechanism, model)],
        Extent::FEW_SCENES,
    );
}

#[test]
fn compiled_scenes_are_the_tree() {
    let scene = scene("", ALL);
    let model = compiled(ALL).unwrap_or_else(|error| panic!("{error}"));
    let functions = Functions::new(&model);
    for seed in 0..4 {
        let point = || Point::random(model.clone(), &scene.mechanism, seed);
        point().agrees_with(&functions);
        point().derivatives_agree_with(&functions);
    }
}

/// Crossings of a port's value and rate, against the motion's own samples: an angle up to whole turns crosses its value once a turn, not on the other side of the
/// circle as well.
#[test]
fn events_are_crossings_of_ports() {
    let events = r#"
[[event]]
name = "straight"
joint = "linkage"
port = "crank"
value = 0.5
[[event]]
name = "risen"
joint = "linkage"
port = "lift"
value = 0.6
direction = "rising"
[[event]]
name = "turning"
joint = "linkage"
rate = "rocker"
[simulation]
t_end = 2.0
"#;
    let text = text("speeds = [9.0]", "") + events;
    let scene = Scene::parse(&text, "linkage.toml", &registry());
    let scene = scene.unwrap_or_else(|errors| panic!("{errors}"));
    let mechanism = &scene.mechanism;
    let options = Options {
        form: Form::Lagrangian,
        method: Method::dormand_prince(1e-11),
        t_end: 2.0,
        samples: (0..=4000).map(|n| 5e-4 * f64::from(n)).collect(),
    };
    let initial = scene.start();
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let mut integration = Integration::new(&mut dynamics, &initial, &options);
    for event in &scene.events {
        integration = integration.event(event.event(mechanism));
    }
    let solution = integration.run().expect("no failure");
    let rates = |state: &State| {
        let rates = mechanism.port_rates(0, &state.configuration, &state.speeds);
        rates.expect("sizes fit")
    };
    // From one sample to the next, none of which falls on a crossing.
    let count = |beyond: &dyn Fn(&State) -> f64, rising_only: bool| {
        let pairs = solution.samples.windows(2);
        let crossed = pairs.filter(|pair| {
            let [a, b] = [beyond(&pair[0]), beyond(&pair[1])];
            let is_near = (b - a).abs() < 1.0;
            is_near && a * b < 0.0 && (!rising_only || b > a)
        });
        crossed.count()
    };
    let wanted = [
        count(&|state| values(mechanism, state)[0] - 0.5, false),
        count(&|state| values(mechanism, state)[3] - 0.6, true),
        count(&|state| rates(state)[1], false),
    ];
    let found: [usize; 3] = std::array::from_fn(|n| {
        let events = solution.events.iter();
        events.filter(|crossing| crossing.event == n).count()
    });
    assert_eq!(found, wanted);
    assert!(wanted.iter().all(|count| *count >= 2), "{wanted:?}");
    for crossing in &solution.events {
        let state = &crossing.state;
        let beyond = match crossing.event {
            0 => values(mechanism, state)[0] - 0.5,
            1 => values(mechanism, state)[3] - 0.6,
            _ => rates(state)[1],
        };
        // The rounding of time, at rates below a thousand.
        assert!(beyond.abs() < 1e-11, "{} {beyond}", crossing.name);
    }
}

#[test]
fn prescribed_motions_are_refused_at_ports() {
    let text = text("", "ports.crank.motion = { speeds = [1.0] }");
    let refused = Scene::from_toml(&text, "linkage.toml").expect_err("it is refused");
    let message = refused.to_string();
    let expected = "ports.crank.motion`: nothing of this kind acts at a port";
    assert!(message.contains(expected), "{message}");
}
