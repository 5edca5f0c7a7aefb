//! Controllers, on the scenes that show them.

mod allocation;
mod computed_torque;
mod energy;
mod held;
mod path;
mod predictive;
mod regulator;
mod riccati;

use hamel::control::{Controller, Feedback};
use hamel::dynamics::Recursive;
use hamel::integrate::{Form, Method, Options, Scheme, Solution, Step, integrate, integrate_held};
use hamel_scene::Scene;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// As exact as the integrators get: what is left is rounding.
const EXACT: Method = Method::controlled(Scheme::Verner9, 1e-14);

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes")
}

fn text(name: &str) -> String {
    let path = scenes().join(format!("{name}.toml"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn scene(name: &str) -> Scene {
    parse(&text(name))
}

fn parse(text: &str) -> Scene {
    Scene::parse(text, "scene.toml", &hamel_joints::registry())
        .unwrap_or_else(|errors| panic!("{errors}"))
}

/// The controller that the scene has, for its own time.
fn controller(scene: &Scene) -> Box<dyn Controller> {
    let control = scene.control.as_ref().expect("the scene has a controller");
    let made = control.controller(&scene.mechanism, scene.settings.t_end);
    made.expect("it has been tried before")
}

/// A time, and a number for each of the controller's measures.
type Reading = (f64, Vec<f64>);

/// Moves the scene under its controller; returns the solution and what the controller measures at each step.
fn run(scene: &Scene, method: Method, t_end: f64) -> (Solution, Vec<Reading>) {
    let mut gauge = controller(scene);
    let mut readings = Vec::new();
    let mut values = vec![0.0; gauge.measures().len()];
    let solution = watch(scene, method, t_end, &mut |step| {
        let measured = gauge.measure(step.time, step.configuration, step.speeds, &mut values);
        measured.expect("sizes fit");
        readings.push((step.time, values.clone()));
    });
    (solution, readings)
}

/// Moves the scene under its controller, and shows each step to `see`.
fn watch(scene: &Scene, method: Method, t_end: f64, see: &mut dyn FnMut(&Step<'_>)) -> Solution {
    let mut controller = controller(scene);
    let mut feedback = Feedback::new(&mut *controller);
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let initial = scene.start();
    let options = Options {
        form: scene.settings.form,
        method,
        t_end,
        samples: Vec::new(),
    };
    let mut inputs = |t: f64, q: &[f64], v: &[f64], tau: &mut [f64]| feedback.fill(t, q, v, tau);
    let mut observer = |step: &Step<'_>| {
        see(step);
        ControlFlow::Continue(())
    };
    let solution = match scene.control.as_ref().and_then(|control| control.period) {
        None => integrate(
            &mut dynamics,
            &initial,
            &options,
            &mut inputs,
            &mut observer,
        ),
        Some(period) => {
            let (dynamics, inputs) = (&mut dynamics, &mut inputs);
            integrate_held(dynamics, &initial, &options, period, inputs, &mut observer)
        }
    };
    assert_eq!(feedback.failure(), None);
    solution.expect("the motion is smooth")
}

/// The largest absolute value of one measure.
fn largest(readings: &[Reading], measure: usize) -> f64 {
    readings
        .iter()
        .map(|(_, values)| values[measure].abs())
        .fold(0.0, f64::max)
}

/// The last value of one measure.
fn last(readings: &[Reading], measure: usize) -> f64 {
    readings.last().expect("steps").1[measure]
}

#[test]
fn scenes_of_all_forms_have_controllers() {
    let forms: Vec<Form> = ["panda7_tracking", "ball_pendulum_swing_up"]
        .map(|name| scene(name).settings.form)
        .to_vec();
    assert_eq!(forms, [Form::Lagrangian, Form::Hamiltonian]);
}
