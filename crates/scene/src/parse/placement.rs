//! A pose: `{ position = […], and one of rotation_vector, quaternion_wxyz, rpy, rotation, axis }`.

use super::rotation;
use crate::read::{Sink, Value};
use crate::source::Located;
use hamel_runtime::spatial::Pose;
use nalgebra::{Matrix3, Vector3};

/// Ways to write a rotation, in the order of [`rotation`]'s readers.
const ROTATIONS: [&str; 5] = [
    "rotation_vector",
    "quaternion_wxyz",
    "rpy",
    "rotation",
    "axis",
];

/// Reads a pose; what is absent is 0 or the identity.
pub(super) fn pose(value: &Value<'_>, sink: &mut Sink) -> Option<Located<Pose<f64>>> {
    let mut fields = value.table(sink)?;
    let translation = match fields.optional("position") {
        Some(position) => position.vector(sink).map(|position| position.value),
        None => Some(Vector3::zeros()),
    };
    let rotation = match fields.at_most_one(&ROTATIONS, sink) {
        Some((way, value)) => read_rotation(way, &value, sink),
        None => Some(Matrix3::identity()),
    };
    fields.finish(sink);
    let pose = Pose {
        rotation: rotation?,
        translation: translation?,
    };
    Some(Located::new(pose, value.span()))
}

fn read_rotation(way: usize, value: &Value<'_>, sink: &mut Sink) -> Option<Matrix3<f64>> {
    match way {
        0 => rotation::from_rotation_vector(&value.path(), value.vector(sink)?, sink),
        1 => rotation::from_quaternion(&value.path(), value.vector(sink)?, sink),
        2 => rotation::from_roll_pitch_yaw(&value.path(), value.vector(sink)?, sink),
        3 => rotation::from_matrix(&value.path(), value.matrix3(sink)?, sink),
        _ => rotation::from_axis(&value.path(), value.vector(sink)?, sink),
    }
}
