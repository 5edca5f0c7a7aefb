//! The state of a joint at time 0, as a scene says it, read without the joint library.

use super::number::{Matrix, Real, Vector, nearest_rotation, real, vector};
use super::scene::Unsupported;
use hamel_scene::{BodyDescription, Motion, Position, TwistFrame};

/// Where a joint's child frame stands in its parent frame, and how it moves there, in parent axes.
pub struct Relative {
    pub axes: Matrix,
    pub origin: Vector,
    pub angular: Vector,
    pub linear: Vector,
}

/// Something about a body that these equations do not know.
pub fn unknown(body: &BodyDescription, what: &str) -> Unsupported {
    Unsupported(format!("body `{}`: {what}", body.name.value))
}

/// The state of a joint, read without the joint library.
pub fn relative(body: &BodyDescription) -> Result<Relative, Unsupported> {
    let (axes, origin) = place(body)?;
    let speeds = |count: usize| match &body.initial.motion {
        Motion::Rest => Ok(vec![0.0; count]),
        Motion::Speeds(speeds) => Ok(speeds.value.clone()),
        _ => Err(unknown(body, "a motion given by other than speeds")),
    };
    let zero = Vector::zeros();
    let up = Vector::z();
    let (angular, linear) = match body.joint.kind.value.as_str() {
        "ball" | "ball_quaternion" => match turning(body, &axes) {
            Some(angular) => (angular, zero),
            None => (triple(&speeds(3)?), zero),
        },
        "ball_child" | "ball_quaternion_child" => match turning(body, &axes) {
            Some(angular) => (angular, zero),
            None => (axes * triple(&speeds(3)?), zero),
        },
        "free" => {
            let speeds = speeds(6)?;
            (axes * triple(&speeds), axes * triple(&speeds[3..]))
        }
        "revolute" => (up * real(speeds(1)?[0]), zero),
        "cart" | "knife_edge" => {
            let speeds = speeds(2)?;
            let ahead = axes * Vector::x();
            (up * real(speeds[0]), ahead * real(speeds[1]))
        }
        "falling_disk" => {
            let angular = axes * triple(&speeds(3)?);
            let (normal, length) = (axes.column(2).into_owned(), origin.z);
            let steep = up - normal * normal.z;
            let arm = steep * (-length / steep.dot(&steep));
            (angular, -angular.cross(&arm))
        }
        "ball_on_plane" => {
            let angular = triple(&speeds(3)?);
            (angular, angular.cross(&(up * origin.z)))
        }
        other => return Err(unknown(body, &format!("a joint of type {other}"))),
    };
    Ok(Relative {
        axes,
        origin,
        angular,
        linear,
    })
}

/// The angular velocity of a motion that is given as a twist, in parent axes.
fn turning(body: &BodyDescription, axes: &Matrix) -> Option<Vector> {
    let Motion::Twist(twist) = &body.initial.motion else {
        return None;
    };
    let angular = vector(&twist.value.twist.fixed_rows::<3>(0).into_owned());
    Some(match twist.value.frame {
        TwistFrame::Child => axes * angular,
        TwistFrame::Parent => angular,
    })
}

fn triple(values: &[f64]) -> Vector {
    Vector::new(real(values[0]), real(values[1]), real(values[2]))
}

pub fn parameter(body: &BodyDescription, name: &str) -> Result<Real, Unsupported> {
    let found = body
        .joint
        .parameters
        .iter()
        .find(|(key, _)| key.value == name);
    let found = found.ok_or_else(|| unknown(body, &format!("no {name}")))?;
    Ok(real(found.1))
}

/// Axes and origin of a joint's child frame in its parent frame.
fn place(body: &BodyDescription) -> Result<(Matrix, Vector), Unsupported> {
    let kind = body.joint.kind.value.as_str();
    let zero = Vector::zeros();
    match &body.initial.position {
        Position::Home => Ok((Matrix::identity(), zero)),
        Position::Pose(pose) => Ok((
            nearest_rotation(&pose.value.rotation),
            vector(&pose.value.translation),
        )),
        Position::Phi(phi) if kind == "revolute" => Ok((about_z(phi.value[0]), zero)),
        Position::Phi(phi) if kind == "knife_edge" => {
            let origin = Vector::new(real(phi.value[1]), real(phi.value[2]), real(0.0));
            Ok((about_z(phi.value[0]), origin))
        }
        Position::Configuration(q) if q.value.len() >= 9 => {
            let rows = hamel::nalgebra::Matrix3::from_row_slice(&q.value[..9]);
            let axes = nearest_rotation(&rows);
            match kind {
                "ball_on_plane" | "falling_disk" => {
                    let radius = parameter(body, "radius")?;
                    let cosine = axes[(2, 2)];
                    let height = match kind {
                        "falling_disk" => radius * (real(1.0) - cosine * cosine).sqrt(),
                        _ => radius,
                    };
                    let origin = Vector::new(real(q.value[9]), real(q.value[10]), height);
                    Ok((axes, origin))
                }
                _ => Ok((axes, zero)),
            }
        }
        _ => Err(unknown(body, "this way to give a configuration")),
    }
}

/// The rotation about z by an angle.
fn about_z(angle: f64) -> Matrix {
    let (cosine, sine) = super::closed::cosine_and_sine(angle);
    let (zero, one) = (real(0.0), real(1.0));
    Matrix::new(cosine, -sine, zero, sine, cosine, zero, zero, zero, one)
}
