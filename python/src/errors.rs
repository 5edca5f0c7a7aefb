//! Errors as exceptions of Python, by kind. The classes stand in `hamel/_errors.py`.

use crate::arguments::shown;
use hamel::Error;
use hamel::dynamics::DynamicsError;
use hamel::integrate::IntegrateError;
use hamel::mechanism::StateError;
use hamel::scene::Diagnostics;
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyType};

/// Kinds of exceptions.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Other,
    Compilation,
    File,
    Argument,
    Dynamics,
    Integration,
}

impl Kind {
    const fn class(self) -> &'static str {
        match self {
            Self::Other => "Error",
            Self::Compilation => "CompilationError",
            Self::File => "FileError",
            Self::Argument => "ArgumentError",
            Self::Dynamics => "DynamicsError",
            Self::Integration => "IntegrationError",
        }
    }

    fn of(error: &Error) -> Self {
        match error {
            Error::Scene(_) | Error::Bodies(_) | Error::Mechanism(_) | Error::Registry(_) => {
                Self::File
            }
            Error::State(cause) | Error::Dynamics(DynamicsError::State(cause)) => {
                Self::of_state(cause)
            }
            Error::Dynamics(_) | Error::Pins(_) => Self::Dynamics,
            Error::Integrate(cause) => Self::of_integration(cause),
            Error::Control { .. } | Error::Accuracy { .. } => Self::Integration,
            Error::Samples(_) | Error::Name(_) => Self::Argument,
            _ => Self::Other,
        }
    }

    const fn of_state(cause: &StateError) -> Self {
        match cause {
            StateError::NoValue { .. }
            | StateError::Energy { .. }
            | StateError::Singular { .. } => Self::Dynamics,
            _ => Self::Argument,
        }
    }

    const fn of_integration(cause: &IntegrateError) -> Self {
        match cause {
            IntegrateError::Option { .. }
            | IntegrateError::NoEstimate { .. }
            | IntegrateError::Scheme { .. }
            | IntegrateError::TimeOrder { .. }
            | IntegrateError::Sample { .. }
            | IntegrateError::Initial(_) => Self::Argument,
            _ => Self::Integration,
        }
    }
}

/// The exception of that class with this message and what it is called with by keyword.
fn raise(py: Python<'_>, kind: Kind, message: &str, facts: &Bound<'_, PyDict>) -> PyErr {
    let class = || {
        let module = py.import("hamel._errors")?;
        let class = module.getattr(kind.class())?.cast_into::<PyType>()?;
        class.call((message,), Some(facts))
    };
    match class() {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}

/// An argument that is refused.
pub fn argument(py: Python<'_>, message: impl AsRef<str>) -> PyErr {
    raise(py, Kind::Argument, message.as_ref(), &PyDict::new(py))
}

/// Equations that say nothing of what is asked.
pub fn dynamics(py: Python<'_>, message: impl AsRef<str>) -> PyErr {
    raise(py, Kind::Dynamics, message.as_ref(), &PyDict::new(py))
}

/// More numbers than memory holds.
pub fn memory() -> PyErr {
    PyMemoryError::new_err("the batch has more numbers than memory can hold")
}

/// Mistakes in a file or a text.
pub fn file(py: Python<'_>, source: &str, mistakes: &Diagnostics) -> PyErr {
    let list = mistakes.errors().iter().map(|mistake| {
        let place = mistake
            .span()
            .map(|span| mistakes.line_and_column(span.start));
        let (line, column) = place.unzip();
        (line, column, mistake.message())
    });
    let text = mistakes.render(false);
    of_file(py, source, text.trim_end(), list.collect())
}

/// Mistakes in the spec of a joint, with the text of the program.
pub fn spec(py: Python<'_>, mistakes: &hamel_codegen::diagnostic::Diagnostics) -> PyErr {
    let list = mistakes.errors.iter().map(|mistake| {
        let before = mistakes
            .source
            .get(..mistake.span.start)
            .unwrap_or_default();
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
        (Some(line), Some(column), mistake.message.as_str())
    });
    let text = mistakes.render();
    of_file(py, &mistakes.file, text.trim_end(), list.collect())
}

/// A file that cannot be read, or a text that is none.
pub fn unread(py: Python<'_>, source: &str, message: &str) -> PyErr {
    of_file(py, source, message, vec![(None, None, message)])
}

fn of_file(
    py: Python<'_>,
    source: &str,
    text: &str,
    mistakes: Vec<(Option<usize>, Option<usize>, &str)>,
) -> PyErr {
    let facts = || {
        let facts = PyDict::new(py);
        facts.set_item("source", source)?;
        facts.set_item("mistakes", mistakes)?;
        Ok::<_, PyErr>(facts)
    };
    match facts() {
        Ok(facts) => raise(py, Kind::File, text, &facts),
        Err(error) => error,
    }
}

/// Equations that cannot be compiled.
pub fn compilation(py: Python<'_>, message: &str) -> PyErr {
    raise(py, Kind::Compilation, message, &PyDict::new(py))
}

/// Something of no other kind.
pub fn other(py: Python<'_>, message: impl AsRef<str>) -> PyErr {
    raise(py, Kind::Other, message.as_ref(), &PyDict::new(py))
}

/// An argument that is refused at one state of a batch.
pub fn argument_of_state(py: Python<'_>, message: &str, state: usize, batch: &[usize]) -> PyErr {
    if batch.is_empty() {
        return argument(py, message);
    }
    let index = index(state, batch);
    let text = format!("state {}: {message}", shown(&index));
    let facts = || {
        let facts = PyDict::new(py);
        facts.set_item("index", pyo3::types::PyTuple::new(py, index)?)?;
        Ok::<_, PyErr>(facts)
    };
    match facts() {
        Ok(facts) => raise(py, Kind::Argument, &text, &facts),
        Err(error) => error,
    }
}

/// Where a state stands in a batch.
fn index(state: usize, batch: &[usize]) -> Vec<usize> {
    let mut rest = state;
    let mut index: Vec<usize> = batch
        .iter()
        .rev()
        .map(|&size| {
            let own = rest % size;
            rest /= size;
            own
        })
        .collect();
    index.reverse();
    index
}

/// The exception of an error.
pub fn of(py: Python<'_>, error: &Error) -> PyErr {
    of_place(py, error, error.to_string(), None)
}

/// The exception of an error at one state of a batch.
pub fn of_state(py: Python<'_>, error: Error, state: usize, batch: &[usize]) -> PyErr {
    if batch.is_empty() {
        return of(py, &error);
    }
    let index = index(state, batch);
    let message = format!("state {}: {error}", shown(&index));
    of_place(py, &error, message, Some(index))
}

fn of_place(py: Python<'_>, error: &Error, message: String, index: Option<Vec<usize>>) -> PyErr {
    if let Error::Scene(mistakes) = error {
        return file(py, "", mistakes);
    }
    let kind = Kind::of(error);
    let facts = || {
        let facts = PyDict::new(py);
        if let (Some(index), Kind::Argument | Kind::Dynamics) = (index, kind) {
            facts.set_item("index", pyo3::types::PyTuple::new(py, index)?)?;
        }
        if kind == Kind::Integration {
            facts.set_item("time", time_of(error))?;
        }
        Ok::<_, PyErr>(facts)
    };
    match facts() {
        Ok(facts) => raise(py, kind, &message, &facts),
        Err(error) => error,
    }
}

/// The time that a motion has reached, s.
const fn time_of(error: &Error) -> Option<f64> {
    match error {
        Error::Control { time, .. } => Some(*time),
        Error::Integrate(cause) => match cause {
            IntegrateError::AtState { time, .. }
            | IntegrateError::Chatter { time, .. }
            | IntegrateError::Undecided { time, .. }
            | IntegrateError::Step { time, .. }
            | IntegrateError::Hopeless { time, .. }
            | IntegrateError::StepUnderflow { time, .. } => Some(*time),
            IntegrateError::Excluded(approach) => Some(approach.time),
            _ => None,
        },
        _ => None,
    }
}

/// What stands in a module of the package, found once.
pub fn of_package<'py>(
    py: Python<'py>,
    known: &'static PyOnceLock<Py<PyAny>>,
    module: &str,
    name: &str,
) -> PyResult<&'py Bound<'py, PyAny>> {
    let found = known.get_or_try_init(py, || {
        Ok::<_, PyErr>(py.import(module)?.getattr(name)?.unbind())
    })?;
    Ok(found.bind(py))
}
