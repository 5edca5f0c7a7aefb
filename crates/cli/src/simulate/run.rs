//! The run itself: integrate, write the trajectory on the way, tell the result.

use super::accuracy::Accuracy;
use super::args::Args;
use super::columns::{Columns, JsonSample};
use super::compile;
use super::control::{Loop, Outcome};
use super::json::{self, Report, Statistics};
use super::plan::Plan;
use super::recorder::{Recorder, stopped, without_value};
use super::request::Request;
use super::sample;
use super::table::Summary;
use super::unresolved;
use hamel::dynamics::Dynamics;
use hamel::integrate::{IntegrateError, Integration, Observer, Options, Solution, State};
use hamel::mechanism::{Kinematics, Mechanism};
use hamel::registry::JointRegistry;
use hamel_console::interrupt::{self, Heed};
use hamel_console::output::{self, Failure};
use hamel_console::terminal;
use std::ops::ControlFlow;
use std::time::Instant;

/// Simulates the scene of `args`.
///
/// # Errors
/// Mistakes in the scene or the options; a simulation that stops early or is interrupted; output that cannot be written.
pub fn run(args: &Args, registry: &JointRegistry) -> Result<(), Failure> {
    let mut plan = Plan::new(args, registry)?;
    Request::settle(&mut plan, args.quiet)?;
    let columns = Columns::new(&plan)?;
    let run = match args.compiled {
        true => {
            let mut equations = compile::equations(args, &plan)?;
            let run = simulate(args, &plan, &columns, &mut equations.dynamics)?;
            Run {
                equations: Some(compile::told(&equations)),
                ..run
            }
        }
        false => {
            let mut tree = plan.settings.arithmetic.dynamics(&plan.scene.mechanism);
            simulate(args, &plan, &columns, &mut *tree)?
        }
    };
    match (args.json, args.quiet) {
        (true, _) => print_json(&plan, &columns, &run)?,
        (false, true) => {}
        (false, false) => print_summary(&plan, &columns, &run)?,
    }
    // The summary has said so.
    let short = plan.request.as_ref().filter(|asked| !asked.is_reached());
    if let Some(asked) = short.filter(|_| args.json || args.quiet) {
        terminal::err(&format!("warning: {asked}"));
    }
    if run.is_interrupted {
        return Err(interrupted(&plan, &run.solution));
    }
    match run.accuracy.as_ref().is_some_and(|own| own.is_interrupted) {
        true => Err(Failure::Interrupted(
            "the estimate of the error ended before it was known; the motion is complete".into(),
        )),
        false => Ok(()),
    }
}

/// What is reported of a simulation that the user has ended.
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
    /// Its error, where that was estimated.
    accuracy: Option<Accuracy>,
    /// The numbers of each sample, where JSON is asked for.
    rows: Vec<Vec<f64>>,
    /// Whether the user ended it.
    is_interrupted: bool,
}

fn simulate(
    args: &Args,
    plan: &Plan,
    columns: &Columns<'_>,
    dynamics: &mut dyn Dynamics,
) -> Result<Run, Failure> {
    let control = Loop::new(plan)?;
    let mut recorder = Recorder::new(plan, columns, args.quiet);
    let heed = Heed::begin();
    let start = Instant::now();
    let (initial, options) = (plan.scene.start(), plan.options());
    let motion = Motion {
        plan,
        initial: &initial,
        options: &options,
        control: control.as_ref(),
        companion_of: None,
    };
    let result = move_on(&motion, dynamics, &mut |step| {
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
    recorder.moved();
    let rows = recorder.rows();
    // Nobody is told of it under `--quiet` where there is no file.
    let is_wanted =
        !args.no_error_estimate && !recorder.is_interrupted() && (!args.quiet || plan.has_files());
    let solved = result.as_ref().ok().filter(|_| is_wanted);
    let accuracy = solved.map(|solution| Accuracy::estimate(plan, dynamics, solution));
    let recorded = recorder.finish(accuracy.as_ref())?;
    let failure = control.as_ref().and_then(Loop::failure);
    let solution = result.map_err(|error| match failure {
        Some(cause) => stopped(plan, recorded, &cause),
        None => stopped(plan, recorded, &error),
    })?;
    drop(heed);
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
        accuracy,
        rows,
        is_interrupted: recorded.is_interrupted,
    })
}

/// A motion that is to be integrated.
pub struct Motion<'a> {
    /// What the run is.
    pub plan: &'a Plan,
    /// The first state.
    pub initial: &'a State,
    /// What the integrator is asked to do.
    pub options: &'a Options,
    /// The controller, if there is one.
    pub control: Option<&'a Loop>,
    /// The motion whose error it tells, if it is for that alone: without events, with samples that end steps, and with a method that changes where that of the other did.
    pub companion_of: Option<&'a Solution>,
}

/// Integrates, with feedback where there is a controller: at every instant, or held over its period.
///
/// # Errors
/// Those of [`Integration::run`].
pub fn move_on(
    motion: &Motion<'_>,
    dynamics: &mut dyn Dynamics,
    observer: &mut Observer<'_>,
) -> Result<Solution, IntegrateError> {
    let plan = motion.plan;
    let mut integration =
        Integration::new(dynamics, motion.initial, motion.options).observer(observer);
    let is_companion = motion.companion_of.is_some();
    let other = motion.companion_of;
    if plan.is_open && other.is_none_or(|other| !other.method_changes.is_empty()) {
        integration = integration.choosing();
    }
    if plan.forces && !is_companion {
        integration = integration.telling_forces();
    }
    if !is_companion {
        integration = integration.sampling(plan.settings.sampling);
        for event in &plan.scene.events {
            integration = integration.event(event.event(&plan.scene.mechanism));
        }
    }
    if let Some(control) = motion.control {
        integration = integration.inputs(|time, q, speeds, efforts| {
            control.fill(time, q, speeds, efforts);
        });
        integration = integration.bending(|time, q, speeds, bends| {
            control.bends(time, q, speeds, bends);
        });
        integration = integration.inputs_at_ports(|time, q, speeds, efforts| {
            control.efforts_at_ports(time, q, speeds, efforts);
        });
        if let Some(period) = control.period() {
            integration = integration.held(period);
        }
    }
    integration.run()
}

/// The same without a record, until the user ends it; the controller and `observer` see every step.
///
/// # Errors
/// Those of [`move_on`].
pub fn move_unrecorded(
    motion: &Motion<'_>,
    dynamics: &mut dyn Dynamics,
    observer: &mut Observer<'_>,
) -> Result<Solution, IntegrateError> {
    move_on(motion, dynamics, &mut |step| {
        if let Some(control) = motion.control {
            control.see(step);
        }
        match interrupt::is_requested() {
            true => ControlFlow::Break(()),
            false => observer(step),
        }
    })
}

fn kinematics(mechanism: &Mechanism, state: &State) -> Result<Kinematics, Failure> {
    let at = (&*state.configuration, &*state.speeds);
    sample::kinematics(mechanism, at).map_err(|error| without_value(state.time, &error))
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
        arithmetic: plan.settings.arithmetic.name(),
        arithmetic_reason: plan.arithmetic_reason.as_deref(),
        accuracy: plan.request.as_ref(),
        interrupted_at: run.is_interrupted.then_some(run.solution.state.time),
        method_changes: &run
            .solution
            .method_changes
            .iter()
            .map(json::MethodChange::of)
            .collect::<Vec<_>>(),
        unresolved: unresolved::unresolved(plan, run.statistics.steps, run.solution.state.time)?,
        columns: columns.list(),
        samples: &samples,
        events: &events,
        control: run.outcome.as_ref(),
        error: run.accuracy.as_ref(),
        rounding: run.solution.rounding.as_ref().map(json::Rounding::of),
        statistics: run.statistics,
    })
}

fn print_summary(plan: &Plan, columns: &Columns<'_>, run: &Run) -> Result<(), Failure> {
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
        accuracy: run.accuracy.as_ref(),
        statistics: run.statistics,
        approaches: &solution.approaches,
        forces: &columns.notes(),
        rounding: solution.rounding.as_ref(),
        method_changes: &solution.method_changes,
        events: &solution.events,
    };
    let summary = summary.to_string();
    match plan.writes_stdout() {
        true => {
            terminal::err(summary.trim_end());
            Ok(())
        }
        false => output::print(&summary),
    }
}
