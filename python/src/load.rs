//! The ways to a robot.

use crate::errors;
use crate::joint::Joint;
use crate::joint_source::SpecSource;
use crate::robot::Robot;
use crate::source::{RobotOptions, Source, State};
use hamel::scene::robot::srdf::Coordinates;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The robot or the scene in a file or a text, as a `Robot`.
///
/// Args:
///     file_or_text: path of a robot in URDF, MJCF or SDF or of a scene in TOML, or its text: a `str` with several lines, or one that begins as XML does, is a text.
///     floating_base: whether the root link of a URDF moves freely; otherwise it is fixed to the world.
///     lenient: whether a URDF is read although no rigid body has its masses: such an inertia becomes that of a ball with the mean of its moments, joints that move nothing
///         with mass are fixed, and joints that mimic one that is not there move by themselves. `Robot.notices` tells what was changed.
///     posture: where joints of a robot in URDF, MJCF or SDF begin, by their names: angles in rad, displacements in m; others begin at home. Or the name of a state of an SRDF.
///     srdf: path of the SRDF with that state; without it the file of the robot's name that ends in ``.srdf``.
///     joints: joint types beside those of the library, as `Joint`s: a scene names them. They are interpreted, which is slower.
///
/// Raises:
///     FileError: a file that cannot be read, and all mistakes of its text, each with its line.
#[pyfunction]
#[pyo3(signature = (file_or_text, *, floating_base=false, lenient=false, posture=None, srdf=None, joints=None))]
pub fn load(
    file_or_text: &Bound<'_, PyAny>,
    floating_base: bool,
    lenient: bool,
    posture: Option<&Bound<'_, PyAny>>,
    srdf: Option<PathBuf>,
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
        ..begun(posture)?
    };
    if srdf.is_some() && options.state.is_none() {
        let message = "srdf is for a posture that is the name of a state";
        return Err(errors::argument(py, message));
    }
    let source = Source::of(file_or_text, options)?.with_joints(own);
    robot(py, source.fits(py)?.in_state(py, srdf)?)
}

/// Where a robot begins: the name of a state, or coordinates by the names of joints.
fn begun(posture: Option<&Bound<'_, PyAny>>) -> PyResult<RobotOptions> {
    let mut options = RobotOptions::default();
    let Some(posture) = posture else {
        return Ok(options);
    };
    if let Ok(name) = posture.extract::<String>() {
        let coordinates = vec![];
        options.state = Some(State { name, coordinates });
        return Ok(options);
    }
    options.posture = posture.extract().map_err(|_| {
        let message = format!(
            "posture is {posture:?}: it must be a dict of numbers by the names of joints, in rad or m, or the name of a state of an SRDF"
        );
        errors::argument(posture.py(), message)
    })?;
    Ok(options)
}

/// What a pickle holds of the options of a robot.
pub type Options = (
    bool,
    bool,
    BTreeMap<String, f64>,
    Option<(String, Coordinates)>,
);

/// The robot of a text that was read before, for pickles; compiled again where it was.
#[pyfunction]
#[pyo3(signature = (source, options, joints=vec![], compilation=None))]
pub fn parse(
    py: Python<'_>,
    source: (String, String, bool),
    options: Options,
    joints: Vec<String>,
    compilation: Option<(Option<Vec<String>>,)>,
) -> PyResult<Robot> {
    let (name, text, is_robot) = source;
    let (floating_base, lenient, posture, state) = options;
    let mut own = vec![];
    for joint in joints {
        own.push(Joint::of(py, SpecSource::of_text(joint))?.registered(py)?);
    }
    let robot = robot(
        py,
        Source {
            name,
            path: None,
            text,
            is_robot,
            options: RobotOptions {
                floating_base,
                lenient,
                posture,
                state: state.map(|(name, coordinates)| State { name, coordinates }),
            },
            joints: own,
        },
    )?;
    match compilation {
        Some((functions,)) => robot.compiled_with(py, functions),
        None => Ok(robot),
    }
}

fn robot(py: Python<'_>, source: Source) -> PyResult<Robot> {
    let mut registry = hamel::joints::registry();
    for joint in &source.joints {
        let added = joint.kind.register(&mut registry);
        added.map_err(|error| errors::argument(py, format!("joints: {error}")))?;
    }
    let read = py.detach(|| source.model(&registry));
    let (model, limits) = read.map_err(|error| errors::file(py, &source.name, &error))?;
    Ok(Robot::new(source, model, limits, None))
}
