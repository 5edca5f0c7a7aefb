//! Many motions of one scene: what `hamel.sweep` asks for, as a dictionary of arrays.

use crate::errors;
use crate::robot::Robot;
use crate::source::{RobotOptions, Source};
use hamel_sweep::{Block, Cells, Row, Sweep, SweepError, Watch};
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::num::NonZero;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Time between two looks at the signals of the process.
const LOOK: Duration = Duration::from_millis(20);

/// Rows that are handed out together.
const BLOCK: usize = 1000;

/// The motions of all rows of a table of columns, as `hamel.sweep` puts it into words.
#[pyfunction]
pub fn sweep<'py>(
    scene: &Bound<'py, PyAny>,
    names: Vec<String>,
    columns: Vec<PyReadonlyArray1<'py, f64>>,
    options: (Option<usize>, bool, bool),
) -> PyResult<Bound<'py, PyDict>> {
    let py = scene.py();
    let (workers, estimate, floating_base) = options;
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
    let count = columns
        .first()
        .map_or(0, |column| column.len().unwrap_or(0));
    let mut rows = vec![Cells::default(); count];
    for column in &columns {
        let cells = rows.iter_mut().zip(column.as_array());
        cells.for_each(|(row, number)| row.numbers.push(*number));
    }
    let workers = workers.and_then(NonZero::new);
    let listener = Listener::new();
    let moved = py.detach(|| run(&source, &names, rows, (workers, estimate), &listener));
    if let Some(exception) = listener.into_exception() {
        return Err(exception);
    }
    let (results, rows) = moved.map_err(|error| match error {
        SweepError::Scene(mistakes) => errors::file(py, &source.name, &mistakes),
        other => errors::argument(py, other.to_string()),
    })?;
    let all = PyDict::new(py);
    let outcomes: Vec<String> = rows.iter().map(|row| row.outcome.to_string()).collect();
    all.set_item("outcome", outcomes)?;
    for (place, name) in results.iter().enumerate() {
        let numbers: Vec<f64> = rows.iter().map(|row| row.numbers[place]).collect();
        all.set_item(name, numbers.into_pyarray(py))?;
    }
    Ok(all)
}

type Moved = (Vec<String>, Vec<Row>);

fn run(
    source: &Source,
    names: &[String],
    rows: Vec<Cells>,
    (workers, estimate): (Option<NonZero<usize>>, bool),
    listener: &Listener,
) -> Result<Moved, SweepError> {
    let joints = hamel_sweep::joints();
    let text = source.scene_text()?;
    let sweep = Sweep::new(&text, &source.name, names, &joints)?;
    let sweep = match estimate {
        true => sweep.estimating(&joints)?,
        false => sweep,
    };
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
    hamel_sweep::run(&sweep, &joints, workers, next, &write, watch)?;
    let all = all.into_inner().unwrap_or_else(PoisonError::into_inner);
    // Those that an exception has ended are not told.
    Ok((
        sweep.results().to_vec(),
        all.into_iter().flatten().collect(),
    ))
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
