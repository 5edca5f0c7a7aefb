//! Many motions of one scene: what `hamel.sweep` asks for, in one process or in many.

use crate::errors;
use crate::robot::Robot;
use crate::source::{RobotOptions, Source};
use hamel::registry::JointRegistry;
use hamel_lanes::{Lanes, Plan};
use hamel_sweep::{Block, ByTree, Cells, Movers, Row, SweepError, Watch};
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};
use std::num::NonZero;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Time between two looks at the signals of the process.
const LOOK: Duration = Duration::from_millis(20);

/// Rows that are handed out together.
const BLOCK: usize = 1024;

/// The text of the scene of a file, a text or a robot, and what messages call it.
#[pyfunction]
pub fn scene_text(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    floating_base: bool,
) -> PyResult<(String, String)> {
    let source = match scene.cast::<Robot>() {
        Ok(robot) => robot.get().origin().clone(),
        Err(_) => {
            let options = RobotOptions {
                floating_base,
                ..RobotOptions::default()
            };
            Source::of(scene, options)?.fits(py)?
        }
    };
    let text = source.scene_text();
    let text = text.map_err(|mistakes| errors::file(py, &source.name, &mistakes))?;
    Ok((text, source.name))
}

/// The rows, by their places from 0, that decide which numbers of a table of `rows` rows differ.
#[pyfunction]
pub fn sample(rows: u64) -> Vec<u64> {
    hamel_lanes::sample(rows).collect()
}

/// A scene, the numbers of it that rows change, by which equations rows move, and what is reported of their motions. Pickles as what it is made of.
#[pyclass(frozen, module = "hamel._hamel")]
pub struct Sweep {
    text: String,
    source: String,
    moved: hamel_sweep::Sweep,
    joints: JointRegistry,
    /// As it was asked for, and the sample of the table.
    equations: (String, Vec<Vec<f64>>),
    /// What rows move by that go side by side, or why none does.
    plan: Result<Arc<Plan>, String>,
}

#[pymethods]
impl Sweep {
    #[new]
    fn new(
        py: Python<'_>,
        scene: (String, String),
        columns: Vec<String>,
        options: (bool, String, Vec<f64>),
        sample: Vec<Vec<f64>>,
    ) -> PyResult<Self> {
        let (text, source) = scene;
        let (estimate, equations, times) = options;
        if !["auto", "lanes", "tree"].contains(&&*equations) {
            let why = format!("equations is '{equations}': it must be 'auto', 'lanes' or 'tree'");
            return Err(errors::argument(py, why));
        }
        let joints = hamel_sweep::joints();
        let moved = hamel_sweep::Sweep::new(&text, &source, &columns, &joints);
        let moved = moved.and_then(|moved| match estimate {
            true => moved.estimating(&joints),
            false => Ok(moved),
        });
        let moved = moved.and_then(|moved| moved.sampling(&times, &joints));
        let moved = moved.map_err(|error| refusal(py, &source, error))?;
        let plan = if equations == "tree" {
            Err("that was asked for".to_owned())
        } else if estimate {
            Err("errors of motions are estimated".to_owned())
        } else {
            let rows: Vec<Cells> = sample.iter().cloned().map(Cells::from).collect();
            let plan = py.detach(|| Plan::new(&moved, &joints, &rows));
            plan.map(Arc::new)
        };
        if let ("lanes", Err(why)) = (&*equations, &plan) {
            let why = format!("no row can move by equations='lanes': {why}");
            return Err(errors::argument(py, why));
        }
        Ok(Self {
            text,
            source,
            moved,
            joints,
            equations: (equations, sample),
            plan,
        })
    }

    /// Why all rows move by the tree, where they do.
    #[getter]
    fn why_tree(&self) -> Option<&str> {
        self.plan.as_ref().err().map(String::as_str)
    }

    /// The text of the scene.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// What messages call the scene.
    #[getter]
    fn source(&self) -> &str {
        &self.source
    }

    /// Names of the numbers that rows change.
    #[getter]
    fn columns(&self) -> &[String] {
        self.moved.columns()
    }

    /// Names of the numbers that each row gives.
    #[getter]
    fn results(&self) -> &[String] {
        self.moved.results()
    }

    /// The motions of the rows of these columns, by so many threads: a dictionary of arrays, and `outcome`, a list.
    fn rows<'py>(
        &self,
        py: Python<'py>,
        columns: Vec<PyReadonlyArray1<'py, f64>>,
        workers: Option<NonZero<usize>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let rows = rows_of(&columns);
        let listener = Listener::new();
        let moved = py.detach(|| self.run(rows, workers, &listener));
        if let Some(exception) = listener.into_exception() {
            return Err(exception);
        }
        let rows = moved.map_err(|error| refusal(py, &self.source, error))?;
        let all = PyDict::new(py);
        let outcomes: Vec<String> = rows.iter().map(|row| row.outcome.to_string()).collect();
        all.set_item("outcome", outcomes)?;
        for (place, name) in self.moved.results().iter().enumerate() {
            let numbers: Vec<f64> = rows.iter().map(|row| row.numbers[place]).collect();
            all.set_item(name, numbers.into_pyarray(py))?;
        }
        Ok(all)
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyType>, Bound<'py, PyTuple>)> {
        let columns = self.moved.columns().to_vec();
        let (equations, sample) = &self.equations;
        let options = (
            self.moved.estimates(),
            equations,
            self.moved.times().to_vec(),
        );
        let scene = (&self.text, &self.source);
        let arguments = (scene, columns, options, sample).into_pyobject(py)?;
        Ok((py.get_type::<Self>(), arguments))
    }
}

impl Sweep {
    fn run(
        &self,
        rows: Vec<Cells>,
        workers: Option<NonZero<usize>>,
        listener: &Listener,
    ) -> Result<Vec<Row>, SweepError> {
        let count = rows.len();
        let (mut first, mut rest) = (0, rows.into_iter());
        let next = || {
            let rows: Vec<Cells> = rest.by_ref().take(BLOCK).collect();
            let block = (!rows.is_empty()).then_some(Block { first, rows });
            first += BLOCK as u64;
            Ok::<_, SweepError>(block)
        };
        let all = Mutex::new(vec![None; count]);
        let write = |block: &Block, rows: &[Row]| {
            let mut all = all.lock().unwrap_or_else(PoisonError::into_inner);
            let places = all.iter_mut().skip(block.first as usize);
            places
                .zip(rows)
                .for_each(|(place, row)| *place = Some(row.clone()));
            Ok(())
        };
        let watch = Watch {
            pause: &|| listener.is_over(),
            stop: &|| listener.is_over(),
            ..Watch::NONE
        };
        let (sweep, registry) = (&self.moved, &self.joints);
        let (lanes, tree);
        let movers: &dyn Movers = match &self.plan {
            Ok(plan) => {
                lanes = Lanes::new(sweep, registry, Arc::clone(plan));
                &lanes
            }
            Err(_) => {
                tree = ByTree { sweep, registry };
                &tree
            }
        };
        hamel_sweep::run_by(movers, workers, next, &write, watch)?;
        let all = all.into_inner().unwrap_or_else(PoisonError::into_inner);
        // Those that an exception has ended are not told.
        Ok(all.into_iter().flatten().collect())
    }
}

/// Columns as rows.
fn rows_of(columns: &[PyReadonlyArray1<'_, f64>]) -> Vec<Cells> {
    let count = columns
        .first()
        .map_or(0, |column| column.len().unwrap_or(0));
    let mut rows = vec![Cells::default(); count];
    for column in columns {
        let cells = rows.iter_mut().zip(column.as_array());
        cells.for_each(|(row, number)| row.numbers.push(*number));
    }
    rows
}

fn refusal(py: Python<'_>, source: &str, error: SweepError) -> PyErr {
    match error {
        SweepError::Scene(mistakes) => errors::file(py, source, &mistakes),
        other => errors::argument(py, other.to_string()),
    }
}

/// Hears the signals of the process, in the thread that was called from Python.
struct Listener {
    thread: thread::ThreadId,
    is_over: AtomicBool,
    heard: Mutex<(Instant, Option<PyErr>)>,
}

impl Listener {
    fn new() -> Self {
        Self {
            thread: thread::current().id(),
            is_over: AtomicBool::new(false),
            heard: Mutex::new((Instant::now(), None)),
        }
    }

    /// Whether all motions are to end.
    fn is_over(&self) -> bool {
        if self.is_over.load(Ordering::Relaxed) || thread::current().id() != self.thread {
            return self.is_over.load(Ordering::Relaxed);
        }
        let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        if heard.0.elapsed() < LOOK {
            return false;
        }
        heard.0 = Instant::now();
        if let Err(exception) = Python::attach(|py| py.check_signals()) {
            heard.1 = Some(exception);
            self.is_over.store(true, Ordering::Relaxed);
        }
        heard.1.is_some()
    }

    fn into_exception(self) -> Option<PyErr> {
        self.heard
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner)
            .1
    }
}
