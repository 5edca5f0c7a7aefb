//! The record of a run: samples go to the files as they come.

use super::accuracy::Accuracy;
use super::columns::{Columns, Moment, Turns};
use super::csv::Trajectory;
use super::metadata::Metadata;
use super::page::Page;
use super::parquet::Parquet;
use super::picture::Pictures;
use super::plan::Plan;
use super::progress::Progress;
use super::sample;
use hamel::integrate::Step;
use hamel::mechanism::{Mechanism, StateError};
use hamel::shown::Number;
use hamel_console::interrupt;
use hamel_console::output::Failure;
use hamel_pictures::Sample;
use std::borrow::Cow;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// An interrupted simulation ends at the next sample; where that takes longer, at the next step.
const PATIENCE: Duration = Duration::from_secs(1);

/// Writes samples as they come, so that a simulation that stops leaves its trajectory up to there.
pub struct Recorder<'a> {
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
    metadata: Option<Metadata<'a>>,
    parquet: Option<Parquet<'a>>,
    page: Option<Page<'a>>,
    pictures: Option<Pictures<'a>>,
}

/// What a recorder leaves.
#[derive(Clone, Copy, Debug)]
pub struct Recorded {
    /// Whether the files were written: there was a sample.
    pub has_files: bool,
    pub is_interrupted: bool,
}

impl<'a> Files<'a> {
    fn create(plan: &'a Plan, columns: &'a Columns<'a>) -> Result<Self, Failure> {
        Ok(Self {
            trajectory: Trajectory::create(plan, columns)?,
            metadata: Metadata::create(plan, columns)?,
            parquet: Parquet::create(plan, columns)?,
            page: Page::create(plan)?,
            pictures: Pictures::create(plan)?,
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

    fn finish(self, accuracy: Option<&Accuracy>) -> Result<(), Failure> {
        let csv = self.trajectory.map_or(Ok(()), Trajectory::finish);
        let metadata = self.metadata.map(|metadata| metadata.finish(accuracy));
        let parquet = self.parquet.map(|parquet| parquet.finish(accuracy));
        let page = self.page.map(|page| page.finish(accuracy));
        let pictures = self.pictures.map_or(Ok(()), Pictures::finish);
        let told = [metadata, parquet, page].into_iter().flatten();
        told.fold(csv.and(pictures), Result::and)
    }
}

impl<'a> Recorder<'a> {
    /// For the files that `plan` asks for.
    pub fn new(plan: &'a Plan, columns: &'a Columns<'a>, quiet: bool) -> Self {
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
    pub fn see(&mut self, step: &Step<'_>, efforts: &[f64]) -> ControlFlow<()> {
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
        let Some(number) = step.sample else {
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
                self.rows.resize(number + 1, row);
            }
        }
        if let Some(page) = &mut files.page {
            let sample = Sample {
                time: step.time,
                configuration: step.configuration,
                speeds: step.speeds,
                efforts,
                kinematics: Cow::Borrowed(&found),
            };
            page.sample(number, &sample);
        }
        if let Some(pictures) = &mut files.pictures {
            pictures.sample(step.time, &found);
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

    /// The numbers of each sample, where JSON is asked for.
    pub fn rows(&mut self) -> Vec<Vec<f64>> {
        std::mem::take(&mut self.rows)
    }

    /// Whether the user has ended the simulation.
    pub const fn is_interrupted(&self) -> bool {
        self.is_interrupted
    }

    /// Ends the progress that is shown.
    pub fn moved(&self) {
        self.progress.finish();
    }

    /// Finishes the files, with the error of the motion where that was estimated, unless there is no sample or they cannot be written: then what they would replace stays.
    ///
    /// # Errors
    /// A file that cannot be written; what ended the record early.
    pub fn finish(self, accuracy: Option<&Accuracy>) -> Result<Recorded, Failure> {
        self.progress.finish();
        let is_written = !matches!(self.failure, Some(Failure::Write { .. }));
        let files = self.files.filter(|_| self.has_samples && is_written);
        let recorded = Recorded {
            has_files: files.is_some(),
            is_interrupted: self.is_interrupted,
        };
        files.map_or(Ok(()), |files| files.finish(accuracy))?;
        match self.failure {
            None => Ok(recorded),
            Some(Failure::Simulation(cause)) => Err(stopped(self.plan, recorded, &cause)),
            Some(failure) => Err(failure),
        }
    }
}

/// The failure of a simulation that stopped early, and where the samples before that are.
pub fn stopped(plan: &Plan, recorded: Recorded, error: &dyn std::fmt::Display) -> Failure {
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

/// The failure of a sample that cannot be reported.
pub fn without_value(time: f64, error: &StateError) -> Failure {
    Failure::Simulation(format!("at {} s: {error}", Number(time)))
}
