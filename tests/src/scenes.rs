//! The scenes of the project, and their motion.

use hamel::dynamics::{DynamicsError, Reference};
use hamel::integrate::{
    Form, IntegrateError, Method, Options, Solution, State, integrate, no_inputs, no_observer,
};
use hamel::mechanism::Kinematics;
use hamel_scene::{Scene, SceneDescription};
use std::fmt::Debug;
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes")
}

/// The scene `scenes/<name>.toml`.
///
/// # Panics
/// Where it does not load; the message shows the errors.
pub fn load(name: &str) -> Scene {
    let path = folder().join(format!("{name}.toml"));
    Scene::load(path, &hamel_joints::registry()).unwrap_or_else(|errors| panic!("{errors}"))
}

/// Every scene of the folder on which gravity alone acts, in the order of their names: a new file enters by itself. Not those with a
/// reference of their own in `scenes/report`, which the test `motions` holds to that, nor those of the test `coupled_scenes`.
///
/// # Panics
/// Where one does not load.
pub fn all() -> Vec<Scene> {
    let references = folder().join("report");
    let entries = std::fs::read_dir(folder()).expect("the scenes are beside this crate");
    let paths = entries.map(|entry| entry.expect("a folder entry").path());
    let scenes = paths.filter(|path| {
        path.extension()
            .is_some_and(|extension| extension == "toml")
    });
    let names = scenes.filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()));
    let mut names: Vec<String> = names.collect();
    names.retain(|name| !references.join(format!("{name}.json")).exists());
    names.sort();
    let mut scenes: Vec<Scene> = names.iter().map(|name| load(name)).collect();
    scenes.retain(|scene| {
        let mechanism = &scene.mechanism;
        mechanism.elements().is_empty()
            && mechanism.drives().is_empty()
            && mechanism.constraints().is_empty()
            && mechanism.frictions().is_empty()
            && mechanism.stops().is_empty()
            && !mechanism.changes_with_time()
            && scene.control.is_none()
    });
    scenes
}

/// The motion of a scene from its initial state, on the reference form and without inputs, to the last of the sample times.
///
/// # Errors
/// Those of [`integrate`].
pub fn run(
    scene: &Scene,
    form: Form,
    method: Method,
    samples: &[f64],
) -> Result<Solution, IntegrateError> {
    let initial = scene.start();
    let t_end = samples.last().copied().unwrap_or(0.0);
    let options = Options {
        form,
        method,
        t_end,
        samples: samples.to_vec(),
    };
    let mut dynamics = Reference::new(Arc::clone(&scene.mechanism));
    integrate(
        &mut dynamics,
        &initial,
        &options,
        &mut no_inputs,
        &mut no_observer,
    )
}

/// The bodies of a scene at one of its states.
///
/// # Errors
/// Where the state does not fit the scene.
pub fn kinematics(scene: &Scene, state: &State) -> Result<Kinematics, DynamicsError> {
    Ok(scene
        .mechanism
        .kinematics(&state.configuration, &state.speeds)?)
}

/// Rounding of a rotation that is written by its rotation vector, in units of the last place of 1.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The first thing that one description says and the other does not, both ways; numbers to rounding.
pub fn difference(a: &SceneDescription, b: &SceneDescription) -> Option<String> {
    let (a, b) = (said(a), said(b));
    let (mut left, mut right) = (a.lines(), b.lines());
    loop {
        match (left.next(), right.next()) {
            (None, None) => return None,
            (Some(x), Some(y)) if x == y || is_close(x, y) => {}
            (x, y) => return Some(format!("{x:?} against {y:?}")),
        }
    }
}

fn is_close(a: &str, b: &str) -> bool {
    let (key, other) = (a.rsplit_once(": "), b.rsplit_once(": "));
    let number = |line: &str, pair: Option<(&str, &str)>| {
        let value = pair.map_or(line, |(_, value)| value);
        value.trim().trim_end_matches(',').parse::<f64>()
    };
    match (number(a, key), number(b, other)) {
        (Ok(a), Ok(b)) if key.map(|k| k.0) == other.map(|k| k.0) => {
            (a - b).abs() <= ROUNDING * a.abs().max(1.0)
        }
        _ => false,
    }
}

/// All that a description says, without where in its text it stands.
fn said(scene: &SceneDescription) -> String {
    let parts: [&dyn Debug; 12] = [
        &scene.name,
        &scene.description,
        &scene.gravity,
        &scene.bodies,
        &scene.frames,
        &scene.springs,
        &scene.wrenches,
        &scene.constraints,
        &scene.events,
        &scene.shapes,
        &scene.controller,
        &scene.settings,
    ];
    let all = format!("{parts:#?}");
    let lines = all.lines();
    let said: Vec<&str> = lines
        .filter(|line| !line.trim_start().starts_with("span: "))
        .collect();
    said.join("\n")
}
