//! Where a joint that turns or slides stands at time 0, and how it moves, in its one coordinate.

use super::Movement;
use crate::description::{BodyDescription, InitialDescription, Motion, Position, TwistFrame};
use crate::diagnostics::Diagnostic;
use crate::source::{Located, Span};
use hamel_runtime::mechanism::CONFIGURATION_TOLERANCE;
use hamel_runtime::shown::Number;
use hamel_runtime::spatial::Pose;
use nalgebra::{Matrix3, Vector3};

/// A value and where it stands; `None` where the scene gives none.
pub(super) type Given = Option<(f64, Span)>;

/// The y that a position means: 0 at home.
pub(super) fn position(
    name: &str,
    movement: Movement<'_>,
    position: &Position,
) -> Result<Given, Diagnostic> {
    let given = match position {
        Position::Home => return Ok(None),
        Position::Phi(phi) => (only(name, "phi", phi)?, &phi.span),
        Position::Configuration(q) if movement == Movement::Circle => (circle(name, q)?, &q.span),
        Position::Configuration(q) => (only(name, "configuration", q)?, &q.span),
        Position::Pose(pose) => (of_pose(name, movement, pose)?, &pose.span),
    };
    Ok(Some((given.0, given.1.clone())))
}

/// The rate of y.
pub(super) fn rate(
    body: &BodyDescription,
    movement: Movement<'_>,
    initial: &InitialDescription,
) -> Result<Given, Diagnostic> {
    let name = &body.joint.name.value;
    let given = match &initial.motion {
        Motion::Rest => return Ok(None),
        Motion::Velocity(velocity) => (only(name, "velocity", velocity)?, &velocity.span),
        Motion::Speeds(speeds) => (only(name, "speeds", speeds)?, &speeds.span),
        Motion::Rates(rates) => {
            let message = format!("joint `{name}`: it has no ports: give `speeds`");
            return Err(Diagnostic::new(rates.span.clone(), message));
        }
        Motion::Twist(twist) => {
            let axis = match movement {
                Movement::Slide => 5,
                _ => 2,
            };
            let mut rest = twist.value.twist;
            let rate = std::mem::take(&mut rest[axis]);
            // About and along the common z axis a twist is the same in both frames, except for what it has beside.
            if rest.amax() > CONFIGURATION_TOLERANCE * rate.abs().max(1.0) {
                let frame = match twist.value.frame {
                    TwistFrame::Child => "child",
                    TwistFrame::Parent => "parent",
                };
                let message = format!(
                    "joint `{name}`: its twist in the {frame} frame has other parts than that about or along z, up to {:?}",
                    Number(rest.amax())
                );
                return Err(Diagnostic::new(twist.span.clone(), message));
            }
            (rate, &twist.span)
        }
    };
    Ok(Some((given.0, given.1.clone())))
}

/// The one number under `key`.
fn only(name: &str, key: &str, values: &Located<Vec<f64>>) -> Result<f64, Diagnostic> {
    match values.value.as_slice() {
        [value] => Ok(*value),
        values_given => Err(Diagnostic::new(
            values.span.clone(),
            format!(
                "joint `{name}`: `{key}` has size {}, not 1",
                values_given.len()
            ),
        )),
    }
}

/// The angle of a unit complex number.
fn circle(name: &str, q: &Located<Vec<f64>>) -> Result<f64, Diagnostic> {
    let refuse = |message: String| Err(Diagnostic::new(q.span.clone(), message));
    let [c, s] = q.value.as_slice() else {
        let found = q.value.len();
        return refuse(format!(
            "joint `{name}`: `configuration` has size {found}, not 2"
        ));
    };
    let away = (c.hypot(*s) - 1.0).abs();
    match away <= CONFIGURATION_TOLERANCE {
        true => Ok(s.atan2(*c)),
        false => refuse(format!(
            "joint `{name}`: `configuration` is off the unit circle by {:?}, more than {:?}",
            Number(away),
            Number(CONFIGURATION_TOLERANCE)
        )),
    }
}

fn of_pose(
    name: &str,
    movement: Movement<'_>,
    given: &Located<Pose<f64>>,
) -> Result<f64, Diagnostic> {
    let (rotation, translation) = (&given.value.rotation, &given.value.translation);
    let (value, reached) = match movement {
        Movement::Slide => {
            let way = translation.z;
            (way, Pose::from_translation(Vector3::new(0.0, 0.0, way)))
        }
        _ => {
            let angle = rotation[(1, 0)].atan2(rotation[(0, 0)]);
            let (s, c) = angle.sin_cos();
            let turn = Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
            (angle, Pose::from_rotation(turn))
        }
    };
    let away = (rotation - reached.rotation).amax();
    let away = away.max((translation - reached.translation).amax());
    match away <= CONFIGURATION_TOLERANCE * value.abs().max(1.0) {
        true => Ok(value),
        false => Err(Diagnostic::new(
            given.span.clone(),
            format!(
                "joint `{name}`: it cannot take its `pose`: the nearest is {:?} off",
                Number(away)
            ),
        )),
    }
}
