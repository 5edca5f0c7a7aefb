//! The run itself: integrate, write the trajectory on the way, tell the result.

use super::args::Args;
use super::columns::{Columns, JsonSample, Moment, Turns};
use super::compile;
use super::control::{Loop, Outcome};
use super::csv::Trajectory;
use super::json::{self, Report, Statistics};
use super::page::Page;
use super::parquet::Parquet;
use super::picture::Picture;
use super::plan::Plan;
use super::progress::Progress;
use super::sample;
use super::table::Summary;
use super::unresolved;
use hamel::dynamics::Dynamics;
use hamel::integrate::{IntegrateError, Integration, Observer, Solution, State, Step};
use hamel::mechanism::{Kinematics, Mechanism, StateError};
use hamel::registry::JointRegistry;
use hamel::shown::Number;
use hamel_console::interrupt::{self, Heed};
use hamel_console::output::{self, Failure};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// An interrupted simulation ends at the next sample; where that takes longer, at the next step.
const PATIENCE: Duration = Duration::from_secs(1);

/// Simulates the scene of `args`.
///
/// # Errors
/// Mistakes in the scene or the options; a simulation that stops early or is interrupted; output that cannot be written.
pub fn run(args: &Args, registry: &JointRegistry) -> Result<(), Failure> {
    let plan = Plan::new(args, registry)?;
    let columns = Columns::new(&plan);
    let run = match args.compiled {
        true => {
            let mut equations = compile::equations(args, &plan)?;
            let run = simulate(&plan, &columns, &mut equations.dynamics, args.quiet)?;
            Run {
                equations: Some(compile::told(&equations)),
                ..run
            }
        }
        false => {
            let mut tree = plan.settings.arithmetic.dynamics(&plan.scene.mechanism);
            simulate(&plan, &columns, &mut *tree, args.quiet)?
        }
    };
    match (args.json, args.quiet) {
        (true, _) => print_json(&plan, &columns, &run)?,
        (false, true) => {}
        (false, false) => print_summary(&plan, &run)?,
    }
    match run.is_interrupted {
        true => Err(interrupted(&plan, &run.solution)),
        false => Ok(()),
    }
}

/// What is told of a simulation that the user has ended.
fn interrupted(plan: &Plan, solution: &Solution) -> Failure {
    let (time, end) = (solution.state.time, plan.settings.t_end);
    let files = match solution.samples.len() {
        0 => String::from(", before the first sample: no file was written"),
        count => match plan.files().map(|path| path.display().to_string()) {
            files if plan.has_files() => {
                let files: Vec<String> = files.collect();
                let samples = match count {
                    1 => String::from("; the sample until then is"),
                    _ => format!("; the {count} samples until then are"),
                };
                format!("{samples} in {}", files.join(", "))
            }
            _ => String::new(),
        },
    };
    Failure::Interrupted(format!(
        "the simulation ended at {time:?} s, not at {end:?} s{files}"
    ))
}

/// What a simulation came to.
struct Run {
    /// How the equations were compiled, where they were.
    equations: Option<String>,
    solution: Solution,
    statistics: Statistics,
    outcome: Option<Outcome>,
    /// The numbers of each sample, where JSON is asked for.
    rows: Vec<Vec<f64>>,
    /// Whether the user ended it.
    is_interrupted: bool,
}

fn simulate(
    plan: &Plan,
    columns: &Columns<'_>,
    dynamics: &mut dyn Dynamics,
    quiet: bool,
) -> Result<Run, Failure> {
    let control = Loop::new(plan)?;
    let mut recorder = Recorder::new(plan, columns, quiet);
    let heed = Heed::new();
    let start = Instant::now();
    let result = move_on(plan, dynamics, control.as_ref(), &mut |step| {
        let mut tau = Vec::new();
        if let Some(control) = &control {
            control.see(step);
            if step.sample.is_some() {
                tau = control.efforts(step);
            }
        }
        recorder.see(step, &tau)
    });
    let run_time_s = start.elapsed().as_secs_f64();
    let rows = std::mem::take(&mut recorder.rows);
    let recorded = recorder.finish()?;
    drop(heed);
    let failure = control.as_ref().and_then(Loop::failure);
    let solution = result.map_err(|error| match failure {
        Some(cause) => stopped(plan, recorded, &cause),
        None => stopped(plan, recorded, &error),
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
        rows,
        is_interrupted: recorded.is_interrupted,
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

fn stopped(plan: &Plan, recorded: Recorded, error: &dyn std::fmt::Display) -> Failure {
    let files: Vec<String> = plan
        .files()
        .map(|path| path.display().to_string())
        .collect();
    Failure::Simulation(match files.as_slice() {
        files if recorded.has_files && !files.is_empty() => format!(
            "{error} (the samples before that are in {})",
            files.join(", ")
        ),
        _ => error.to_string(),
    })
}

fn kinematics(mechanism: &Mechanism, state: &State) -> Result<Kinematics, Failure> {
    let at = (&*state.configuration, &*state.speeds);
    sample::kinematics(mechanism, at).map_err(|error| without_value(state.time, &error))
}

/// The failure of a sample that cannot be told.
fn without_value(time: f64, error: &StateError) -> Failure {
    Failure::Simulation(format!("at {} s: {error}", Number(time)))
}

/// Writes samples as they come, so that a simulation that stops leaves its trajectory up to there.
struct Recorder<'a> {
    plan: &'a Plan,
    columns: &'a Columns<'a>,
    turns: Turns,
    mechanism: &'a Mechanism,
    /// For JSON, which is printed at the end.
    rows: Vec<Vec<f64>>,
    /// Absent before the first step is shown, by when options, scene, first state and method have been accepted.
    files: Option<Files<'a>>,
    has_samples: bool,
    progress: Progress,
    failure: Option<Failure>,
    /// When an interrupt was seen.
    interrupted: Option<Instant>,
    is_interrupted: bool,
}

/// Those that are asked for.
struct Files<'a> {
    trajectory: Option<Trajectory<'a>>,
    parquet: Option<Parquet<'a>>,
    page: Option<Page<'a>>,
    picture: Option<Picture<'a>>,
}

/// What a recorder leaves.
#[derive(Clone, Copy)]
struct Recorded {
    /// Whether the files were written: there was a sample.
    has_files: bool,
    is_interrupted: bool,
}

impl<'a> Files<'a> {
    fn create(plan: &'a Plan, columns: &Columns<'_>) -> Result<Self, Failure> {
        Ok(Self {
            trajectory: Trajectory::create(plan, columns)?,
            parquet: Parquet::create(plan, columns)?,
            page: Page::create(plan)?,
            picture: Picture::create(plan)?,
        })
    }

    /// Takes a row of the columns.
    fn record(&mut self, row: &[f64]) -> Result<(), Failure> {
        if let Some(trajectory) = &mut self.trajectory {
            trajectory.write(row)?;
        }
        if let Some(parquet) = &mut self.parquet {
            parquet.write(row)?;
        }
        Ok(())
    }

    fn finish(self) -> Result<(), Failure> {
        let csv = self.trajectory.map_or(Ok(()), Trajectory::finish);
        let parquet = self.parquet.map_or(Ok(()), Parquet::finish);
        let page = self.page.map_or(Ok(()), Page::finish);
        let picture = self.picture.map_or(Ok(()), Picture::finish);
        csv.and(parquet).and(page).and(picture)
    }
}

impl<'a> Recorder<'a> {
    fn new(plan: &'a Plan, columns: &'a Columns<'a>, quiet: bool) -> Self {
        Self {
            plan,
            columns,
            turns: columns.turns(),
            mechanism: &plan.scene.mechanism,
            rows: Vec::new(),
            files: None,
            has_samples: false,
            progress: Progress::new(plan.settings.t_end, quiet),
            failure: None,
            interrupted: None,
            is_interrupted: false,
        }
    }

    /// Takes the end of a step, where it is a sample; `efforts` are the controller's, empty without one.
    fn see(&mut self, step: &Step<'_>, efforts: &[f64]) -> ControlFlow<()> {
        self.progress.at(step.time);
        let seen = self.take(step, efforts);
        if let Err(failure) = seen {
            self.failure = Some(failure);
            return ControlFlow::Break(());
        }
        match self.is_to_end(step) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    /// Takes it into the files, which the first step begins.
    fn take(&mut self, step: &Step<'_>, efforts: &[f64]) -> Result<(), Failure> {
        let files = match &mut self.files {
            Some(files) => files,
            none => none.insert(Files::create(self.plan, self.columns)?),
        };
        self.turns.follow(self.mechanism, step);
        if let Some(page) = &mut files.page
            && !step.is_within
        {
            page.step(step.time);
        }
        let Some(sample) = step.sample else {
            return Ok(());
        };
        let at = (step.configuration, step.speeds);
        let found = sample::kinematics(self.mechanism, at);
        let found = found.map_err(|error| without_value(step.time, &error))?;
        if self.plan.has_rows() {
            let moment = Moment::of(step, &found, efforts, &self.turns);
            let row = self.columns.row(&moment);
            files.record(&row)?;
            if self.plan.json {
                // Samples at one time are seen once.
                self.rows.resize(sample + 1, row);
            }
        }
        if let Some(page) = &mut files.page {
            page.sample(step, &found, efforts);
        }
        if let Some(picture) = &mut files.picture {
            picture.sample(step.time, &found);
        }
        self.has_samples = true;
        Ok(())
    }

    /// Whether the user ends the simulation here.
    fn is_to_end(&mut self, step: &Step<'_>) -> bool {
        if !interrupt::is_requested() {
            return false;
        }
        let since = *self.interrupted.get_or_insert_with(Instant::now);
        // A motion that is at its end was not cut short.
        let is_over = step.time >= self.plan.settings.t_end;
        let is_late = since.elapsed() > PATIENCE;
        self.is_interrupted = !is_over && (step.sample.is_some() || is_late);
        self.is_interrupted
    }

    /// Finishes the files, unless there is no sample or they cannot be written: then what they would replace stays.
    fn finish(self) -> Result<Recorded, Failure> {
        self.progress.finish();
        let is_written = !matches!(self.failure, Some(Failure::Write { .. }));
        let files = self.files.filter(|_| self.has_samples && is_written);
        let recorded = Recorded {
            has_files: files.is_some(),
            is_interrupted: self.is_interrupted,
        };
        files.map_or(Ok(()), Files::finish)?;
        match self.failure {
            None => Ok(recorded),
            Some(Failure::Simulation(cause)) => Err(stopped(self.plan, recorded, &cause)),
            Some(failure) => Err(failure),
        }
    }
}

fn print_json(plan: &Plan, columns: &Columns<'_>, run: &Run) -> Result<(), Failure> {
    let rows = run.rows.iter();
    let samples: Vec<_> = rows.map(|row| JsonSample { columns, row }).collect();
    let events: Vec<_> = run.solution.events.iter().map(json::Event::of).collect();
    json::print(&Report {
        scene: &plan.scene.name,
        form: plan.settings.form_name(),
        method: plan.settings.method.scheme().name(),
        reason: plan.reason.as_deref(),
        unresolved: unresolved::unresolved(plan, run.statistics.steps, run.solution.state.time)?,
        columns: columns.list(),
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
    let unresolved = unresolved::unresolved(plan, run.statistics.steps, run.solution.state.time)?;
    let summary = Summary {
        plan,
        equations: run.equations.as_deref(),
        unresolved: unresolved.as_deref(),
        start_energy: kinematics(mechanism, &first)?.energy(),
        end: &kinematics(mechanism, last)?,
        time: last.time,
        most_kinetic_energy,
        samples: solution.samples.len(),
        outcome: run.outcome.as_ref(),
        statistics: run.statistics,
        approaches: &solution.approaches,
        events: &solution.events,
    };
    output::print(&summary.to_string())
}
