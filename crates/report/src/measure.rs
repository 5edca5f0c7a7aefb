//! One run, timed, with its error.

use super::case::Reference;
use super::row::{Cause, STOPPED};
use super::score::{Errors, errors};
use super::watch::Watch;
use hamel::dynamics::Dynamics;
use hamel::integrate::{
    Form, IntegrateError, Method, Options, Solution, State, Statistics, Step, integrate, no_inputs,
};
use hamel_scene::{Company, Scene, Settings};
use std::time::Duration;

/// How long and how often, by the time of the thread.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// A run that takes longer is stopped, and fails.
    pub run: Duration,
    /// Runs end when this has been spent on a point…
    pub point: Duration,
    /// …or when they are so many.
    pub repetitions: usize,
}

impl Budget {
    /// For figures that are to be reported.
    pub const FULL: Self = Self {
        run: Duration::from_millis(500),
        point: Duration::from_millis(30),
        repetitions: 30,
    };
    /// For a first look.
    pub const SHORT: Self = Self {
        run: Duration::from_millis(100),
        point: Duration::from_millis(10),
        repetitions: 30,
    };
}

/// Run times of one point, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times {
    /// How many runs.
    pub repetitions: usize,
    /// The least.
    pub least: f64,
    /// In the middle.
    pub median: f64,
    /// Between the first and the third quarter.
    pub spread: f64,
}

/// How a motion is integrated.
#[derive(Clone, Copy, Debug)]
pub enum Way {
    /// By this method.
    Method(Method),
    /// By the one that is chosen for the scene and this tolerance; choosing belongs to the run.
    Chosen(f64),
}

/// What a point of a diagram is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Against the reference.
    pub errors: Errors,
    /// The work of one run.
    pub statistics: Statistics,
    /// How long it took.
    pub times: Times,
}

/// A run that did not come to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Failed {
    /// Why.
    pub reason: String,
    /// How long it took to fail, s.
    pub seconds: f64,
    /// Whether it was stopped for the time that it took.
    pub is_slow: bool,
    /// Whether it would have come to its end.
    pub cause: Cause,
}

impl Failed {
    /// What was not even begun, for the first line of a reason.
    pub fn at_once(reason: &str) -> Self {
        Self {
            reason: reason.lines().next().unwrap_or_default().to_owned(),
            seconds: 0.0,
            is_slow: false,
            cause: Cause::Cannot,
        }
    }
}

/// The motion of a scene to the samples of its reference, as often as the budget says.
pub fn point(
    (scene, dynamics): (&Scene, &mut (dyn Dynamics + '_)),
    reference: &Reference,
    form: Form,
    way: Way,
    budget: Budget,
) -> Result<Point, Failed> {
    let samples: Vec<f64> = reference.samples.iter().map(|sample| sample.t).collect();
    let start = Watch::start();
    let (solution, first) = run((scene, dynamics), form, way, &samples, budget.run)?;
    let errors = finite_errors(scene, reference, (&solution, first))?;
    let mut seconds = vec![first];
    while seconds.len() < budget.repetitions && start.elapsed() < budget.point {
        seconds.push(run((scene, dynamics), form, way, &samples, budget.run)?.1);
    }
    Ok(Point {
        errors,
        statistics: solution.statistics,
        times: times(seconds),
    })
}

/// The errors of a motion that took so many seconds.
///
/// # Errors
/// A motion that is not finite.
pub fn finite_errors(
    scene: &Scene,
    reference: &Reference,
    (solution, seconds): (&Solution, f64),
) -> Result<Errors, Failed> {
    let errors = errors(&scene.mechanism, reference, solution);
    let errors = errors.filter(|errors| errors.worst.is_finite());
    errors.ok_or_else(|| Failed {
        reason: "the result is not finite".into(),
        seconds,
        is_slow: false,
        cause: Cause::Cannot,
    })
}

fn times(mut seconds: Vec<f64>) -> Times {
    seconds.sort_by(f64::total_cmp);
    let at = |part: f64| seconds[((seconds.len() - 1) as f64 * part).round() as usize];
    Times {
        repetitions: seconds.len(),
        least: at(0.0),
        median: at(0.5),
        spread: at(0.75) - at(0.25),
    }
}

/// The method of a run to the time `t_end`, s.
fn method(scene: &Scene, start: &State, way: Way, t_end: f64) -> Result<Method, Failed> {
    let tolerance = match way {
        Way::Method(method) => return Ok(method),
        Way::Chosen(tolerance) => tolerance,
    };
    let settings = Settings {
        t_end,
        ..Settings::default()
    };
    let settings = settings.with_tolerance(tolerance);
    let chosen = scene.choose_method(&settings, start, Company::default());
    let chosen = chosen.map_err(|error| Failed::at_once(&error.to_string()))?;
    Ok(chosen.0)
}

/// One run to the last of the sample times, and its run time, s: the integration, with the choice of its method, without construction.
pub fn run(
    (scene, dynamics): (&Scene, &mut (dyn Dynamics + '_)),
    form: Form,
    way: Way,
    samples: &[f64],
    limit: Duration,
) -> Result<(Solution, f64), Failed> {
    let initial = scene.start();
    let t_end = samples.last().copied().unwrap_or(0.0);
    let start = Watch::start();
    let options = Options {
        form,
        method: method(scene, &initial, way, t_end)?,
        t_end,
        samples: samples.to_vec(),
    };
    integrated(dynamics, &initial, &options, (start, limit))
}

/// The motion of these options, stopped where the time since `start` exceeds the limit, and that time, s.
pub fn integrated(
    dynamics: &mut dyn Dynamics,
    initial: &State,
    options: &Options,
    (start, limit): (Watch, Duration),
) -> Result<(Solution, f64), Failed> {
    let mut observer = |step: &Step<'_>| start.allows(limit, step);
    let result = integrate(dynamics, initial, options, &mut no_inputs, &mut observer);
    let seconds = start.seconds();
    match result {
        Ok(solution) if !solution.stopped => Ok((solution, seconds)),
        Ok(solution) => Err(Failed {
            reason: format!(
                "{STOPPED} at {:.3e} of {:.3e} s after {:.2} s of run time and {} steps",
                solution.state.time,
                options.t_end,
                limit.as_secs_f64(),
                solution.statistics.steps
            ),
            seconds,
            is_slow: true,
            cause: Cause::TooSlow,
        }),
        Err(error) => Err(Failed {
            reason: error.to_string(),
            seconds,
            is_slow: false,
            cause: match error {
                IntegrateError::Hopeless { .. } => Cause::TooSlow,
                _ => Cause::Cannot,
            },
        }),
    }
}
