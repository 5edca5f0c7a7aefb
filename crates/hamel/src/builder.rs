//! A model from bodies that are made by hand.

use crate::error::{BodyError, Error};
use crate::model::Model;
use hamel_joints::registry;
use hamel_runtime::erased::AnyJoint;
use hamel_runtime::mechanism::{BodySpec, Mechanism};
use hamel_runtime::registry::JointRegistry;
use hamel_runtime::spatial::{MassProperties, Pose};
use hamel_scene::suggest::nearest;
use hamel_scene::{Scene, Settings};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// A body with the joint that it hangs on: a rigid body of mass zero, on a joint to the world, until said otherwise.
///
/// Its pose in its parent is `placement · H(Q)`; a joint acts about and along the z axis of its own frame, which `placement` turns.
#[derive(Clone, Debug)]
pub struct Body {
    name: String,
    parent: Option<String>,
    joint: String,
    parameters: Vec<(String, f64)>,
    placement: Pose<f64>,
    mass: f64,
    com: Vector3<f64>,
    inertia: Matrix3<f64>,
}

impl Body {
    /// A body on a joint of this type (`revolute`, `ball`, `free`, …) to the world.
    pub fn new(name: &str, joint: &str) -> Self {
        Self {
            name: name.to_owned(),
            parent: None,
            joint: joint.to_owned(),
            parameters: Vec::new(),
            placement: Pose::identity(),
            mass: 0.0,
            com: Vector3::zeros(),
            inertia: Matrix3::zeros(),
        }
    }

    /// Hangs it on another body, which is given before it.
    #[must_use]
    pub fn on(mut self, parent: &str) -> Self {
        self.parent = Some(parent.to_owned());
        self
    }

    /// Gives a parameter of the joint its value, in SI units.
    #[must_use]
    pub fn parameter(mut self, name: &str, value: f64) -> Self {
        self.parameters.push((name.to_owned(), value));
        self
    }

    /// Where the joint's frame is in its parent's; replaces what [`Body::at`] said.
    #[must_use]
    pub const fn placed(mut self, pose: Pose<f64>) -> Self {
        self.placement = pose;
        self
    }

    /// Moves the joint's frame to a point of its parent's, m; its axes stay as they are.
    #[must_use]
    pub fn at(mut self, point: [f64; 3]) -> Self {
        self.placement.translation = point.into();
        self
    }

    /// Mass, kg, and centre of mass in the body's frame, m.
    #[must_use]
    pub fn mass(mut self, mass: f64, com: [f64; 3]) -> Self {
        self.mass = mass;
        self.com = com.into();
        self
    }

    /// Moments of inertia about the axes of the body through its centre of mass, kg m².
    #[must_use]
    pub fn inertia(self, [x, y, z]: [f64; 3]) -> Self {
        self.inertia_matrix(Matrix3::from_diagonal(&Vector3::new(x, y, z)))
    }

    /// Inertia about the centre of mass in the axes of the body, kg m²; symmetric.
    #[must_use]
    pub const fn inertia_matrix(mut self, inertia: Matrix3<f64>) -> Self {
        self.inertia = inertia;
        self
    }

    /// The parameters in the order of the joint type.
    fn values(&self, known: &[&str]) -> Result<Vec<f64>, Vec<String>> {
        let joint = &self.joint;
        let of_joint = match known {
            [] => String::from("none"),
            known => format!("`{}`", known.join("`, `")),
        };
        let unknown = self
            .parameters
            .iter()
            .filter(|(name, _)| !known.contains(&&**name));
        let mut errors: Vec<String> = unknown
            .map(|(name, _)| {
                format!("joint type `{joint}` has no parameter `{name}`; it has {of_joint}")
            })
            .collect();
        let mut values = Vec::new();
        for name in known {
            let mut given = self.parameters.iter().filter(|(given, _)| given == name);
            match (given.next(), given.next()) {
                (Some(&(_, value)), None) => values.push(value),
                (None, _) => {
                    errors.push(format!("joint type `{joint}` needs the parameter `{name}`"));
                }
                (Some(_), Some(_)) => errors.push(format!("the parameter `{name}` is given twice")),
            }
        }
        match errors.is_empty() {
            true => Ok(values),
            false => Err(errors),
        }
    }

    fn joint(&self, registry: &JointRegistry) -> Result<Arc<dyn AnyJoint>, Vec<String>> {
        let unknown = || {
            let hint = hint(&self.joint, registry.names());
            vec![format!("no joint type is called `{}`{hint}", self.joint)]
        };
        let entry = registry.get(&self.joint).ok_or_else(unknown)?;
        let names: Vec<&str> = entry.parameters.iter().map(|info| info.name).collect();
        let built = registry.build(entry.name, &self.values(&names)?);
        let built = built.ok_or_else(unknown)?;
        built.map_err(|error| vec![error.to_string()])
    }

    fn parent(&self, before: &[Self]) -> Result<Option<usize>, Vec<String>> {
        let Some(parent) = &self.parent else {
            return Ok(None);
        };
        let names = || before.iter().map(|body| body.name.as_str());
        let found = names().position(|name| name == parent);
        found.map(Some).ok_or_else(|| {
            let hint = hint(parent, names());
            vec![format!("no body before it is called `{parent}`{hint}")]
        })
    }

    /// The body as mechanisms take it, or everything that is wrong with it.
    fn spec(&self, before: &[Self], registry: &JointRegistry) -> Result<BodySpec, Vec<BodyError>> {
        let mass = MassProperties::new(self.mass, self.com, self.inertia);
        let mass = mass.map_err(|error| vec![error.to_string()]);
        match (self.joint(registry), self.parent(before), mass) {
            (Ok(joint), Ok(parent), Ok(mass)) => Ok(BodySpec {
                name: self.name.clone(),
                joint_name: self.name.clone(),
                parent,
                joint,
                placement: self.placement,
                child_placement: Pose::identity(),
                mass,
            }),
            (joint, parent, mass) => {
                let errors = [joint.err(), parent.err(), mass.err()];
                let errors = errors.into_iter().flatten().flatten();
                let body = &self.name;
                let error = |reason| BodyError {
                    body: body.clone(),
                    reason,
                };
                Err(errors.map(error).collect())
            }
        }
    }
}

/// The name among `known` that `name` most likely means, as the end of a message.
fn hint<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    nearest(name, known)
        .map(|name| format!("; did you mean `{name}`?"))
        .unwrap_or_default()
}

/// Bodies that become a [`Model`].
#[derive(Clone, Debug)]
pub struct Builder {
    gravity: Vector3<f64>,
    bodies: Vec<Body>,
    registry: JointRegistry,
}

impl Default for Builder {
    fn default() -> Self {
        Self::new()
    }
}

impl Builder {
    /// No bodies, joints of the library, 9.81 m/s² against z.
    pub fn new() -> Self {
        Self {
            gravity: Vector3::new(0.0, 0.0, -9.81),
            bodies: Vec::new(),
            registry: registry(),
        }
    }

    /// Acceleration of free fall, world axes, m/s².
    #[must_use]
    pub fn gravity(mut self, gravity: [f64; 3]) -> Self {
        self.gravity = gravity.into();
        self
    }

    /// Joint types instead of those of the library.
    #[must_use]
    pub fn registry(mut self, registry: JointRegistry) -> Self {
        self.registry = registry;
        self
    }

    /// One body more; it comes after the body that it hangs on.
    #[must_use]
    pub fn body(mut self, body: Body) -> Self {
        self.bodies.push(body);
        self
    }

    /// The model, at home and at rest. A joint is called as its body.
    ///
    /// # Errors
    /// Everything that is wrong with the bodies; once each is right, what is wrong with them together, such as two of one name.
    pub fn build(self) -> Result<Model, Error> {
        let (mut specs, mut errors) = (Vec::new(), Vec::new());
        for (index, body) in self.bodies.iter().enumerate() {
            match body.spec(&self.bodies[..index], &self.registry) {
                Ok(spec) => specs.push(spec),
                Err(own) => errors.extend(own),
            }
        }
        if !errors.is_empty() {
            return Err(Error::Bodies(errors));
        }
        let mechanism = Arc::new(Mechanism::new(self.gravity, specs)?);
        Ok(Model::new(Scene {
            name: String::from("model"),
            description: String::new(),
            configuration: mechanism.home(),
            speeds: vec![0.0; mechanism.layout().speeds],
            mechanism,
            events: Vec::new(),
            shapes: Vec::new(),
            control: None,
            settings: Settings::default(),
            notices: Vec::new(),
        }))
    }
}
