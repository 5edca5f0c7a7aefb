//! The ways to a robot.

use crate::errors;
use crate::robot::Robot;
use crate::source::Source;
use pyo3::prelude::*;

/// The robot or the scene in a file or a text, as a `Robot`.
///
/// Args:
///     file_or_text: path of a robot in URDF or MJCF or of a scene in TOML, or its text: a `str` with several lines, or one that begins as XML does, is a text.
///     floating_base: whether the root link of a URDF moves freely; otherwise it is fixed to the world.
///
/// Raises:
///     FileError: a file that cannot be read, and all mistakes of its text, each with its line.
#[pyfunction]
#[pyo3(signature = (file_or_text, *, floating_base=false))]
pub fn load(file_or_text: &Bound<'_, PyAny>, floating_base: bool) -> PyResult<Robot> {
    robot(file_or_text.py(), Source::of(file_or_text, floating_base)?)
}

/// The robot of a text that was read before, for pickles.
#[pyfunction]
pub fn parse(py: Python<'_>, source: (String, String, bool, bool)) -> PyResult<Robot> {
    let (name, text, is_robot, floating_base) = source;
    robot(
        py,
        Source {
            name,
            text,
            is_robot,
            floating_base,
        },
    )
}

fn robot(py: Python<'_>, source: Source) -> PyResult<Robot> {
    let read = py.detach(|| source.model());
    let (model, limits) = read.map_err(|error| errors::file(py, &source.name, &error))?;
    if source.floating_base && !source.is_robot {
        let message = "floating_base is True: only robots in URDF have a base that it frees; a scene has a joint `free`";
        return Err(errors::argument(py, message));
    }
    Ok(Robot::new(source, model, limits))
}
