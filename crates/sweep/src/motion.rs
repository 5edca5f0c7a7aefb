//! A scene whose numbers rows change, and the motion of one row.

use crate::document::Document;
use crate::results::{Outcome, Results, Row, outcome};
use crate::run::Cells;
use crate::start::start_columns;
use crate::times;
use crate::track::Track;
use hamel::integrate::{State, Step};
use hamel::registry::JointRegistry;
use hamel::scene::{Diagnostics, Scene, SceneDescription, StartNumber};
use hamel::{Error, Model};
use std::cell::RefCell;
use std::ops::Range;
use std::sync::Arc;

/// Why there is no sweep.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// Mistakes in the scene as it is written, before a row changes it.
    #[error(transparent)]
    Scene(#[from] Diagnostics),
    /// Columns that change nothing of the scene, one a line.
    #[error("{}", .0.join("\n"))]
    Columns(Vec<String>),
    /// Times of samples that no motion has, one a line.
    #[error("{}", .0.join("\n"))]
    Times(Vec<String>),
}

/// A scene, the numbers of it that a table changes, and what is reported of its motions.
#[derive(Clone, Debug)]
pub struct Sweep {
    document: Document,
    source: String,
    columns: Vec<String>,
    /// Columns that change the state at time 0 alone.
    pub(crate) starts: Vec<(usize, StartNumber)>,
    results: Arc<Results>,
    has_error: bool,
}

impl Sweep {
    /// Motions of the scene in `text`, which messages call `source`, with other numbers under the names `columns`. A name is the way through the scene file to a number, keys
    /// between dots: `body.arm.mass`, `body.arm.initial.speeds.1`, `controller.frequency`. An element of a list is called by its `name` (or `joint`, or `body`), or by its place, from
    /// 1; a key that holds dots stands in quotes. All numbers have the units of the file.
    ///
    /// # Errors
    /// Mistakes of the scene as it is written; names that lead to no number of it, all of them.
    pub fn new(
        text: &str,
        source: &str,
        columns: &[impl AsRef<str>],
        registry: &JointRegistry,
    ) -> Result<Self, SweepError> {
        let scene = Scene::parse(text, source, registry)?;
        let document = Document::new(text, columns).map_err(SweepError::Columns)?;
        let description = Scene::from_toml(text, source)?;
        Ok(Self {
            starts: start_columns(&document, &description, registry),
            document,
            source: source.to_owned(),
            columns: columns
                .iter()
                .map(|name| name.as_ref().to_owned())
                .collect(),
            results: Arc::new(Results::new(&scene.mechanism, false, &[])),
            has_error: false,
        })
    }

    /// With an estimate of each motion's error, which takes about as long again as the motion: columns `error` and `error_is_reliable`.
    ///
    /// # Errors
    /// None that [`Sweep::new`] does not have.
    pub fn estimating(mut self, registry: &JointRegistry) -> Result<Self, SweepError> {
        let scene = Scene::parse(self.document.text(), &self.source, registry)?;
        self.results = Arc::new(Results::new(&scene.mechanism, true, self.times()));
        self.has_error = true;
        Ok(self)
    }

    /// With coordinates and speeds of all joints at these times too, s, ascending: columns that end with `@` and the time. They are NaN in rows whose motion ends before.
    ///
    /// # Errors
    /// Times that are not finite, negative, not in their order, or after the end of the scene's motion where the table does not change it; all of them. More than 20 000 columns.
    pub fn sampling(self, times: &[f64], registry: &JointRegistry) -> Result<Self, SweepError> {
        let scene = Scene::parse(self.document.text(), &self.source, registry)?;
        self.sampled(&scene, times)
    }

    /// The same at time 0, every `step` seconds after it, and at the end of the scene's motion.
    ///
    /// # Errors
    /// A step that is not above 0, or that makes more than 1e6 samples or 20 000 columns.
    pub fn sampling_every(self, step: f64, registry: &JointRegistry) -> Result<Self, SweepError> {
        let scene = Scene::parse(self.document.text(), &self.source, registry)?;
        let every = times::every(step, &scene);
        let every = every.map_err(|mistake| SweepError::Times(vec![mistake]))?;
        self.sampled(&scene, &every)
    }

    fn sampled(mut self, scene: &Scene, times: &[f64]) -> Result<Self, SweepError> {
        let end = match self.document.changes(&["simulation", "t_end"]) {
            true => f64::INFINITY,
            false => scene.settings.t_end,
        };
        let numbers = self.states().next().map_or(0, |state| state.len());
        let times = times::checked(times, numbers, end).map_err(SweepError::Times)?;
        self.results = Arc::new(Results::new(&scene.mechanism, self.has_error, &times));
        Ok(self)
    }

    /// The times of the samples, s.
    pub fn times(&self) -> &[f64] {
        self.results.times()
    }

    /// Those of a motion that ends at `end`, s: the first of [`Sweep::times`], the last of which is `end` itself where only rounding lies between.
    pub fn times_until(&self, end: f64) -> Vec<f64> {
        let times = self.times().iter();
        times.map_while(|&time| times::until(time, end)).collect()
    }

    /// Places among the [`Sweep::results`] of coordinates and speeds: of the last state, then of each sample. All have the same order.
    pub fn states(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        self.results.states()
    }

    /// The names of the table's columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Names of the numbers of a [`Row`], with units as `hamel simulate` writes them: time, energies and steps; then of all joints coordinates and speeds, at the end and at each of
    /// [`Sweep::times`].
    pub fn results(&self) -> &[String] {
        self.results.names()
    }

    /// The scene file of a row, which moves as the row does; `None` of a row that lacks numbers.
    pub fn scene_of(&self, cells: &Cells) -> Option<String> {
        self.numbers(cells)
            .ok()
            .map(|numbers| self.document.with(numbers))
    }

    /// The motion of one row: the scene is built with its numbers, and moved as its `[simulation]` says. The scene's own samples are not taken, and shorten no steps. The result depends on the row alone.
    pub fn motion(&self, cells: &Cells, registry: &JointRegistry) -> Row {
        let moved = self.motion_until(cells, registry, &|| false);
        moved.unwrap_or_else(|| self.results.failure("it was ended".into()))
    }

    /// As [`Sweep::motion`], until `stop` tells after a step that it is to end: then there is no result.
    pub fn motion_until(
        &self,
        cells: &Cells,
        registry: &JointRegistry,
        stop: &dyn Fn() -> bool,
    ) -> Option<Row> {
        let moved = self.numbers(cells).and_then(|numbers| {
            let scene = self.scene(numbers, registry)?;
            self.moved(scene, stop)
        });
        match moved {
            _ if stop() => None,
            Ok(row) => Some(row),
            Err(cause) => Some(self.results.failure(cause)),
        }
    }

    /// Whether errors of motions are estimated.
    pub const fn estimates(&self) -> bool {
        self.has_error
    }

    /// What the scene of a row says, and what is built of it.
    ///
    /// # Errors
    /// The result of a row without such a scene.
    pub fn described(
        &self,
        cells: &Cells,
        registry: &JointRegistry,
    ) -> Result<(SceneDescription, Scene), Row> {
        let described = self.numbers(cells).and_then(|numbers| {
            let text = self.document.with(numbers);
            // Which mistake is told first depends on whether joints are known.
            let refused = |_| self.scene(numbers, registry).err().unwrap_or_default();
            let description = Scene::from_toml(&text, &self.source).map_err(refused)?;
            let scene = description.build(registry).map_err(refused)?;
            Ok((description, self.fitting(scene)?))
        });
        described.map_err(|cause| self.results.failure(cause))
    }

    /// What is to be kept of a motion that moves otherwise than by [`Sweep::motion`].
    pub fn track(&self) -> Track {
        Track::new(&self.results)
    }

    /// The result of such a motion that came to the end of its time in so many steps.
    pub fn ended(&self, scene: &Scene, state: &State, steps: usize, track: &Track) -> Row {
        let row = self
            .results
            .row(&scene.mechanism, state, (steps, None), track);
        match row {
            Ok(numbers) => Row {
                outcome: Outcome::Ended,
                numbers,
            },
            Err(cause) => self.results.failure(cause),
        }
    }

    /// One for each column.
    fn numbers<'c>(&self, cells: &'c Cells) -> Result<&'c [f64], String> {
        let Cells { numbers, fault } = cells;
        match (fault, numbers.len()) {
            (Some(fault), _) => Err(fault.clone()),
            (None, found) if found != self.columns.len() => Err(format!(
                "the row has {found} cells, and the table {} columns",
                self.columns.len()
            )),
            (None, _) => Ok(numbers),
        }
    }

    fn scene(&self, numbers: &[f64], registry: &JointRegistry) -> Result<Scene, String> {
        let text = self.document.with(numbers);
        let scene = Scene::parse(&text, &self.source, registry);
        self.fitting(scene.map_err(|mistakes| self.refusal(numbers, &mistakes))?)
    }

    /// The scene, where results can tell of its joints.
    fn fitting(&self, scene: Scene) -> Result<Scene, String> {
        match self.results.fit(&scene.mechanism) {
            true => Ok(scene),
            false => Err("its loops move by other coordinates than those of the file: name them by `independent`".into()),
        }
    }

    /// The first mistake of a row's scene, with its column where it stands at the number of one, and how many there are.
    fn refusal(&self, numbers: &[f64], mistakes: &Diagnostics) -> String {
        let [first, others @ ..] = mistakes.errors() else {
            return mistakes.to_string();
        };
        let span = first.span();
        let column = span.and_then(|span| self.document.column_at(numbers, span));
        let mut told = first.message().to_owned();
        if let Some(column) = column {
            told += &format!(" (column `{}`)", self.columns[column]);
        }
        match others.len() {
            0 => told,
            more => format!("{told}, and {more} more"),
        }
    }

    fn moved(&self, scene: Scene, stop: &dyn Fn() -> bool) -> Result<Row, String> {
        let model = Model::new(scene);
        let scene = model.scene();
        let track = RefCell::new(self.track());
        let simulation = model
            .simulate()
            .sample_at(self.times_until(scene.settings.t_end))
            .stopping(stop)
            .observing(|step| track.borrow_mut().follow(&scene.mechanism, step));
        let told = |error: Error| told(&error);
        let (solution, error) = match self.has_error {
            true => {
                let (solution, error) = simulation.run_estimated().map_err(told)?;
                (solution, Some(error))
            }
            false => (simulation.run().map_err(told)?, None),
        };
        let work = (solution.statistics.steps, error.as_ref());
        // What ends a motion within a step is not shown. Step 0 would begin another motion.
        let end = Step::of_state(&solution.state, &solution.travel, work.0.max(1), None);
        track.borrow_mut().follow(&scene.mechanism, &end);
        let numbers = self
            .results
            .row(&scene.mechanism, &solution.state, work, &track.borrow())?;
        Ok(Row {
            outcome: outcome(scene, &solution),
            numbers,
        })
    }
}

/// In one line.
fn told(error: &Error) -> String {
    let told = error.to_string();
    told.lines().map(str::trim).collect::<Vec<_>>().join("; ")
}
