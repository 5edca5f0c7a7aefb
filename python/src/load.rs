//! The ways to a robot.

use crate::errors;
use crate::joint::Joint;
use crate::joint_source::SpecSource;
use crate::robot::Robot;
use crate::source::{RobotOptions, Source};
use pyo3::prelude::*;
use std::collections::BTreeMap;

/// The robot or the scene in a file or a text, as a `Robot`.
///
/// Args:
///     file_or_text: path of a robot in URDF, MJCF or SDF or of a scene in TOML, or its text: a `str` with several lines, or one that begins as XML does, is a text.
///     floating_base: whether the root link of a URDF moves freely; otherwise it is fixed to the world.
///     lenient: whether a URDF is read although no rigid body has its masses: such an inertia becomes that of a ball with the mean of its moments, and joints that move nothing
///         with mass are fixed. `Robot.notices` tells what was changed.
///     posture: where joints of a robot in URDF, MJCF or SDF begin, by their names: angles in rad, displacements in m. Others begin at home.
///     joints: joint types beside those of the library, as `Joint`s: a scene names them. They are interpreted, which is slower.
///
/// Raises:
///     FileError: a file that cannot be read, and all mistakes of its text, each with its line.
#[pyfunction]
#[pyo3(signature = (file_or_text, *, floating_base=false, lenient=false, posture=None, joints=None))]
pub fn load(
    file_or_text: &Bound<'_, PyAny>,
    floating_base: bool,
    lenient: bool,
    posture: Option<&Bound<'_, PyAny>>,
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
    let options = RobotOptions {
        floating_base,
        lenient,
        posture: coordinates(posture)?,
    };
    robot(py, Source::of(file_or_text, options)?.with_joints(own))
}

/// Coordinates by the names of joints.
fn coordinates(posture: Option<&Bound<'_, PyAny>>) -> PyResult<BTreeMap<String, f64>> {
    let Some(posture) = posture else {
        return Ok(BTreeMap::new());
    };
    posture.extract().map_err(|_| {
        let message = format!(
            "posture is {posture:?}: it must be a dict of numbers by the names of joints, in rad or m"
        );
        errors::argument(posture.py(), message)
    })
}

/// The robot of a text that was read before, for pickles.
#[pyfunction]
#[pyo3(signature = (source, options, joints=vec![]))]
pub fn parse(
    py: Python<'_>,
    source: (String, String, bool),
    options: (bool, bool, BTreeMap<String, f64>),
    joints: Vec<String>,
) -> PyResult<Robot> {
    let (name, text, is_robot) = source;
    let (floating_base, lenient, posture) = options;
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
            options: RobotOptions {
                floating_base,
                lenient,
                posture,
            },
            joints: own,
        },
    )
}

fn robot(py: Python<'_>, source: Source) -> PyResult<Robot> {
    let source = source.fits(py)?;
    let mut registry = hamel::joints::registry();
    for joint in &source.joints {
        let added = joint.kind.register(&mut registry);
        added.map_err(|error| errors::argument(py, format!("joints: {error}")))?;
    }
    let read = py.detach(|| source.model(&registry));
    let (model, limits) = read.map_err(|error| errors::file(py, &source.name, &error))?;
    Ok(Robot::new(source, model, limits))
}
