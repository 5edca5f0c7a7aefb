//! What methods of integration owe to their tolerance and to a scene, on scenes whose motions are known.

mod attitudes;
mod choice;
mod energy;
mod forms;
mod stiff;
mod tolerance;

use super::motions::{errors, list, number};
use hamel::integrate::{
    Form, IntegrateError, Method, Options, State, Statistics, Step, integrate, no_inputs,
};
use hamel_scene::Scene;
use serde_json::Value;
use std::ops::ControlFlow;

/// Multiple of what the tolerance, grown as the motion grows errors, or the floor allows.
const ALLOWED: f64 = 10.0;
/// Above so many floors rounding has no part in an error.
const CLEAR: f64 = 100.0;

/// A motion that took this many steps is of no use to the sweep.
const MOST_STEPS: usize = 400_000;

/// One run to all samples of a reference.
struct Run {
    error: f64,
    statistics: Statistics,
}

/// Runs a scene; none where it takes more than the most steps.
fn run(
    scene: &Scene,
    reference: &Value,
    form: Form,
    method: Method,
) -> Result<Option<Run>, IntegrateError> {
    let samples = list(&reference["samples"]);
    let times: Vec<f64> = samples.iter().map(|sample| number(&sample["t"])).collect();
    let initial = scene.start();
    let options = Options {
        form,
        method,
        t_end: times.last().copied().expect("a sample"),
        samples: times,
    };
    let mut observer = |step: &Step<'_>| match step.number < MOST_STEPS {
        true => ControlFlow::Continue(()),
        false => ControlFlow::Break(()),
    };
    let mut dynamics = scene.settings.arithmetic.dynamics(&scene.mechanism);
    let solution = integrate(
        &mut *dynamics,
        &initial,
        &options,
        &mut no_inputs,
        &mut observer,
    )?;
    let found = solution.samples.iter().zip(samples);
    let error = found
        .map(|(state, sample)| distance(scene, state, list(&reference["bodies"]), sample))
        .fold(0.0, larger);
    Ok((!solution.stopped).then_some(Run {
        error,
        statistics: solution.statistics,
    }))
}

/// The larger one, NaN above all.
fn larger(a: f64, b: f64) -> f64 {
    if b <= a { a } else { b }
}

/// The largest error over the bodies.
fn distance(scene: &Scene, state: &State, names: &[Value], sample: &Value) -> f64 {
    let found = scene
        .mechanism
        .kinematics(&state.configuration, &state.speeds)
        .expect("sizes fit");
    let bodies = names.iter().zip(list(&sample["bodies"]));
    let errors = bodies.flat_map(|(name, expected)| {
        let mut all = scene.mechanism.bodies().iter();
        let index = all.position(|body| Some(body.name()) == name.as_str());
        errors(
            &found.bodies[index.expect("the scene has the body")],
            expected,
        )
    });
    errors.fold(0.0, larger)
}

fn completed(run: Result<Option<Run>, IntegrateError>, what: &str) -> Run {
    run.unwrap_or_else(|error| panic!("{what}: {error}"))
        .unwrap_or_else(|| panic!("{what}: too many steps"))
}
