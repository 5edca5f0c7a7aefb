//! Energy over long runs at a fixed step.

use super::case::Case;
use super::plan::Plan;
use super::row::{self, Row, form_name};
use super::store::Store;
use super::watch::Watch;
use hamel::dynamics::Recursive;
use hamel::integrate::{Form, Method, Options, Scheme, Step, integrate, no_inputs};
use hamel::mechanism::Mechanism;
use hamel::registry::JointRegistry;
use hamel_console::output::Failure;
use hamel_scene::Scene;
use std::sync::Arc;
use std::time::Duration;

/// Steps a second of the motion's own time: what a user would take for these scenes.
const STEPS: f64 = 400.0;
/// Points a decade.
const DENSITY: f64 = 12.0;

/// Measures what the store has not.
///
/// # Errors
/// Scenes that cannot be built; a file that cannot be written.
pub fn measure(
    plan: &Plan,
    registry: &JointRegistry,
    machine: &str,
    store: &mut Store<row::Drift>,
    mut tick: impl FnMut(&str),
) -> Result<(), Failure> {
    for name in &plan.drift.scenes {
        for case in Case::chosen(&[(*name).to_owned()])? {
            let scene = case.description()?.build(registry)?;
            for &scheme in &plan.schemes {
                for &form in scheme.forms() {
                    tick(&format!("{name} {} drift", scheme.name()));
                    let empty = empty(plan, case.name, scheme, form, machine);
                    if store.find(&empty.key()).is_none() {
                        store.add(&follow(plan, &scene, scheme, form, &empty))?;
                    }
                }
            }
        }
    }
    Ok(())
}

/// How many runs there are, for the bar.
pub fn count(plan: &Plan) -> usize {
    let runs = plan.schemes.iter().map(|&scheme| scheme.forms().len());
    runs.sum::<usize>() * plan.drift.scenes.len()
}

fn empty(plan: &Plan, scene: &str, scheme: Scheme, form: Form, machine: &str) -> row::Drift {
    row::Drift {
        scene: scene.into(),
        form: form_name(form).into(),
        method: scheme.name().into(),
        step_s: 1.0 / STEPS,
        steps: 0,
        time_s: 0.0,
        drift: 0.0,
        failure: String::new(),
        budget: plan.budget_name.into(),
        machine: machine.into(),
    }
}

/// Total and kinetic energy, J.
fn energies(mechanism: &Mechanism, q: &[f64], speeds: &[f64]) -> Option<(f64, f64)> {
    let kinematics = mechanism.kinematics(q, speeds).ok()?;
    Some((kinematics.energy(), kinematics.kinetic_energy()))
}

/// The rows of one run: the largest error since the row before.
fn follow(
    plan: &Plan,
    scene: &Scene,
    scheme: Scheme,
    form: Form,
    empty: &row::Drift,
) -> Vec<row::Drift> {
    let mechanism = &scene.mechanism;
    let start = energies(mechanism, &scene.configuration, &scene.speeds);
    let Some((energy, kinetic)) = start else {
        return vec![];
    };
    let unit = energy.abs().max(kinetic);
    let limit = Duration::from_secs_f64(plan.drift.seconds);
    let clock = Watch::start();
    let mut rows: Vec<row::Drift> = Vec::new();
    let (mut next, mut worst) = (1.0, 0.0_f64);
    let mut observer = |step: &Step<'_>| {
        let found = energies(mechanism, step.configuration, step.speeds);
        let drift = found.map(|(found, _)| (found - energy).abs() / unit);
        let drift = drift.filter(|drift| drift.is_finite());
        worst = worst.max(drift.unwrap_or(f64::INFINITY));
        if step.number as f64 >= next {
            next = (next * 10.0_f64.powf(1.0 / DENSITY)).max(next + 1.0);
            rows.push(row::Drift {
                steps: step.number,
                time_s: step.time,
                drift: std::mem::take(&mut worst),
                ..empty.clone()
            });
        }
        clock.allows(limit, step)
    };
    let options = Options {
        form,
        method: Method::fixed(scheme, 1.0 / STEPS),
        t_end: plan.drift.steps as f64 / STEPS,
        samples: vec![],
    };
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let result = integrate(
        &mut dynamics,
        &scene.start(),
        &options,
        &mut no_inputs,
        &mut observer,
    );
    if let Err(error) = result {
        rows.push(row::Drift {
            failure: error.to_string(),
            ..rows.last().unwrap_or(empty).clone()
        });
    }
    rows
}
