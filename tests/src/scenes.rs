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
/// reference of their own in `data/motions`, which the test `motions` holds to that, nor those of the test `coupled_scenes`.
///
/// # Panics
/// Where one does not load.
pub fn all() -> Vec<Scene> {
    let references = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/motions");
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
    let initial = State {
        time: 0.0,
        configuration: scene.configuration.clone(),
        speeds: scene.speeds.clone(),
    };
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

/// All that a description says, without where in its text it stands.
pub fn said(scene: &SceneDescription) -> String {
    let SceneDescription {
        name,
        description,
        gravity,
        bodies,
        frames,
        springs,
        wrenches,
        constraints,
        shapes,
        controller,
        settings,
        ..
    } = scene;
    let parts: [&dyn Debug; 11] = [
        name,
        description,
        gravity,
        bodies,
        frames,
        springs,
        wrenches,
        constraints,
        shapes,
        controller,
        settings,
    ];
    let all = format!("{parts:#?}");
    let lines = all.lines();
    let said: Vec<&str> = lines
        .filter(|line| !line.trim_start().starts_with("span: "))
        .collect();
    said.join("\n")
}
