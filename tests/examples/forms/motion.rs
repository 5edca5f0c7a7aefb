//! One motion of a scene, timed, and how far it is from another.

use hamel::dynamics::Recursive;
use hamel::integrate::{Form, Method, Options, Solution, State, Step, integrate, no_inputs};
use hamel::mechanism::Kinematics;
use hamel_scene::Scene;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

pub const FORMS: [Form; 2] = [Form::Lagrangian, Form::Hamiltonian];

/// More than any motion of which the end is wanted takes.
pub const MOST_STEPS: usize = 10_000_000;

/// A scene of the project, or one beside the references of motions.
pub fn scene(name: &str) -> Scene {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let file = format!("{name}.toml");
    let own = root.join("report").join(&file);
    let path: PathBuf = if own.exists() { own } else { root.join(&file) };
    Scene::load(path, &hamel_joints::registry()).unwrap_or_else(|errors| panic!("{errors}"))
}

/// A motion with the states at `samples`, and its run time, s; it ends before them if it takes more than `most_steps`.
pub fn run(
    scene: &Scene,
    form: Form,
    method: Method,
    samples: &[f64],
    most_steps: usize,
) -> (Solution, f64) {
    let initial = scene.start();
    let options = Options {
        form,
        method,
        t_end: samples.last().copied().expect("a sample"),
        samples: samples.to_vec(),
    };
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let mut observer = |step: &Step<'_>| match step.number < most_steps {
        true => ControlFlow::Continue(()),
        false => ControlFlow::Break(()),
    };
    let start = Instant::now();
    let solution = integrate(
        &mut dynamics,
        &initial,
        &options,
        &mut no_inputs,
        &mut observer,
    )
    .unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    (solution, start.elapsed().as_secs_f64())
}

pub fn kinematics(scene: &Scene, state: &State) -> Kinematics {
    let kinematics = scene
        .mechanism
        .kinematics(&state.configuration, &state.speeds);
    kinematics.expect("sizes fit")
}

/// Energy error of the last state: a part of the larger of the initial energy and kinetic energy.
pub fn energy_error(scene: &Scene, state: &State) -> f64 {
    let start = scene.start();
    let start = kinematics(scene, &start);
    let unit = start.energy().abs().max(start.kinetic_energy());
    (kinematics(scene, state).energy() - start.energy()).abs() / unit
}
