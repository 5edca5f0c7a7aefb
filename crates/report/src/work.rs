//! Work–precision: every scene with every method, at tolerances or steps from coarse to fine.

use super::case::{Case, Reference, accuracy};
use super::measure::{self, Failed, Point, Way};
use super::plan::{Plan, TOLERANCES};
use super::representation::Representation;
use super::row::{Cause, NOT_RUN, Row, Work, form_name};
use super::store::{Store, Stores};
use super::subject::{Implementation, Subject};
use hamel::integrate::{Form, Method, Scheme};
use hamel::registry::JointRegistry;
use hamel_console::output::Failure;
use hamel_scene::{SceneDescription, Settings};
use itertools::Itertools;

/// Steps of a method without step control, from that at which the scene is resolved coarsely to this power of two below it.
const HALVINGS: i32 = 9;

/// Runs in a row that were stopped for their time before finer ones are left out.
const SLOW: usize = 2;

/// What the accuracy of methods without step control is.
const STEP: &str = "step_s";

/// One curve to be measured.
#[derive(Clone, Copy, Debug)]
struct Curve {
    scene: &'static str,
    representation: Representation,
    implementation: Implementation,
    /// Absent for the one that is chosen.
    scheme: Option<Scheme>,
    form: Form,
}

impl Curve {
    fn method_name(&self) -> &'static str {
        self.scheme.map_or(Settings::AUTO, |scheme| scheme.name())
    }
}

/// Measures what the stores have not.
///
/// # Errors
/// Scenes or references that cannot be read; a file that cannot be written.
pub fn measure(
    plan: &Plan,
    registry: &JointRegistry,
    machine: &str,
    stores: &mut Stores,
    mut tick: impl FnMut(&str),
) -> Result<(), Failure> {
    for case in &plan.cases {
        let (description, reference) = (case.description()?, case.reference()?);
        let coarse = match begun_at(&stores.work, case, plan) {
            Some(step) => step,
            None => coarse_step(&description, &reference, registry, plan),
        };
        let mut subject: Option<Subject> = None;
        for curve in curves(plan, case, &description) {
            tick(&format!("{} {}", curve.scene, curve.method_name()));
            let kind = (curve.representation, curve.implementation);
            if subject.as_ref().is_none_or(|known| known.kind != kind) {
                // The one before goes first: its compiled equations make room for others.
                drop(subject.take());
            }
            let subject = subject
                .get_or_insert_with(|| Subject::new(curve.scene, &description, kind, registry));
            follow(plan, &curve, subject, (&reference, coarse), machine, stores)?;
        }
    }
    Ok(())
}

/// The points of one curve that are not known, from coarse to fine: what follows runs that were stopped would be stopped as well.
fn follow(
    plan: &Plan,
    curve: &Curve,
    subject: &mut Subject,
    (reference, coarse): (&Reference, f64),
    machine: &str,
    stores: &mut Stores,
) -> Result<(), Failure> {
    let mut slow = 0;
    for way in ways(curve.scheme, coarse) {
        let empty = row(plan, curve, way, reference, machine);
        if let Some(row) = stores.work.find(&empty.key()) {
            slow = if row.is_slow() { slow + 1 } else { 0 };
            continue;
        }
        let measured = match slow {
            SLOW.. => Err(not_run()),
            _ => match subject.parts(plan, machine, &mut stores.build)? {
                Ok(parts) => measure::point(parts, reference, curve.form, way, plan.budget),
                Err(failed) => Err(failed),
            },
        };
        match &measured {
            Err(failed) if failed.is_slow => slow += 1,
            _ => slow = 0,
        }
        stores.work.add(&[filled(empty, measured)])?;
    }
    Ok(())
}

/// How many curves there are, for the bar.
///
/// # Errors
/// Scenes that cannot be read.
pub fn count(plan: &Plan) -> Result<usize, Failure> {
    let counts = plan.cases.iter().map(|case| {
        let description = case.description()?;
        Ok(curves(plan, case, &description).len())
    });
    counts.sum()
}

/// Those of one representation and implementation one after the other: of compiled equations there is one set at a time.
fn curves(plan: &Plan, case: &Case, scene: &SceneDescription) -> Vec<Curve> {
    let representations = Representation::of(scene).into_iter();
    let implementations = [Implementation::Tree, Implementation::Compiled];
    let kinds = representations.cartesian_product(implementations);
    let curves = kinds
        .cartesian_product(&plan.schemes)
        .flat_map(|(kind, &scheme)| {
            let (representation, implementation) = kind;
            let forms = plan.forms_of(scheme, representation, implementation);
            forms.iter().map(move |&form| Curve {
                scene: case.name,
                representation,
                implementation,
                scheme: Some(scheme),
                form,
            })
        });
    // The choice does not depend on representation and implementation.
    let chosen = Representation::of(scene).first().map(|&representation| {
        let forms = Scheme::DormandPrince.forms().iter();
        forms.map(move |&form| Curve {
            scene: case.name,
            representation,
            implementation: Implementation::Tree,
            scheme: None,
            form,
        })
    });
    let chosen = chosen.filter(|_| plan.chooses).into_iter().flatten();
    chosen.chain(curves).collect()
}

/// A tolerance each, or a step each where the method has no step control or a low order.
fn ways(scheme: Option<Scheme>, coarse: f64) -> Vec<Way> {
    match scheme {
        None => TOLERANCES.map(Way::Chosen).to_vec(),
        // With a method of order 2 few tolerances are met in the time that a run has.
        Some(scheme) if scheme.has_estimate() && scheme.order() > 2 => TOLERANCES
            .map(|tol| Way::Method(Method::controlled(scheme, tol)))
            .to_vec(),
        Some(scheme) => (0..HALVINGS)
            .map(|i| Way::Method(Method::fixed(scheme, coarse * 0.5_f64.powi(i))))
            .collect(),
    }
}

/// The step at which the ladder of a scene began that has been measured in part; from another one its rungs would not be met again.
fn begun_at(store: &Store<Work>, case: &Case, plan: &Plan) -> Option<f64> {
    let steps = store
        .measured()
        .filter(|row| row.scene == case.name && row.knob == STEP && row.budget == plan.budget_name);
    steps.map(|row| row.accuracy).reduce(f64::max)
}

/// The mean step, s, with which step control resolves a scene to 1e-4: the longest over an explicit and an implicit method, rounded to a power of two.
fn coarse_step(
    description: &SceneDescription,
    reference: &Reference,
    registry: &JointRegistry,
    plan: &Plan,
) -> f64 {
    let Ok(scene) = description.build(registry) else {
        return reference.end();
    };
    let samples: Vec<f64> = reference.samples.iter().map(|sample| sample.t).collect();
    let steps = [Scheme::DormandPrince, Scheme::Radau5].map(|scheme| {
        let method = Method::controlled(scheme, 1e-4);
        let mut tree = scene.settings.arithmetic.dynamics(&scene.mechanism);
        let parts = (&scene, &mut *tree);
        let run = measure::run(
            parts,
            Form::Lagrangian,
            Way::Method(method),
            &samples,
            plan.budget.run,
        );
        run.map_or(0.0, |(solution, _)| {
            reference.end() / solution.statistics.steps as f64
        })
    });
    match steps.into_iter().fold(0.0, f64::max) {
        0.0 => reference.end() / 1024.0,
        step => step.log2().floor().exp2(),
    }
}

fn not_run() -> Failed {
    Failed {
        reason: format!("{NOT_RUN}: {SLOW} coarser ones were stopped"),
        seconds: 0.0,
        is_slow: true,
        cause: Cause::TooSlow,
    }
}

fn row(plan: &Plan, curve: &Curve, way: Way, reference: &Reference, machine: &str) -> Work {
    Work {
        scene: curve.scene.into(),
        form: form_name(curve.form).into(),
        method: curve.method_name().into(),
        representation: curve.representation.name().into(),
        implementation: curve.implementation.name().into(),
        knob: match way {
            Way::Method(Method::Fixed { .. }) => STEP.into(),
            _ => "tolerance".into(),
        },
        accuracy: match way {
            Way::Chosen(tolerance) => tolerance,
            Way::Method(method) => accuracy(&method),
        },
        error_final: None,
        error_worst: None,
        floor: reference.floor(),
        conditioning: reference.conditioning,
        steps: None,
        rejected: None,
        evaluations: None,
        jacobians: None,
        factorizations: None,
        repetitions: 0,
        seconds_least: None,
        seconds_median: None,
        seconds_spread: None,
        cause: None,
        failure: String::new(),
        budget: plan.budget_name.into(),
        machine: machine.into(),
    }
}

fn filled(row: Work, measured: Result<Point, Failed>) -> Work {
    match measured {
        Ok(point) => Work {
            error_final: Some(point.errors.last),
            error_worst: Some(point.errors.worst),
            steps: Some(point.statistics.steps),
            rejected: Some(point.statistics.rejected),
            evaluations: Some(point.statistics.evaluations),
            jacobians: Some(point.statistics.jacobians),
            factorizations: Some(point.statistics.factorizations),
            repetitions: point.times.repetitions,
            seconds_least: Some(point.times.least),
            seconds_median: Some(point.times.median),
            seconds_spread: Some(point.times.spread),
            ..row
        },
        Err(failed) => Work {
            seconds_median: (failed.seconds > 0.0).then_some(failed.seconds),
            cause: Some(failed.cause),
            failure: failed.reason,
            ..row
        },
    }
}
