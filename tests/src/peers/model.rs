//! `MODEL.txt`: one line a joint.

use hamel::mechanism::{BodySpec, Mechanism};
use hamel::spatial::{MassProperties, Pose};
use hamel_joints::registry;
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use std::sync::Arc;

/// The four joint types of the format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// `FF`.
    FreeFlyer,
    /// `S`.
    Spherical,
    /// `R`.
    Revolute,
    /// `P`.
    Prismatic,
}

impl JointKind {
    /// Sizes of q and v in the format.
    pub const fn sizes(self) -> (usize, usize) {
        match self {
            Self::FreeFlyer => (7, 6),
            Self::Spherical => (4, 3),
            Self::Revolute | Self::Prismatic => (1, 1),
        }
    }

    /// The joint of the library.
    const fn joint(self) -> &'static str {
        match self {
            Self::FreeFlyer => "free",
            Self::Spherical => "ball_child",
            Self::Revolute => "revolute",
            Self::Prismatic => "prismatic",
        }
    }
}

/// One joint and the body that it carries.
#[derive(Clone, Debug)]
pub struct JointLine {
    /// Type.
    pub kind: JointKind,
    /// Index of the parent's line; `None` is the world.
    pub parent: Option<usize>,
    /// Axis in the joint frame, for `R` and `P`.
    pub axis: Vector3<f64>,
    /// Joint frame in the parent's joint frame.
    pub placement: Pose<f64>,
    /// Mass properties in the joint frame.
    pub mass: MassProperties,
}

/// A model of the format.
#[derive(Clone, Debug)]
pub struct Model {
    /// Acceleration of free fall, world axes, m/s².
    pub gravity: Vector3<f64>,
    /// Parents first.
    pub joints: Vec<JointLine>,
}

/// Why a model cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelError(pub String);

impl std::fmt::Display for ModelError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl Model {
    /// Reads the text of a `MODEL.txt`.
    ///
    /// # Errors
    /// A word that the format does not have, a missing or malformed number.
    pub fn parse(text: &str) -> Result<Self, ModelError> {
        let mut model = Self {
            gravity: Vector3::zeros(),
            joints: Vec::new(),
        };
        for (number, line) in text.lines().enumerate() {
            let mut words = line.split_whitespace();
            let parsed = match words.next() {
                Some("gravity") => vector(&mut words).map(|gravity| model.gravity = gravity),
                Some("joint") => joint(&mut words).map(|joint| model.joints.push(joint)),
                Some("model" | "sizes") | None => Ok(()),
                Some(other) => Err(ModelError(format!("unknown word `{other}`"))),
            };
            parsed.map_err(|error| ModelError(format!("line {}: {error}", number + 1)))?;
        }
        Ok(model)
    }

    /// Sizes of q and v in the format.
    pub fn sizes(&self) -> (usize, usize) {
        let sizes = self.joints.iter().map(|joint| joint.kind.sizes());
        sizes.fold((0, 0), |(nq, nv), (q, v)| (nq + q, nv + v))
    }

    /// The mechanism of the library's joints.
    ///
    /// # Errors
    /// What the mechanism refuses.
    pub fn mechanism(&self) -> Result<Arc<Mechanism>, ModelError> {
        let registry = registry();
        let bodies = self.joints.iter().enumerate().map(|(index, line)| {
            let entry = registry.get(line.kind.joint());
            let entry = entry.ok_or_else(|| ModelError("joint missing".to_owned()))?;
            let joint = (entry.build)(&[]).map_err(|error| ModelError(error.to_string()))?;
            let turn = Pose::from_rotation(onto(&line.axis, line.kind));
            Ok(BodySpec {
                name: format!("body {}", index + 1),
                joint_name: format!("joint {}", index + 1),
                parent: line.parent,
                joint,
                placement: line.placement * turn,
                child_placement: turn.inverse(),
                mass: line.mass,
            })
        });
        let bodies: Result<Vec<_>, ModelError> = bodies.collect();
        let mechanism = Mechanism::new(self.gravity, bodies?).map_err(|errors| {
            let errors: Vec<String> = errors.iter().map(ToString::to_string).collect();
            ModelError(errors.join("; "))
        })?;
        Ok(Arc::new(mechanism))
    }
}

/// A rotation that turns z onto the axis of a joint that has one.
fn onto(axis: &Vector3<f64>, kind: JointKind) -> Matrix3<f64> {
    if matches!(kind, JointKind::FreeFlyer | JointKind::Spherical) {
        return Matrix3::identity();
    }
    let axis = Unit::new_normalize(*axis);
    let rotation = Rotation3::rotation_between(&Vector3::z_axis(), &axis);
    let half_turn = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
    rotation.map_or(half_turn, Rotation3::into_inner)
}

fn joint<'a>(words: &mut impl Iterator<Item = &'a str>) -> Result<JointLine, ModelError> {
    let (_index, parent) = (number(words)?, number(words)?);
    let kind = match words.next() {
        Some("FF") => JointKind::FreeFlyer,
        Some("S") => JointKind::Spherical,
        Some("R") => JointKind::Revolute,
        Some("P") => JointKind::Prismatic,
        other => return Err(ModelError(format!("unknown joint type {other:?}"))),
    };
    let axis = vector(words)?;
    let mut rows = [0.0; 9];
    for entry in &mut rows {
        *entry = number(words)?;
    }
    let placement = Pose::new(Matrix3::from_row_slice(&rows), vector(words)?);
    let (mass, com) = (number(words)?, vector(words)?);
    let [xx, xy, xz] = vector(words)?.into();
    let [yy, yz, zz] = vector(words)?.into();
    Ok(JointLine {
        kind,
        parent: (parent as usize).checked_sub(1),
        axis,
        placement,
        mass: MassProperties {
            mass,
            com,
            inertia_com: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        },
    })
}

fn vector<'a>(words: &mut impl Iterator<Item = &'a str>) -> Result<Vector3<f64>, ModelError> {
    Ok(Vector3::new(number(words)?, number(words)?, number(words)?))
}

fn number<'a>(words: &mut impl Iterator<Item = &'a str>) -> Result<f64, ModelError> {
    let word = words
        .next()
        .ok_or_else(|| ModelError("a number is missing".to_owned()))?;
    word.parse()
        .map_err(|_| ModelError(format!("`{word}` is not a number")))
}
