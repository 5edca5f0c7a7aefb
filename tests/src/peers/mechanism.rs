//! The mechanism of a `MODEL.txt`, of the library's joints.

use super::{JointKind, Model, ModelError};
use hamel::mechanism::{BodySpec, Mechanism};
use hamel::spatial::Pose;
use hamel_joints::registry;
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use std::sync::Arc;

impl JointKind {
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

impl Model {
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
