//! What the pins of a linkage carry, against Newton and Euler for each of its bodies, whose accelerations are differences of the velocities of a motion.

use hamel::dynamics::{Dynamics, PinForce, Recursive};
use hamel::integrate::{Form, Integration, Method, Options, Scheme, State};
use hamel::mechanism::{BodyState, Kinematics, Mechanism};
use hamel::nalgebra::Vector3;
use hamel::spatial::{MassProperties, Pose};
use hamel_scene::Scene;
use std::ops::ControlFlow;
use std::sync::Arc;

/// A free base on which a press hangs, tilted, with a pendulum on its slider and another on its rod. `{acting}` is left open.
const PRESS: &str = r#"
hamel = 1
name = "press"
gravity = [0.4, -9.81, 1.2]

[[body]]
name = "base"
parent = "world"
joint = { type = "free" }
mass = 3.1
com = [0.02, 0.1, -0.03]
inertia = [[0.11, 0.01, 0.0], [0.01, 0.14, 0.02], [0.0, 0.02, 0.12]]
initial = { speeds = [0.4, -0.7, 0.9, 0.3, -0.2, 0.5] }

[[body]]
name = "press"
parent = "base"
at = { position = [0.2, -0.1, 0.05], rpy = [0.3, -0.5, 0.8] }
joint = { type = "press", crank = 0.3, rod = 0.7 }
initial = { speeds = [4.0] }
bodies.crank = { mass = 1.3, com = [0.05, 0.01, 0.02], inertia = [[0.02, 0.001, 0.0], [0.001, 0.04, 0.0], [0.0, 0.0, 0.055]] }
bodies.rod = { mass = 0.8, com = [0.36, 0.04, -0.03], inertia = [[0.01, 0.0, 0.002], [0.0, 0.095, 0.0], [0.002, 0.0, 0.101]] }
bodies.slider = { mass = 1.1, com = [0.01, 0.03, 0.02], inertia = [[0.03, 0.0, 0.0], [0.0, 0.06, 0.004], [0.0, 0.004, 0.064]] }
{acting}

[[body]]
name = "bob"
parent = "press.slider"
mass = 0.4
com = [0.0, -0.2, 0.0]
inertia = [[0.01, 0.0, 0.0], [0.0, 0.005, 0.0], [0.0, 0.0, 0.01]]
at = { position = [0.1, 0.0, 0.0] }
joint = { type = "ball" }
initial = { speeds = [1.0, -2.0, 0.5] }
"#;

/// In the order of the bodies: base, crank, rod, slider, bob.
const LINKS: std::ops::Range<usize> = 1..4;
const BOB: usize = 4;

/// Between two samples, s.
const STEP: f64 = 1e-3;
/// Central differences of order 8.
const WEIGHTS: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];

const ALL: &str = r#"ports.motor = { effort = "1.5 * sin(3 * t) + 0.7", damping = 0.1 }
ports.slider = { spring = { stiffness = 40.0, rest = 0.6 }, damping = 2.0 }
ports.elbow = { spring = { stiffness = 3.0, rest = -0.4 } }
effort = [0.3]"#;

fn scene(acting: &str) -> Scene {
    let mut registry = hamel_joints::registry();
    registry
        .extend(hamel_downstream::entries())
        .expect("distinct names");
    let text = PRESS.replace("{acting}", acting);
    let described = Scene::from_toml(&text, "press.toml");
    let described = described.unwrap_or_else(|errors| panic!("{errors}"));
    described
        .build(&registry)
        .unwrap_or_else(|errors| panic!("{errors}"))
}

/// Samples around the middle one, at which the pins' forces are told.
struct Told {
    samples: Vec<Kinematics>,
    middle: State,
    forces: Vec<PinForce>,
}

fn told(scene: &Scene, form: Form) -> Told {
    let initial = State {
        time: 0.0,
        configuration: scene.configuration.clone(),
        speeds: scene.speeds.clone(),
    };
    let middle = WEIGHTS.len();
    let options = Options {
        form,
        method: Method::fixed(Scheme::DormandPrince8, STEP),
        t_end: STEP * 2.0 * WEIGHTS.len() as f64,
        samples: (0..=2 * middle).map(|n| n as f64 * STEP).collect(),
    };
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let mut forces = Vec::new();
    let solution = Integration::new(&mut dynamics, &initial, &options)
        .telling_forces()
        .observer(|step| {
            let carried = step.carried.expect("every step ends on a sample");
            if step.sample == Some(middle) {
                let (q, speeds) = (step.configuration, step.speeds);
                forces = carried.pin_forces(1, q, speeds).expect("they are known");
            }
            ControlFlow::Continue(())
        })
        .run()
        .expect("no failure");
    let samples = solution.samples.iter();
    let samples = samples.map(|state| {
        let found = scene
            .mechanism
            .kinematics(&state.configuration, &state.speeds);
        found.expect("sizes fit")
    });
    Told {
        samples: samples.collect(),
        middle: solution.samples[middle].clone(),
        forces,
    }
}

fn mass(mechanism: &Mechanism, body: usize) -> &MassProperties {
    mechanism.bodies()[body].mass()
}

/// Linear and angular momentum about the centre of mass, world axes.
fn momenta(mechanism: &Mechanism, body: usize, state: &BodyState) -> [Vector3<f64>; 2] {
    let MassProperties {
        mass, inertia_com, ..
    } = mass(mechanism, body);
    let (rotation, omega) = (state.pose.rotation, state.angular_velocity_body());
    [state.velocity_com * *mass, rotation * (inertia_com * omega)]
}

/// Their rates in the middle.
fn rates(mechanism: &Mechanism, told: &Told, body: usize) -> [Vector3<f64>; 2] {
    let at = |n: usize| momenta(mechanism, body, &told.samples[n].bodies[body]);
    let middle = WEIGHTS.len();
    let mut rates = [Vector3::zeros(); 2];
    for (n, weight) in WEIGHTS.iter().enumerate() {
        let (later, earlier) = (at(middle + n + 1), at(middle - n - 1));
        for (rate, (a, b)) in rates.iter_mut().zip(later.into_iter().zip(earlier)) {
            *rate += (a - b) * (weight / STEP);
        }
    }
    rates
}

/// What is missing on each link: the rates of its momenta less gravity, pins, efforts and the bob; with the largest force.
fn unbalanced(scene: &Scene, told: &Told, torque: [f64; 2], push: f64) -> ([f64; 3], f64) {
    let mechanism = &*scene.mechanism;
    let gravity = *mechanism.gravity();
    let bodies = &told.samples[WEIGHTS.len()].bodies;
    let q = |body: usize| mechanism.bodies()[body].configuration(&told.middle.configuration);
    let joint = |body: usize| mechanism.bodies()[body].joint();
    let parent: Pose<f64> = bodies[1].pose * joint(1).pose(q(1)).inverse();
    let axes = parent.rotation;
    let [crank, rod] = [0.3, 0.7];
    let end = |body: usize, length: f64| {
        bodies[body]
            .pose
            .transform_point(&Vector3::new(length, 0.0, 0.0))
    };
    // Where pins are, and which links hold each other there: the first, and the second if it is a link.
    let pins = [
        (bodies[1].pose.translation, 1, None),
        (end(1, crank), 2, Some(1)),
        (end(2, rod), 2, Some(3)),
        (bodies[3].pose.translation, 3, None),
    ];
    let mut wrench = [[Vector3::zeros(); 2]; 4];
    let mut exert =
        |body: usize, force: Vector3<f64>, point: Vector3<f64>, couple: Vector3<f64>| {
            let arm = point - bodies[body].position_com;
            wrench[body][0] += force;
            wrench[body][1] += couple + arm.cross(&force);
        };
    for (own, (point, first, second)) in told.forces.iter().zip(pins) {
        let (force, couple) = (axes * own.force, axes * own.moment);
        exert(first, force, point, couple);
        if let Some(second) = second {
            exert(second, -force, point, -couple);
        }
    }
    let z = axes.column(2).into_owned();
    exert(
        1,
        Vector3::zeros(),
        parent.translation,
        z * (torque[0] - torque[1]),
    );
    exert(2, Vector3::zeros(), parent.translation, z * torque[1]);
    exert(
        3,
        axes.column(0) * push,
        bodies[3].pose.translation,
        Vector3::zeros(),
    );
    let [force, couple] = rates(mechanism, told, BOB);
    let hanging = force - gravity * mass(mechanism, BOB).mass;
    exert(3, -hanging, bodies[BOB].position_com, -couple);
    let missing = LINKS.map(|body| {
        let [force, couple] = rates(mechanism, told, body);
        let weight = gravity * mass(mechanism, body).mass;
        let [own, moment] = wrench[body];
        (force - weight - own).norm().max((couple - moment).norm())
    });
    let missing: Vec<f64> = missing.collect();
    let largest = told
        .forces
        .iter()
        .map(|own| own.force.norm())
        .fold(0.0, f64::max);
    ([missing[0], missing[1], missing[2]], largest)
}

/// On a moving base, with a body hanging on the linkage, springs, dampers, a motor with a course of time and an effort on v, in both forms.
#[test]
fn pins_carry_what_newton_and_euler_ask_for() {
    let scene = scene(ALL);
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let told = told(&scene, form);
        let state = &told.middle;
        let q = scene.mechanism.bodies()[1].configuration(&state.configuration);
        let values = scene.mechanism.port_values(1, q).expect("it is there");
        let rates = scene
            .mechanism
            .port_rates(1, &state.configuration, &state.speeds)
            .expect("sizes fit");
        let motor = 1.5 * (3.0 * state.time).sin() + 0.7 - 0.1 * rates[0] + 0.3;
        let push = -40.0 * (values[1] - 0.6) - 2.0 * rates[1];
        let elbow = -3.0 * (values[2] + 0.4);
        let (missing, largest) = unbalanced(&scene, &told, [motor, elbow], push);
        assert!(largest > 10.0, "{largest}");
        for open in missing {
            // Velocities of 5 m/s, rounded, over a step of 1e-3 s, times what the differences add up.
            assert!(
                open < 2e-11 * largest.max(1.0),
                "{form:?}: {missing:?} of {largest}"
            );
        }
        assert!(told.forces[2].moment.iter().all(|moment| *moment == 0.0));
        let (elbow, slide) = (told.forces[1], told.forces[3]);
        assert_eq!(
            (elbow.force.z, elbow.moment.z, slide.force.x),
            (0.0, 0.0, 0.0)
        );
    }
}

fn refusal(acting: &str) -> String {
    let scene = scene(acting);
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let (q, speeds) = (&scene.configuration, &scene.speeds);
    let rates = vec![0.0; speeds.len()];
    let mut needed = rates.clone();
    dynamics
        .inverse_dynamics(q, speeds, &rates, &mut needed)
        .expect("sizes fit");
    let refused = dynamics.pin_forces(1, q, speeds);
    refused.expect_err("it is not known").to_string()
}

#[test]
fn efforts_elsewhere_leave_it_open() {
    assert_eq!(
        refusal("ports.rod.effort = 1.0"),
        "an effort acts at port `rod` of joint `press`, of an input, a spring, a damper or a rotor, and none of the joint's pins moves as it does: where it acts, and so what the pins carry, is not known"
    );
}

#[test]
fn pins_that_are_missing_are_noticed() {
    let text = r#"
hamel = 1
name = "leg"
gravity = [0.0, -9.81, 0.0]
[[body]]
name = "leg"
parent = "world"
joint = { type = "unpinned", thigh = 0.4 }
bodies.thigh = { mass = 2.0, com = [0.2, 0.0, 0.0], inertia = [[0.01, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.02]] }
bodies.shank = { mass = 1.0, com = [0.2, 0.0, 0.0], inertia = [[0.01, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.02]] }
"#;
    let mut registry = hamel_joints::registry();
    registry
        .extend(hamel_downstream::entries())
        .expect("distinct names");
    let scene = Scene::parse(text, "leg.toml", &registry);
    let scene = scene.unwrap_or_else(|errors| panic!("{errors}"));
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let (q, none) = (&scene.configuration, [0.0; 2]);
    let (mut rates, mut needed) = (none, none);
    dynamics
        .forward_dynamics(q, &none, &none, &mut rates)
        .expect("regular");
    dynamics
        .inverse_dynamics(q, &none, &rates, &mut needed)
        .expect("sizes fit");
    let refused = dynamics
        .pin_forces(0, q, &none)
        .expect_err("the knee is missing");
    assert_eq!(
        refused.to_string(),
        "the pins of joint `leg` let its bodies move in 7 ways, and it has 2 degrees of freedom: pins are missing, or the linkage is at a dead point"
    );
}

/// A joint without pins, and one that is not there.
#[test]
fn only_pins_carry() {
    let scene = scene("");
    let dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let (q, speeds) = (&scene.configuration, &scene.speeds);
    assert!(
        dynamics
            .pin_forces(BOB, q, speeds)
            .expect("it is there")
            .is_empty()
    );
    assert!(dynamics.pin_forces(BOB + 1, q, speeds).is_err());
    assert!(dynamics.pin_forces(1, &q[1..], speeds).is_err());
}
