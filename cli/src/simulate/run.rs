//! The run itself: integrate, write the trajectory on the way, tell the result.

use super::args::Args;
use super::choose;
use super::compile;
use super::control::{Loop, Outcome};
use super::csv::Trajectory;
use super::json::{self, Report, Statistics};
use super::page::Page;
use super::parquet::Parquet;
use super::plan::Plan;
use super::progress::Progress;
use super::sample::Sample;
use super::table::Summary;
use crate::output::Failure;
use hamel::dynamics::Dynamics;
use hamel::integrate::{IntegrateError, Integration, Observer, Solution, State, Step};
use hamel::mechanism::Mechanism;
use hamel::registry::JointRegistry;
use std::io::Write;
use std::ops::ControlFlow;
use std::time::Instant;

/// Simulates the scene of `args`.
///
/// # Errors
/// Mistakes in the scene or the options; a simulation that stops early; output that cannot be written.
pub fn run(args: &Args, registry: &JointRegistry) -> Result<(), Failure> {
    let plan = Plan::new(args, registry)?;
    let run = match args.compiled {
        true => {
            let mut equations = compile::equations(args, &plan)?;
            let run = simulate(&plan, &mut equations.dynamics, args.quiet)?;
            Run {
                equations: Some(compile::told(&equations)),
                ..run
            }
        }
        false => {
            let mut tree = plan.settings.arithmetic.dynamics(&plan.scene.mechanism);
            simulate(&plan, &mut *tree, args.quiet)?
        }
    };
    if args.json {
        return print_json(&plan, &run);
    }
    if args.quiet {
        return Ok(());
    }
    print_summary(&plan, &run)
}

/// What a simulation came to.
struct Run {
    /// How the equations were compiled, where they were.
    equations: Option<String>,
    solution: Solution,
    statistics: Statistics,
    outcome: Option<Outcome>,
    /// What the controller exerts at each sample; empty without one.
    efforts: Vec<Vec<f64>>,
}

fn simulate(plan: &Plan, dynamics: &mut dyn Dynamics, quiet: bool) -> Result<Run, Failure> {
    let control = Loop::new(plan)?;
    let mut recorder = Recorder::new(plan, quiet)?;
    let mut efforts: Vec<Vec<f64>> = Vec::new();
    let start = Instant::now();
    let result = move_on(plan, dynamics, control.as_ref(), &mut |step| {
        let mut tau = Vec::new();
        if let Some(control) = &control {
            control.see(step);
            if let Some(sample) = step.sample {
                tau = control.efforts(step);
                // Samples at one time are seen once.
                efforts.resize(sample + 1, tau.clone());
            }
        }
        recorder.see(step, &tau)
    });
    let run_time_s = start.elapsed().as_secs_f64();
    recorder.finish()?;
    let failure = control.as_ref().and_then(Loop::failure);
    let solution = result.map_err(|error| match failure {
        Some(cause) => stopped(plan, &cause),
        None => stopped(plan, &error),
    })?;
    let statistics = Statistics {
        steps: solution.statistics.steps,
        rejected: solution.statistics.rejected,
        evaluations: solution.statistics.evaluations,
        run_time_s,
    };
    Ok(Run {
        equations: None,
        solution,
        statistics,
        outcome: control.map(Loop::finish),
        efforts,
    })
}

/// Integrates, with feedback where there is a controller: at every instant, or held over its period.
fn move_on(
    plan: &Plan,
    dynamics: &mut dyn Dynamics,
    control: Option<&Loop>,
    observer: &mut Observer<'_>,
) -> Result<Solution, IntegrateError> {
    let (initial, options) = (plan.scene.start(), plan.options());
    let mut integration = Integration::new(dynamics, &initial, &options)
        .sampling(plan.settings.sampling)
        .observer(observer);
    for event in &plan.scene.events {
        integration = integration.event(event.event(&plan.scene.mechanism));
    }
    if let Some(control) = control {
        integration = integration.inputs(|time, q, speeds, efforts| {
            control.fill(time, q, speeds, efforts);
        });
        if let Some(period) = control.period() {
            integration = integration.held(period);
        }
    }
    integration.run()
}

fn stopped(plan: &Plan, error: &dyn std::fmt::Display) -> Failure {
    let files: Vec<String> = plan
        .files()
        .map(|path| path.display().to_string())
        .collect();
    Failure::Simulation(match files.as_slice() {
        [] => error.to_string(),
        files => format!(
            "{error} (the samples before that are in {})",
            files.join(", ")
        ),
    })
}

fn sample<'a>(
    mechanism: &'a Mechanism,
    state: &State,
    efforts: &[f64],
) -> Result<Sample<'a>, Failure> {
    let at = (&*state.configuration, &*state.speeds);
    Sample::new(mechanism, state.time, at, efforts)
        .map_err(|error| Failure::Simulation(error.to_string()))
}

/// Writes samples as they come, so that a simulation that stops leaves its trajectory up to there.
struct Recorder<'a> {
    mechanism: &'a Mechanism,
    trajectory: Option<Trajectory>,
    parquet: Option<Parquet>,
    page: Option<Page<'a>>,
    progress: Progress,
    failure: Option<Failure>,
}

impl<'a> Recorder<'a> {
    fn new(plan: &'a Plan, quiet: bool) -> Result<Self, Failure> {
        let mechanism: &Mechanism = &plan.scene.mechanism;
        Ok(Self {
            mechanism,
            trajectory: Trajectory::create(plan)?,
            parquet: Parquet::create(plan)?,
            page: Page::create(plan)?,
            progress: Progress::new(plan.settings.t_end, quiet),
            failure: None,
        })
    }

    /// Takes the end of a step, where it is a sample; `efforts` are the controller's, empty without one.
    fn see(&mut self, step: &Step<'_>, efforts: &[f64]) -> ControlFlow<()> {
        self.progress.at(step.time);
        if let Some(page) = &mut self.page
            && !step.is_within
        {
            page.step(step.time);
        }
        if step.sample.is_none() {
            return ControlFlow::Continue(());
        }
        match self.record(step, efforts) {
            Ok(()) => ControlFlow::Continue(()),
            Err(failure) => {
                self.failure = Some(failure);
                ControlFlow::Break(())
            }
        }
    }

    fn record(&mut self, step: &Step<'_>, efforts: &[f64]) -> Result<(), Failure> {
        if self.trajectory.is_none() && self.parquet.is_none() && self.page.is_none() {
            return Ok(());
        }
        let kinematics = self.mechanism.kinematics(step.configuration, step.speeds);
        let kinematics = kinematics.map_err(|error| Failure::Simulation(error.to_string()))?;
        let sample = Sample::of(self.mechanism, step.time, &kinematics, efforts);
        if let Some(trajectory) = &mut self.trajectory {
            trajectory.write(&sample)?;
        }
        if let Some(parquet) = &mut self.parquet {
            parquet.write(&sample, step, &kinematics)?;
        }
        if let Some(page) = &mut self.page {
            page.sample(step, &kinematics, efforts);
        }
        Ok(())
    }

    fn finish(self) -> Result<(), Failure> {
        self.progress.finish();
        let csv = self.trajectory.map_or(Ok(()), Trajectory::finish);
        let parquet = self.parquet.map_or(Ok(()), Parquet::finish);
        let page = self.page.map_or(Ok(()), Page::finish);
        self.failure.map_or(csv.and(parquet).and(page), Err)
    }
}

fn print_json(plan: &Plan, run: &Run) -> Result<(), Failure> {
    let samples = run.solution.samples.iter();
    let efforts = run.efforts.iter().map(Vec::as_slice);
    let efforts = efforts.chain(std::iter::repeat(&[][..]));
    let samples: Vec<Sample<'_>> = samples
        .zip(efforts)
        .map(|(state, efforts)| sample(&plan.scene.mechanism, state, efforts))
        .collect::<Result<_, _>>()?;
    let events: Vec<_> = run.solution.events.iter().map(json::Event::of).collect();
    json::print(&Report {
        scene: &plan.scene.name,
        form: plan.settings.form_name(),
        method: plan.settings.method.scheme().name(),
        reason: plan.reason.as_deref(),
        unresolved: choose::unresolved(plan, run.statistics.steps, run.solution.state.time)?,
        samples: &samples,
        events: &events,
        control: run.outcome.as_ref(),
        statistics: run.statistics,
    })
}

fn print_summary(plan: &Plan, run: &Run) -> Result<(), Failure> {
    let solution = &run.solution;
    let mechanism = &plan.scene.mechanism;
    let (first, last) = (plan.scene.start(), &solution.state);
    let kinetic = |state: &State| {
        let kinematics = mechanism.kinematics(&state.configuration, &state.speeds);
        kinematics.map(|kinematics| kinematics.kinetic_energy())
    };
    let states = solution.samples.iter().chain([&first, last]);
    let most = states
        .map(kinetic)
        .try_fold(0.0, |most: f64, energy| energy.map(|e| most.max(e)));
    let most_kinetic_energy = most.map_err(|error| Failure::Simulation(error.to_string()))?;
    let unresolved = choose::unresolved(plan, run.statistics.steps, run.solution.state.time)?;
    let summary = Summary {
        plan,
        equations: run.equations.as_deref(),
        unresolved: unresolved.as_deref(),
        first: &sample(mechanism, &first, &[])?,
        last: &sample(mechanism, last, &[])?,
        most_kinetic_energy,
        samples: solution.samples.len(),
        outcome: run.outcome.as_ref(),
        statistics: run.statistics,
        approaches: &solution.approaches,
        events: &solution.events,
    };
    write!(std::io::stdout().lock(), "{summary}").map_err(Failure::stdout)
}
