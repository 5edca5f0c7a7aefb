//! The errors that are estimated of motions, beside those that they have.

use super::case::Reference;
use super::measure::{Failed, finite_errors, integrated};
use super::plan::Plan;
use super::row::{self, Row, form_name};
use super::score::Errors;
use super::store::Store;
use super::watch::Watch;
use hamel::integrate::{
    Form, GlobalError, Method, Options, Scheme, Statistics, integrate, no_inputs,
};
use hamel::registry::JointRegistry;
use hamel_console::output::Failure;
use hamel_scene::Scene;
use std::time::Duration;

/// Methods whose estimates are measured.
const SCHEMES: [Scheme; 4] = [
    Scheme::DormandPrince,
    Scheme::DormandPrince8,
    Scheme::Verner9,
    Scheme::Radau5,
];

/// Tolerances at which they are.
const TOLERANCES: [f64; 5] = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12];

/// A motion with its error, and what the estimate says of it.
struct Measured {
    errors: Errors,
    statistics: Statistics,
    estimate: GlobalError,
    seconds: f64,
    seconds_of_estimate: f64,
}

/// Measures what the store has not.
///
/// # Errors
/// Scenes or references that cannot be read; a file that cannot be written.
pub fn measure(
    plan: &Plan,
    registry: &JointRegistry,
    machine: &str,
    store: &mut Store<row::Estimate>,
    mut tick: impl FnMut(&str),
) -> Result<(), Failure> {
    for case in &plan.cases {
        let (scene, reference) = (case.description()?.build(registry), case.reference()?);
        for (scheme, form) in curves(plan) {
            tick(&format!("{} {} estimate", case.name, scheme.name()));
            for tolerance in TOLERANCES {
                let empty = row::Estimate {
                    scene: case.name.into(),
                    form: form_name(form).into(),
                    method: scheme.name().into(),
                    tolerance,
                    budget: plan.budget_name.into(),
                    machine: machine.into(),
                    ..row::Estimate::default()
                };
                if store.find(&empty.key()).is_some() {
                    continue;
                }
                let method = Method::controlled(scheme, tolerance);
                let measured = match &scene {
                    Ok(scene) => estimated(scene, &reference, (form, method), plan.budget.run),
                    Err(errors) => Err(Failed::at_once(&errors.to_string())),
                };
                store.add(&[filled(empty, measured)])?;
            }
        }
    }
    Ok(())
}

/// How many curves there are, for the bar.
pub fn count(plan: &Plan) -> usize {
    plan.cases.len() * curves(plan).count()
}

fn curves(plan: &Plan) -> impl Iterator<Item = (Scheme, Form)> {
    let schemes = SCHEMES.into_iter();
    let asked = schemes.filter(|scheme| plan.schemes.contains(scheme));
    asked.flat_map(|scheme| scheme.forms().iter().map(move |&form| (scheme, form)))
}

/// The motion of a scene by the tree, and the estimate of its error, as `hamel simulate` makes it.
fn estimated(
    scene: &Scene,
    reference: &Reference,
    (form, method): (Form, Method),
    limit: Duration,
) -> Result<Measured, Failed> {
    let mut dynamics = scene.settings.arithmetic.dynamics(&scene.mechanism);
    let mut of_companions = scene.settings.arithmetic.dynamics(&scene.mechanism);
    let start = scene.start();
    let options = Options {
        form,
        method,
        t_end: reference.end(),
        samples: reference.samples.iter().map(|sample| sample.t).collect(),
    };
    let watch = Watch::start();
    let (solution, seconds) = integrated(&mut *dynamics, &start, &options, (watch, limit))?;
    let errors = finite_errors(scene, reference, (&solution, seconds))?;
    let watch = Watch::start();
    let estimate = GlobalError::estimate(
        &mut *dynamics,
        &start,
        &options,
        &solution,
        &mut |start, options, observer| {
            let companion = &mut *of_companions;
            integrate(companion, start, options, &mut no_inputs, observer)
                .map_err(|error| error.to_string())
        },
    );
    Ok(Measured {
        errors,
        statistics: solution.statistics,
        estimate,
        seconds,
        seconds_of_estimate: watch.seconds(),
    })
}

fn filled(row: row::Estimate, measured: Result<Measured, Failed>) -> row::Estimate {
    match measured {
        Ok(Measured {
            errors,
            statistics,
            estimate,
            seconds,
            seconds_of_estimate,
        }) => row::Estimate {
            error_final: Some(errors.last),
            error_worst: Some(errors.worst),
            told_steps: Some(estimate.end.steps),
            told_rounding: Some(estimate.end.rounding),
            doubt: estimate
                .doubt
                .map_or(String::new(), |doubt| doubt.to_string()),
            evaluations: Some(statistics.evaluations),
            evaluations_of_estimate: Some(estimate.evaluations),
            seconds: Some(seconds),
            seconds_of_estimate: Some(seconds_of_estimate),
            ..row
        },
        Err(failed) => row::Estimate {
            failure: failed.reason,
            ..row
        },
    }
}
