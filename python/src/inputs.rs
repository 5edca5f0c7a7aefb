//! Efforts that a function of Python tells, and signals, in the middle of a motion.

use crate::arguments::{Argument, shown};
use crate::errors;
use numpy::PyArray1;
use pyo3::prelude::*;
use std::cell::{Cell, RefCell};
use std::time::{Duration, Instant};

/// Time between two looks at the signals of the process.
const LOOK: Duration = Duration::from_millis(20);

/// What a motion hears from Python; the first exception ends it.
pub struct Listener<'a> {
    inputs: Option<&'a Py<PyAny>>,
    exception: RefCell<Option<PyErr>>,
    last: Cell<Instant>,
}

impl<'a> Listener<'a> {
    /// With efforts from a function of time, q and v, if one is given.
    pub fn new(inputs: Option<&'a Py<PyAny>>) -> Self {
        Self {
            inputs,
            exception: RefCell::new(None),
            last: Cell::new(Instant::now()),
        }
    }

    /// Whether the motion is to end: an exception was raised, or a signal has come.
    pub fn is_over(&self) -> bool {
        let is_over = self.exception.borrow().is_some();
        if is_over || self.last.get().elapsed() < LOOK {
            return is_over;
        }
        self.last.set(Instant::now());
        let signal = Python::attach(|py| py.check_signals());
        self.keep(signal);
        self.exception.borrow().is_some()
    }

    /// τ at a time, Q and v̄; untouched after an exception.
    pub fn fill(&self, time: f64, q: &[f64], speeds: &[f64], efforts: &mut [f64]) {
        let Some(function) = self.inputs else { return };
        if self.exception.borrow().is_none() {
            self.keep(Python::attach(|py| {
                told(function.bind(py), (time, q, speeds), efforts)
            }));
        }
    }

    /// The exception that has ended the motion.
    pub fn exception(self) -> Option<PyErr> {
        self.exception.into_inner()
    }

    fn keep(&self, outcome: PyResult<()>) {
        if let Err(exception) = outcome {
            *self.exception.borrow_mut() = Some(exception);
        }
    }
}

fn told(
    function: &Bound<'_, PyAny>,
    (time, q, speeds): (f64, &[f64], &[f64]),
    efforts: &mut [f64],
) -> PyResult<()> {
    let py = function.py();
    let state = (
        time,
        PyArray1::from_slice(py, q),
        PyArray1::from_slice(py, speeds),
    );
    let result = Argument::read(
        "the result of inputs",
        &function.call1(state)?,
        efforts.len(),
    )?;
    match result.one() {
        Some(numbers) => {
            efforts.copy_from_slice(numbers);
            Ok(())
        }
        None => Err(errors::argument(
            py,
            format!(
                "the result of inputs has shape {}: it must have shape ({},)",
                shown(result.shape()),
                efforts.len()
            ),
        )),
    }
}
