//! Rotations: about an axis of the frame, and of an element of a group.

use super::super::Fallible;
use super::super::value::Value;
use super::function::Call;
use crate::algebra;
use crate::expr::Expr;
use crate::manifold::Kind;
use crate::matrix::Matrix;

/// `rot_z(angle)`, `rot_z(Q)` for a Q that turns in a plane, and `rot(Q)` for one that turns in space.
pub(super) fn rotation(call: &Call<'_>, arguments: &[Value]) -> Fallible<Value> {
    let axis = call
        .name
        .strip_prefix("rot_")
        .and_then(|axis| "xyz".find(axis));
    let matrix = match (axis, arguments) {
        (Some(axis), [Value::Scalar(angle)]) => {
            let (cos, sin) = call.cos_sin(angle)?;
            Some(about(axis, &cos, &sin))
        }
        (Some(axis), [Value::Element(Kind::S1 | Kind::So2, m)]) => Some(planar(axis, m)),
        (Some(2), [Value::Element(Kind::Se2, m)]) => Some(planar(2, m)),
        (None, [Value::Element(Kind::S3, m)]) => {
            Some(algebra::rotation_of_quaternion(&m.column(0)))
        }
        (None, [value]) => value.as_pose().map(|pose| pose.rotation),
        _ => None,
    };
    let takes = match axis {
        Some(2) => "an angle, or an element of S1, SO2 or SE2",
        Some(_) => "an angle, or an element of S1 or SO2",
        None => "an element of SO3, S3 or SE3, or a pose",
    };
    matrix
        .map(Value::Matrix)
        .ok_or_else(|| call.refuse(takes, arguments))
}

/// Both columns of the plane's rotation are kept: a rotation matrix carries its own entries.
fn planar(axis: usize, m: &Matrix) -> Matrix {
    embed(axis, &m.block(0, 0, 2, 2))
}

/// Right-handed rotation about an axis.
fn about(axis: usize, cos: &Expr, sin: &Expr) -> Matrix {
    let entries = [cos.clone(), -sin, sin.clone(), cos.clone()];
    embed(
        axis,
        &Matrix::from_fn(2, 2, |i, j| entries[2 * i + j].clone()),
    )
}

/// The 2×2 rotation in the plane of the two axes that follow `axis`.
fn embed(axis: usize, plane: &Matrix) -> Matrix {
    // Position in the plane: 0 and 1 for the axes that follow `axis` in cyclic order, 2 for itself.
    let position = |i: usize| (i + 2 - axis) % 3;
    Matrix::from_fn(3, 3, |i, j| match (position(i), position(j)) {
        (2, 2) => Expr::one(),
        (2, _) | (_, 2) => Expr::zero(),
        (r, c) => plane.at(r, c).clone(),
    })
}
