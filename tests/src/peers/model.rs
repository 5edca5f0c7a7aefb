//! `MODEL.txt`: one line per joint.

use hamel::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};

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
