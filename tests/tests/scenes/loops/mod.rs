//! Robots whose loops `<loop>` and `<coupling>` close: linkages of the library written so, energy, derivatives, and the files of others.

mod acting;
mod ends;
mod extended;
mod kernels;
mod library;
mod posture;

use hamel::dynamics::{
    Dynamics, ForwardDerivatives, ForwardSecondDerivatives, Recursive, Reference,
};
use hamel::integrate::{Form, Method, Options, Scheme, State, integrate, no_inputs, no_observer};
use hamel::nalgebra::Vector3;
use hamel_scene::urdf::{self, Import};
use hamel_scene::{Located, Motion, Position, Scene, SceneDescription};
use std::path::Path;
use std::sync::Arc;

/// The robot of the tests of that name, with this gravity.
fn import(name: &str, gravity: [f64; 3]) -> Import {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/urdf/loops");
    let options = urdf::Options {
        gravity: Vector3::from(gravity),
        ..urdf::Options::default()
    };
    let import = urdf::load(folder.join(format!("{name}.urdf")), &options);
    import.unwrap_or_else(|errors| panic!("{errors}"))
}

fn build(scene: &SceneDescription) -> Scene {
    let built = scene.build(&hamel_joints::registry());
    built.unwrap_or_else(|errors| panic!("{errors}"))
}

/// Where joints stand at time 0, and how fast they move.
fn begin(scene: &mut SceneDescription, joints: &[(&str, Option<f64>, Option<f64>)]) {
    for (joint, position, rate) in joints {
        let mut bodies = scene.bodies.iter_mut();
        let body = bodies.find(|body| body.joint.name.value == *joint);
        let initial = &mut body.expect("a joint of that name").initial;
        if let Some(position) = position {
            initial.position = Position::Phi(Located::new(vec![*position], 0..0));
        }
        if let Some(rate) = rate {
            initial.motion = Motion::Speeds(Located::new(vec![*rate], 0..0));
        }
    }
}

/// All linkages, in motion.
fn all() -> Vec<(&'static str, Scene)> {
    let robot = |name, gravity, joints: &[_]| {
        let mut scene = import(name, gravity).scene;
        begin(&mut scene, joints);
        (name, build(&scene))
    };
    vec![
        robot(
            "four_bar",
            [0.0, -9.81, 0.0],
            &[
                ("a", Some(1.0), Some(6.0)),
                ("b", Some(-0.5), None),
                ("c", Some(1.6), None),
            ],
        ),
        robot(
            "slider_crank",
            [0.0, -9.81, 0.0],
            &[("a", Some(0.4), Some(5.0))],
        ),
        robot("rssr", [0.0, 3.0, -9.81], &[("a", None, Some(4.0))]),
        robot(
            "ankle",
            // It pulls the ends of the cranks away from where the linkage is singular.
            [-6.0, 0.5, 0.4],
            &[("left", None, Some(0.5)), ("right", None, Some(-0.3))],
        ),
        robot(
            "parallel_chains",
            [0.0, 9.81, 0.0],
            &[
                ("joint_1_1", None, Some(0.2)),
                ("joint_1_3", None, Some(0.5)),
            ],
        ),
    ]
}

fn energy(scene: &Scene, state: &State) -> f64 {
    let found = scene
        .mechanism
        .kinematics(&state.configuration, &state.speeds);
    found.expect("finite").energy()
}

/// Part of the largest kinetic energy: a thousand steps of 1e-12, in motions that do not part from their neighbours by more than some ten.
const ENERGY: f64 = 1e-10;

#[test]
fn energy_and_loops_are_kept_for_ten_seconds() {
    for (name, scene) in all() {
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let options = Options {
                form,
                method: Method::controlled(Scheme::Verner9, 1e-12),
                t_end: 10.0,
                samples: (1..=20).map(|n| 0.5 * f64::from(n)).collect(),
            };
            let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
            let start = scene.start();
            let (inputs, observer) = (&mut no_inputs, &mut no_observer);
            let solution = integrate(&mut dynamics, &start, &options, inputs, observer);
            let solution = solution.unwrap_or_else(|error| panic!("{name}: {error}"));
            let first = energy(&scene, &start);
            let kinetic = |state: &State| {
                let rest = State {
                    speeds: vec![0.0; state.speeds.len()],
                    ..state.clone()
                };
                energy(&scene, state) - energy(&scene, &rest)
            };
            let size = solution.samples.iter().map(kinetic).fold(0.0, f64::max);
            let drift = solution
                .samples
                .iter()
                .map(|state| (energy(&scene, state) - first).abs());
            let drift = drift.fold(0.0, f64::max) / size;
            eprintln!(
                "{name}, {form:?}: {drift:e} of the largest kinetic energy, {} steps",
                solution.statistics.steps
            );
            assert!(drift < ENERGY, "{name}, {form:?}: {drift:e}");
            for (_, body) in scene.mechanism.joints() {
                let own = solution.samples.iter();
                let residual = own.map(|state| {
                    body.joint()
                        .residual(body.configuration(&state.configuration))
                });
                let residual = residual.fold(0.0, f64::max);
                let states = solution
                    .samples
                    .iter()
                    .flat_map(|state| &state.configuration);
                let angle = states.fold(0.0_f64, |most, entry| entry.abs().max(most));
                // A few roundings of sums of terms of 1 m, of each of up to eight relations, and of the angles, which add up over turns.
                let allowed = 4e-15 + f64::EPSILON * angle;
                assert!(residual < allowed, "{name}: {residual:e}");
            }
        }
    }
}

/// Both forms, and derivatives by central differences.
#[test]
fn derivatives_are_those_of_differences() {
    for (name, scene) in all() {
        let mechanism = &scene.mechanism;
        let (q, v) = (&scene.configuration, &scene.speeds);
        let efforts: Vec<f64> = (0..v.len()).map(|k| 0.3 - 0.2 * k as f64).collect();
        let mut recursive = Recursive::new(Arc::clone(mechanism));
        let mut found = ForwardDerivatives::new(mechanism);
        recursive
            .forward_dynamics_derivatives(q, v, &efforts, &mut found)
            .expect("regular");
        let mut rates = |q: &[f64], v: &[f64]| {
            let mut rates = vec![0.0; v.len()];
            recursive
                .forward_dynamics(q, v, &efforts, &mut rates)
                .expect("regular");
            rates
        };
        let mut other = vec![0.0; v.len()];
        Reference::new(Arc::clone(mechanism))
            .forward_dynamics(q, v, &efforts, &mut other)
            .expect("regular");
        let size = found
            .rates()
            .iter()
            .fold(1.0, |most: f64, own| most.max(own.abs()));
        for (a, b) in found.rates().iter().zip(&other) {
            assert!((a - b).abs() < 1e-12 * size, "{name}: {a} {b}");
        }
        // Fourth order: errors of rounding over the step, 1e-12 of the size, and a few times that.
        const STEP: f64 = 2e-4;
        let mut difference = |at: &dyn Fn(f64) -> (Vec<f64>, Vec<f64>)| {
            let at = [-2.0, -1.0, 1.0, 2.0].map(|n| {
                let (q, v) = at(n * STEP);
                rates(&q, &v)
            });
            let entry =
                |i: usize| (8.0 * (at[2][i] - at[1][i]) - (at[3][i] - at[0][i])) / (12.0 * STEP);
            (0..v.len()).map(entry).collect::<Vec<f64>>()
        };
        for (k, _) in v.iter().enumerate() {
            let by_speed = difference(&|step| {
                let mut v = v.clone();
                v[k] += step;
                (q.clone(), v)
            });
            let by_place = difference(&|step| {
                let mut phi = vec![0.0; v.len()];
                phi[k] = step;
                let joints = mechanism.joints().map(|(_, body)| {
                    let mut moved = vec![0.0; body.ranges().configuration.len()];
                    let own = &phi[body.ranges().freedoms.clone()];
                    body.joint().retract(body.configuration(q), own, &mut moved);
                    moved
                });
                (joints.flatten().collect(), v.clone())
            });
            for i in 0..v.len() {
                let [place, speed] = [found.by_local().entry(i, k), found.by_speeds().entry(i, k)];
                let allowed = 1e-9 * (size + place.abs() + speed.abs());
                assert!(
                    (place - by_place[i]).abs() < allowed,
                    "{name}: {place} {}",
                    by_place[i]
                );
                assert!(
                    (speed - by_speed[i]).abs() < allowed,
                    "{name}: {speed} {}",
                    by_speed[i]
                );
            }
        }
    }
}

/// Q moved by ϕ.
fn moved(scene: &Scene, phi: &[f64]) -> Vec<f64> {
    let joints = scene.mechanism.joints().map(|(_, body)| {
        let mut moved = vec![0.0; body.ranges().configuration.len()];
        let (q, own) = (
            body.configuration(&scene.configuration),
            &phi[body.ranges().freedoms.clone()],
        );
        body.joint().retract(q, own, &mut moved);
        moved
    });
    joints.flatten().collect()
}

/// Second derivatives are symmetric, and those by speeds and by efforts are differences of the first ones; by ϕ as well, where ϕ̇ is v at every ϕ.
#[test]
fn second_derivatives_are_differences_of_first_ones() {
    // Fourth order, as above.
    const STEP: f64 = 2e-4;
    for (name, scene) in all() {
        let mechanism = &scene.mechanism;
        let speeds = &scene.speeds;
        let efforts: Vec<f64> = (0..speeds.len()).map(|k| 0.3 - 0.2 * k as f64).collect();
        let weights: Vec<f64> = (0..speeds.len()).map(|k| 0.7 + 0.4 * k as f64).collect();
        let mut dynamics = Recursive::new(Arc::clone(mechanism));
        let mut found = ForwardSecondDerivatives::new(mechanism);
        let q = &scene.configuration;
        let asked =
            dynamics.forward_dynamics_second_derivatives(q, speeds, &efforts, &weights, &mut found);
        asked.expect("regular");
        let hessian = found.hessian().matrix();
        let size = hessian.amax().max(1.0);
        let askew = (&hessian - hessian.transpose()).amax();
        assert!(askew < 1e-12 * size, "{name}: {askew:e} of {size:e}");
        let mut first = ForwardDerivatives::new(mechanism);
        let mut slopes = |q: &[f64], v: &[f64], tau: &[f64]| {
            let asked = dynamics.forward_dynamics_derivatives(q, v, tau, &mut first);
            asked.expect("regular");
            let parts = [first.by_local(), first.by_speeds(), first.by_efforts()];
            let columns = |part: &hamel::dynamics::Sensitivity| {
                part.matrix()
                    .tr_mul(&hamel::nalgebra::DVector::from_column_slice(&weights))
            };
            let parts = parts.map(columns);
            parts
                .iter()
                .flat_map(|part| part.iter().copied())
                .collect::<Vec<f64>>()
        };
        let freedoms = mechanism.layout().freedoms;
        let is_flat = |body: &hamel::mechanism::Body| {
            let structures = body.joint().structures();
            structures.velocity_map.is_constant() && structures.velocity_map_gradient.is_zero()
        };
        let flat = mechanism.joints().all(|(_, body)| is_flat(body));
        for k in 0..hessian.nrows() {
            if k < freedoms && !flat {
                continue;
            }
            let at = [-2.0, -1.0, 1.0, 2.0].map(|n| {
                let (mut phi, mut v, mut tau) =
                    (vec![0.0; freedoms], speeds.clone(), efforts.clone());
                let place = phi.iter_mut().chain(&mut v).chain(&mut tau).nth(k);
                *place.expect("a coordinate") += n * STEP;
                slopes(&moved(&scene, &phi), &v, &tau)
            });
            for i in 0..hessian.ncols() {
                let entry = (8.0 * (at[2][i] - at[1][i]) - (at[3][i] - at[0][i])) / (12.0 * STEP);
                let own = hessian[(k, i)];
                assert!(
                    (own - entry).abs() < 1e-8 * size,
                    "{name}: {own} {entry}, {size}"
                );
            }
        }
    }
}

/// What is imported reads back as the same mechanism.
#[test]
fn robots_with_loops_are_the_scenes_that_are_written_of_them() {
    for name in ["slider_crank", "rssr", "ankle", "parallel_chains"] {
        let import = import(name, [0.0, 1.0, -9.81]);
        let text = import.to_toml();
        assert!(text.contains("[[loop]]"), "{text}");
        let again = Scene::parse(&text, "imported.toml", &hamel_joints::registry());
        let again = again.unwrap_or_else(|errors| panic!("{errors}"));
        let built = build(&import.scene);
        let rates = [again, built].map(|scene| {
            let size = scene.speeds.len();
            let mut rates = vec![0.0; size];
            Recursive::new(Arc::clone(&scene.mechanism))
                .forward_dynamics(
                    &scene.configuration,
                    &vec![0.5; size],
                    &vec![0.2; size],
                    &mut rates,
                )
                .expect("regular");
            rates
        });
        let size = rates[1]
            .iter()
            .fold(1.0, |most: f64, own| most.max(own.abs()));
        for (a, b) in rates[0].iter().zip(&rates[1]) {
            assert!((a - b).abs() < 1e-13 * size, "{name}: {a} {b}");
        }
    }
}

/// As generalized_rbda writes files: which coordinates are independent, what the sums of angles are, and the rotor.
#[test]
fn a_file_of_urdf_plus_says_which_joints_move_independently() {
    let import = import("parallel_chains", [0.0, 9.81, 0.0]);
    let mut scene = import.scene.clone();
    begin(
        &mut scene,
        &[
            ("joint_1_1", Some(0.4), Some(0.7)),
            ("joint_1_2", Some(-0.2), Some(0.3)),
        ],
    );
    let built = build(&scene);
    assert!(
        built
            .notices
            .iter()
            .all(|notice| !notice.message.contains("independently")),
        "{:?}",
        built.notices
    );
    let joints: Vec<&str> = built
        .mechanism
        .joints()
        .map(|(_, body)| body.joint_name())
        .collect();
    assert_eq!(joints, ["position_1+coupling_2", "joint_1_3"]);
    assert_eq!(built.speeds, [0.7, 0.3, 0.0]);
    let joint = built.mechanism.bodies()[0].joint();
    let ports: Vec<&str> = joint.ports().iter().map(|port| port.name).collect();
    let values = built.mechanism.port_values(
        0,
        built.mechanism.bodies()[0].configuration(&built.configuration),
    );
    let values = values.expect("on the manifold");
    let y = |name: &str| values[ports.iter().position(|port| *port == name).expect("a port")];
    assert!((y("joint_1_1") - 0.4).abs() < 1e-15 && (y("joint_1_2") + 0.2).abs() < 1e-15);
    assert!((y("joint_1_1") + y("joint_1_2") - y("joint_2_1") - y("joint_2_2")).abs() < 1e-15);
}

#[test]
fn what_is_left_open_is_told() {
    let built = build(&import("rssr", [0.0, 0.0, -9.81]).scene);
    let told: Vec<String> = built.notices.iter().map(ToString::to_string).collect();
    assert_eq!(
        told[0],
        "note: the file does not say which joints move independently: `a`: loop `ball`"
    );
    assert!(
        told[1].starts_with("note: positions at time 0 are changed by up to 0.7"),
        "{told:?}"
    );
}
