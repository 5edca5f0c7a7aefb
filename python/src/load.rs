//! The ways to a robot.

use crate::errors;
use crate::joint::Joint;
use crate::joint_source::SpecSource;
use crate::robot::Robot;
use crate::source::Source;
use pyo3::prelude::*;

/// The robot or the scene in a file or a text, as a `Robot`.
///
/// Args:
///     file_or_text: path of a robot in URDF or MJCF or of a scene in TOML, or its text: a `str` with several lines, or one that begins as XML does, is a text.
///     floating_base: whether the root link of a URDF moves freely; otherwise it is fixed to the world.
///     joints: joint types beside those of the library, as `Joint`s: a scene names them. They are interpreted, which is slower.
///
/// Raises:
///     FileError: a file that cannot be read, and all mistakes of its text, each with its line.
#[pyfunction]
#[pyo3(signature = (file_or_text, *, floating_base=false, joints=None))]
pub fn load(
    file_or_text: &Bound<'_, PyAny>,
    floating_base: bool,
    joints: Option<&Bound<'_, PyAny>>,
) -> PyResult<Robot> {
    let py = file_or_text.py();
    let mut own = vec![];
    for (place, joint) in joints
        .into_iter()
        .flat_map(PyAnyMethods::try_iter)
        .flatten()
        .enumerate()
    {
        let joint = joint?;
        let known = joint.cast::<Joint>().map_err(|_| {
            errors::argument(
                py,
                format!("joints[{place}] is {joint:?}: it must be a Joint"),
            )
        })?;
        own.push(known.get().registered(py)?);
    }
    robot(
        py,
        Source::of(file_or_text, floating_base)?.with_joints(own),
    )
}

/// The robot of a text that was read before, for pickles.
#[pyfunction]
#[pyo3(signature = (source, joints=vec![]))]
pub fn parse(
    py: Python<'_>,
    source: (String, String, bool, bool),
    joints: Vec<String>,
) -> PyResult<Robot> {
    let (name, text, is_robot, floating_base) = source;
    let mut own = vec![];
    for joint in joints {
        own.push(Joint::of(py, SpecSource::of_text(joint))?.registered(py)?);
    }
    robot(
        py,
        Source {
            name,
            text,
            is_robot,
            floating_base,
            joints: own,
        },
    )
}

fn robot(py: Python<'_>, source: Source) -> PyResult<Robot> {
    let mut registry = hamel::joints::registry();
    for joint in &source.joints {
        let added = joint.kind.register(&mut registry);
        added.map_err(|error| errors::argument(py, format!("joints: {error}")))?;
    }
    let read = py.detach(|| source.model(&registry));
    let (model, limits) = read.map_err(|error| errors::file(py, &source.name, &error))?;
    if source.floating_base && !source.is_robot {
        let message = "floating_base is True: only robots in URDF have a base that it frees; a scene has a joint `free`";
        return Err(errors::argument(py, message));
    }
    Ok(Robot::new(source, model, limits))
}
