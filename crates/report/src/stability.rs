//! The largest step at which an undamped stiff spring stays bounded, over its stiffness.

use super::case::Case;
use super::measure::{self, Way};
use super::plan::Plan;
use super::row::{self, Row, form_name};
use super::store::Store;
use hamel::integrate::{Form, Method, Scheme};
use hamel::registry::JointRegistry;
use hamel_console::output::Failure;
use hamel_scene::{Motion, PerFreedom, Position, Scene, SceneDescription, SpringEnergy};
use std::time::Duration;

/// Steps that a motion must stay bounded for.
const STEPS: usize = 300;
/// Energies above this multiple of the first are not bounded.
const BOUND: f64 = 4.0;
/// Steps tried: from this part of 1/ω on, so many a decade.
const SMALLEST: f64 = 1e-1;
const LARGEST: f64 = 1e5;
const DENSITY: f64 = 8.0;
/// Half of which a step is divided further where it ends.
const BISECTIONS: usize = 4;

/// Measures what the store has not.
///
/// # Errors
/// Scenes that cannot be built; a file that cannot be written.
pub fn measure(
    plan: &Plan,
    registry: &JointRegistry,
    machine: &str,
    store: &mut Store<row::Stability>,
    mut tick: impl FnMut(&str),
) -> Result<(), Failure> {
    for &(name, inertia) in &plan.stiff {
        for case in Case::chosen(&[name.to_owned()])? {
            let description = case.description()?;
            for &scheme in &plan.schemes {
                tick(&format!("{name} {} stability", scheme.name()));
                for &stiffness in &plan.stiffnesses {
                    let form = scheme.forms()[0];
                    let frequency = (stiffness / inertia).sqrt();
                    let mut row = row::Stability {
                        scene: name.into(),
                        form: form_name(form).into(),
                        method: scheme.name().into(),
                        stiffness,
                        frequency,
                        step_s: None,
                        largest_tried_s: LARGEST / frequency,
                        machine: machine.into(),
                    };
                    if store.find(&row.key()).is_none() {
                        let scene = stiffened(&description, stiffness).build(registry)?;
                        row.step_s = largest(&scene, scheme, form, frequency);
                        store.add(&[row])?;
                    }
                }
            }
        }
    }
    Ok(())
}

/// How many curves there are, for the bar.
pub fn count(plan: &Plan) -> usize {
    plan.schemes.len() * plan.stiff.len()
}

/// The scene with another spring and without gravity, let go at rest a milliradian or so from the rest of the spring.
fn stiffened(description: &SceneDescription, stiffness: f64) -> SceneDescription {
    let mut scene = description.clone();
    scene.gravity *= 0.0;
    for body in &mut scene.bodies {
        if let Some(spring) = &mut body.forces.spring {
            spring.value.energy = match &spring.value.energy {
                SpringEnergy::Trace(_) => SpringEnergy::Trace(stiffness),
                _ => SpringEnergy::Diagonal(PerFreedom::All(stiffness)),
            };
        }
        if let Position::Pose(pose) = &body.initial.position {
            let span = pose.span.clone();
            let phi = hamel_scene::Located {
                value: vec![1e-3, -5e-4, 7e-4],
                span,
            };
            body.initial.position = Position::Phi(phi);
        }
        body.initial.motion = Motion::Rest;
    }
    scene
}

/// The largest stable step, s, below the first that is not; none where all are.
fn largest(scene: &Scene, scheme: Scheme, form: Form, frequency: f64) -> Option<f64> {
    let is_stable = |step: f64| stays(scene, scheme, form, step / frequency);
    let mut stable = 0.0;
    let mut step = SMALLEST;
    while step <= LARGEST {
        if !is_stable(step) {
            return Some(between(stable, step, is_stable) / frequency);
        }
        stable = step;
        step *= 10.0_f64.powf(1.0 / DENSITY);
    }
    None
}

fn between(mut stable: f64, mut unstable: f64, is_stable: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (stable + unstable);
        match is_stable(middle) {
            true => stable = middle,
            false => unstable = middle,
        }
    }
    stable
}

/// Whether the energy is bounded over all steps of this length, s.
fn stays(scene: &Scene, scheme: Scheme, form: Form, dt: f64) -> bool {
    let energy = |q: &[f64], speeds: &[f64]| {
        let kinematics = scene.mechanism.kinematics(q, speeds).ok();
        kinematics.map_or(f64::INFINITY, |kinematics| kinematics.energy())
    };
    let start = energy(&scene.configuration, &scene.speeds);
    let end = dt * STEPS as f64;
    let samples: Vec<f64> = (1..=4).map(|i| 0.25 * f64::from(i) * end).collect();
    let limit = Duration::from_secs(5);
    let mut tree = scene.settings.arithmetic.dynamics(&scene.mechanism);
    let method = Method::fixed(scheme, dt);
    let run = measure::run(
        (scene, &mut *tree),
        form,
        Way::Method(method),
        &samples,
        limit,
    );
    run.is_ok_and(|(solution, _)| {
        let mut states = solution.samples.iter();
        states.all(|state| energy(&state.configuration, &state.speeds) <= BOUND * start)
    })
}
