//! Where a robot comes from: a file, or a text.

use crate::errors;
use hamel::Model;
use hamel::registry::JointRegistry;
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
    /// The text.
    pub text: String,
    /// Whether it is a robot in URDF or MJCF rather than a scene, by its ending or by how it begins.
    pub is_robot: bool,
    /// Whether the root link of a URDF moves freely.
    pub floating_base: bool,
    /// Joint types beside those of the library.
    pub joints: Vec<OwnJoint>,
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
    pub fn of(given: &Bound<'_, PyAny>, floating_base: bool) -> PyResult<Self> {
        let py = given.py();
        if let Ok(text) = given.extract::<String>()
            && is_text(&text)
        {
            return Ok(Self::of_text(text, floating_base));
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
            text,
            is_robot,
            floating_base,
            joints: vec![],
        })
    }

    /// With joint types beside those of the library.
    pub fn with_joints(self, joints: Vec<OwnJoint>) -> Self {
        Self { joints, ..self }
    }

    fn of_text(text: String, floating_base: bool) -> Self {
        Self {
            name: String::from("text"),
            is_robot: robot::is_robot(&PathBuf::new(), &text),
            text,
            floating_base,
            joints: vec![],
        }
    }

    fn options(&self) -> robot::Options {
        robot::Options {
            floating_base: self.floating_base,
            ..robot::Options::default()
        }
    }

    /// The text of the scene; of a robot that of the scene that is made of it.
    ///
    /// # Errors
    /// Mistakes in the text of a robot.
    pub fn scene_text(&self) -> Result<String, Diagnostics> {
        match self.is_robot {
            true => Ok(robot::read(&self.text, &self.name, &self.options())?.to_toml()),
            false => Ok(self.text.clone()),
        }
    }

    /// The model of joints of these types, and the limits of its joints.
    ///
    /// # Errors
    /// All mistakes of the text.
    pub fn model(&self, joints: &JointRegistry) -> Result<(Model, AllLimits), Diagnostics> {
        let (scene, limits) = match self.is_robot {
            true => {
                let import = robot::read(&self.text, &self.name, &self.options())?;
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
