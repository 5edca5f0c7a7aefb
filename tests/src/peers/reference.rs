//! Reference answers of `tests/data/robots`: a model, and states with what independent programs make of them.

use super::{JointKind, JointLine, Model, ModelError};
use hamel::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;

/// A mechanism with its reference answers, in Pinocchio's conventions.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The mechanism.
    pub model: Model,
    /// Its states, one object each.
    pub states: Vec<Value>,
}

impl Reference {
    /// Reads a file of `tests/data/robots`.
    ///
    /// # Errors
    /// What is no JSON; a missing or malformed entry, with its name.
    pub fn parse(text: &str) -> Result<Self, ModelError> {
        let file: Value =
            serde_json::from_str(text).map_err(|error| ModelError(error.to_string()))?;
        let joints = array(&file, "joints")?.iter().map(joint);
        Ok(Self {
            model: Model {
                gravity: vector(&file, "gravity")?,
                joints: joints.collect::<Result<_, _>>()?,
            },
            states: array(&file, "states")?.clone(),
        })
    }
}

fn joint(line: &Value) -> Result<JointLine, ModelError> {
    let kind = match line["type"].as_str() {
        Some("free_flyer") => JointKind::FreeFlyer,
        Some("spherical") => JointKind::Spherical,
        Some("revolute") => JointKind::Revolute,
        Some("prismatic") => JointKind::Prismatic,
        other => return Err(ModelError(format!("unknown joint type {other:?}"))),
    };
    let axis = match kind {
        JointKind::Revolute | JointKind::Prismatic => vector(line, "axis")?,
        _ => Vector3::zeros(),
    };
    let placement = &line["placement"];
    let inertia = &line["inertia"];
    let mass = numbers(&inertia["mass"])?;
    Ok(JointLine {
        kind,
        parent: (numbers(&line["parent"])?[0] as usize).checked_sub(1),
        axis,
        placement: Pose::new(
            matrix(placement, "rotation")?,
            vector(placement, "translation")?,
        ),
        mass: MassProperties {
            mass: mass[0],
            com: vector(inertia, "com")?,
            inertia_com: matrix(inertia, "inertia_about_com")?,
        },
    })
}

/// All numbers of a value, row after row.
///
/// # Errors
/// Where anything else is in it.
pub fn numbers(value: &Value) -> Result<Vec<f64>, ModelError> {
    match value {
        Value::Array(entries) => {
            let rows: Result<Vec<_>, _> = entries.iter().map(numbers).collect();
            Ok(rows?.concat())
        }
        other => match other.as_f64() {
            Some(number) => Ok(vec![number]),
            None => Err(ModelError(format!("`{other}` is not a number"))),
        },
    }
}

fn array<'a>(value: &'a Value, name: &str) -> Result<&'a Vec<Value>, ModelError> {
    value[name]
        .as_array()
        .ok_or_else(|| ModelError(format!("`{name}` is not a list")))
}

fn sized<const N: usize>(value: &Value, name: &str) -> Result<[f64; N], ModelError> {
    let numbers = numbers(&value[name])?;
    let found = numbers.len();
    numbers
        .try_into()
        .map_err(|_| ModelError(format!("`{name}` has {found} numbers: it must have {N}")))
}

fn vector(value: &Value, name: &str) -> Result<Vector3<f64>, ModelError> {
    sized::<3>(value, name).map(Vector3::from)
}

fn matrix(value: &Value, name: &str) -> Result<Matrix3<f64>, ModelError> {
    sized::<9>(value, name).map(|rows| Matrix3::from_row_slice(&rows))
}
