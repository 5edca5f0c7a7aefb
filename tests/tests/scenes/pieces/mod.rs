//! Motions with dry friction and limits of joints, against closed forms: by pieces, with the times at which these end.

mod chains;
mod friction;
mod impacts;
mod loads;
mod refused;
mod stick_slip;
mod together;

use hamel::integrate::{
    Crossing, Form, IntegrateError, Integration, Method, Options, Scheme, Solution, State,
};
use hamel_scene::Scene;

/// What the closed forms are held to: tolerances of 1e-12 a step, some hundred steps.
const CLOSED: f64 = 1e-9;

const FORMS: [Form; 2] = [Form::Lagrangian, Form::Hamiltonian];

/// A scene of these bodies in this gravity.
fn scene(gravity: [f64; 3], rest: &str) -> Scene {
    let text = format!("hamel = 1\nname = \"pieces\"\ngravity = {gravity:?}\n{rest}");
    Scene::parse(&text, "pieces.toml", &hamel_joints::registry())
        .unwrap_or_else(|errors| panic!("{errors}"))
}

/// A body of 1 kg on a slide along the world's x axis, with what else is said of it.
fn slide(name: &str, parent: &str, mass: f64, rest: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\nmass = {mass:?}\n\
         inertia_xx_yy_zz_xy_xz_yz = [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]\n\
         joint = {{ type = \"prismatic\" }}\nat = {{ axis = [1.0, 0.0, 0.0] }}\n\
         body_at = {{ rotation_vector = [0.0, -1.5707963267948966, 0.0] }}\n{rest}\n"
    )
}

fn options(form: Form, method: Method, t_end: f64) -> Options {
    Options {
        form,
        method,
        t_end,
        samples: Vec::new(),
    }
}

fn try_run(scene: &Scene, options: &Options) -> Result<Solution, IntegrateError> {
    let mut dynamics = scene.settings.arithmetic.dynamics(&scene.mechanism);
    Integration::new(&mut *dynamics, &scene.start(), options).run()
}

fn run(scene: &Scene, options: &Options) -> Solution {
    try_run(scene, options).expect("the scene runs")
}

/// Order 9 to 1e-13 a step.
fn accurate() -> Method {
    Method::controlled(Scheme::Verner9, 1e-13)
}

/// What was told, and when.
fn told(events: &[Crossing]) -> Vec<(&str, f64)> {
    let told = events.iter();
    told.map(|event| (&*event.name, event.state.time)).collect()
}

/// The times at which this was told.
fn times_of(events: &[Crossing], name: &str) -> Vec<f64> {
    let own = events.iter().filter(|event| event.name == name);
    own.map(|event| event.state.time).collect()
}

fn assert_near(what: &str, found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs();
    println!("{what}: {error:e}");
    assert!(error <= tolerance, "{what}: {found} is not {expected}");
}

/// Kinetic and potential energy, J.
fn energy(scene: &Scene, state: &State) -> f64 {
    let kinematics = hamel_tests::scenes::kinematics(scene, state);
    kinematics.expect("sizes fit").energy()
}
