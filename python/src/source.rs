//! Where a robot comes from: a file, or a text.

use crate::errors;
use hamel::Model;
use hamel::registry::JointRegistry;
use hamel::scene::robot::srdf::{self, Coordinates};
use hamel::scene::robot::{self, Import};
use hamel::scene::{Diagnostics, Scene, SceneDescription, read_file};
use hamel_interpreted::JointType;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The text that a robot is made of.
#[derive(Clone)]
pub struct Source {
    /// What messages call it.
    pub name: String,
    /// The file that it was read from, if it was.
    pub path: Option<PathBuf>,
    /// The text.
    pub text: String,
    /// Whether it is a robot in URDF, MJCF or SDF rather than a scene, by its ending or by how it begins.
    pub is_robot: bool,
    /// How to read a robot.
    pub options: RobotOptions,
    /// Joint types beside those of the library.
    pub joints: Vec<OwnJoint>,
}

/// What the file of a robot leaves open.
#[derive(Clone, Default)]
pub struct RobotOptions {
    /// Whether the root link of a URDF moves freely.
    pub floating_base: bool,
    /// Whether masses of a URDF that no rigid body has are changed.
    pub lenient: bool,
    /// Where joints begin, rad or m.
    pub posture: BTreeMap<String, f64>,
    /// The state of an SRDF in which it begins.
    pub state: Option<State>,
}

/// A state of an SRDF.
#[derive(Clone)]
pub struct State {
    /// Its name.
    pub name: String,
    /// Where it has joints.
    pub coordinates: Coordinates,
}

impl RobotOptions {
    /// The first option that was given, and why a scene does without it.
    fn given(&self) -> Option<(&'static str, &'static str)> {
        match self {
            Self {
                floating_base: true,
                ..
            } => Some((
                "floating_base is True: only robots in URDF have a base that it frees",
                "a scene has a joint `free`",
            )),
            Self { lenient: true, .. } => Some((
                "lenient is True: only robots in URDF are read so",
                "the numbers of a scene are corrected in its text",
            )),
            Self { posture, state, .. } if !posture.is_empty() || state.is_some() => Some((
                "posture is for robots in URDF, MJCF and SDF",
                "the joints of a scene begin where their `initial` says",
            )),
            _ => None,
        }
    }
}

/// A joint type that was made by a `Joint`.
#[derive(Clone)]
pub struct OwnJoint {
    /// The text of its spec, which needs no file beside it.
    pub spec: String,
    /// The type.
    pub kind: JointType,
}

/// Limits of a joint, as a file says them; rad or m, rad/s or m/s, N m or N.
#[derive(Clone, Copy, Default)]
pub struct Limits {
    /// Least position.
    pub lower: Option<f64>,
    /// Largest position.
    pub upper: Option<f64>,
    /// Largest velocity.
    pub velocity: Option<f64>,
    /// Largest effort.
    pub effort: Option<f64>,
}

/// Limits by the names of joints.
pub type AllLimits = BTreeMap<String, Limits>;

impl Source {
    /// A file where `given` is a path, or a `str` without a line break that does not begin as XML does; a text otherwise.
    ///
    /// # Errors
    /// What is neither `str` nor a path; a file that cannot be read.
    pub fn of(given: &Bound<'_, PyAny>, options: RobotOptions) -> PyResult<Self> {
        let py = given.py();
        if let Ok(text) = given.extract::<String>()
            && is_text(&text)
        {
            return Ok(Self::of_text(text, options));
        }
        let path: PathBuf = given.extract().map_err(|_| {
            errors::argument(
                py,
                format!("file_or_text is {given:?}: it must be a path or a text"),
            )
        })?;
        let (text, name) =
            read_file(&path).map_err(|error| errors::file(py, &path.to_string_lossy(), &error))?;
        let is_robot = robot::is_robot(&path, &text);
        let text = match is_robot {
            // With what stands in files beside it.
            true => robot::completed(&path, text)
                .map_err(|error| errors::file(py, &path.to_string_lossy(), &error))?,
            false => text,
        };
        Ok(Self {
            name,
            path: Some(path),
            text,
            is_robot,
            options,
            joints: vec![],
        })
    }

    /// With the state of its posture, which the file `srdf` has, or the one beside the robot.
    ///
    /// # Errors
    /// No such file, and its mistakes; no state of that name in it.
    pub fn in_state(mut self, py: Python<'_>, given: Option<PathBuf>) -> PyResult<Self> {
        let Some(state) = &mut self.options.state else {
            return Ok(self);
        };
        let beside = self.path.as_ref().map(|path| path.with_extension("srdf"));
        let file = given.or(beside.filter(|file| file.is_file())).ok_or_else(|| {
            let name = &state.name;
            errors::argument(
                py,
                format!("posture is {name:?}: say by srdf which SRDF has a state of that name, or write a dict of numbers by the names of joints"),
            )
        })?;
        let (text, shown) =
            read_file(&file).map_err(|error| errors::file(py, &file.to_string_lossy(), &error))?;
        state.coordinates = srdf::state(&text, &shown, &state.name)
            .map_err(|mistakes| errors::file(py, &shown, &mistakes))?;
        Ok(self)
    }

    /// With joint types beside those of the library.
    pub fn with_joints(self, joints: Vec<OwnJoint>) -> Self {
        Self { joints, ..self }
    }

    fn of_text(text: String, options: RobotOptions) -> Self {
        Self {
            name: String::from("text"),
            path: None,
            is_robot: robot::is_robot(&PathBuf::new(), &text),
            text,
            options,
            joints: vec![],
        }
    }

    /// Refuses options of robots for a scene.
    ///
    /// # Errors
    /// The option that was given.
    pub fn fits(self, py: Python<'_>) -> PyResult<Self> {
        match self.options.given().filter(|_| !self.is_robot) {
            Some((fault, why)) => Err(errors::argument(py, format!("{fault}; {why}"))),
            None => Ok(self),
        }
    }

    fn import(&self) -> Result<Import, Diagnostics> {
        let options = robot::Options {
            floating_base: self.options.floating_base,
            lenient: self.options.lenient,
            ..robot::Options::default()
        };
        let posture: Vec<(String, f64)> = self.options.posture.clone().into_iter().collect();
        let import = robot::read(&self.text, &self.name, &options)?;
        let import = match &self.options.state {
            Some(state) => import.in_state(&state.coordinates)?,
            None => import,
        };
        import.in_posture(&posture)
    }

    /// The text of the scene; of a robot that of the scene that is made of it.
    ///
    /// # Errors
    /// Mistakes in the text of a robot.
    pub fn scene_text(&self) -> Result<String, Diagnostics> {
        match self.is_robot {
            true => Ok(self.import()?.to_toml()),
            false => Ok(self.text.clone()),
        }
    }

    /// The scene as it is described; of a robot the one that is made of it.
    ///
    /// # Errors
    /// Mistakes in the text.
    pub fn description(&self) -> Result<SceneDescription, Diagnostics> {
        match self.is_robot {
            true => Ok(self.import()?.scene),
            false => Scene::from_toml(&self.text, &self.name),
        }
    }

    /// The model of joints of these types, and the limits of its joints.
    ///
    /// # Errors
    /// All mistakes of the text.
    pub fn model(&self, joints: &JointRegistry) -> Result<(Model, AllLimits), Diagnostics> {
        let (scene, limits) = match self.is_robot {
            true => {
                let import = self.import()?;
                (import.build(joints)?, limits_of_robot(&import))
            }
            false => {
                // Mistakes of both steps are told together.
                let scene = Scene::parse(&self.text, &self.name, joints)?;
                let described = Scene::from_toml(&self.text, &self.name)?;
                (scene, limits_of_scene(&described))
            }
        };
        Ok((Model::new(scene), limits))
    }
}

/// Whether a `str` is the text itself: no path of a robot has several lines, and none begins as XML does.
fn is_text(given: &str) -> bool {
    given.contains('\n') || robot::is_robot(&PathBuf::new(), given)
}

fn limits_of_robot(import: &Import) -> AllLimits {
    let limited = import.joints.iter().filter_map(|joint| {
        let limits = joint.limits.as_ref()?;
        let (lower, upper) = limits.position.map(|[lower, upper]| (lower, upper)).unzip();
        let own = Limits {
            lower,
            upper,
            velocity: limits.velocity,
            effort: limits.effort,
        };
        Some((joint.name.clone(), own))
    });
    limited.collect()
}

fn limits_of_scene(scene: &SceneDescription) -> AllLimits {
    let limited = scene.bodies.iter().filter_map(|body| {
        let limit = body.forces.limit.as_ref()?.value;
        let own = Limits {
            lower: limit.lower,
            upper: limit.upper,
            ..Limits::default()
        };
        Some((body.joint.name.value.clone(), own))
    });
    limited.collect()
}
