//! Where a joint stands and how it moves, and what else a file says of it.

use super::document::{attribute, child, number, numbers, place, vector};
use super::robot::{Joint, JointType};
use crate::description::MimicDescription;
use crate::diagnostics::Diagnostic;
use crate::forces::{FrictionDescription, LimitDescription, LimitKind};
use crate::notice::Notices;
use crate::parse::rotation;
use crate::read::Sink;
use crate::robot::{JointFacts, Limits, Stops};
use crate::source::Located;
use hamel_runtime::spatial::Pose;
use nalgebra::{Matrix3, Vector3, Vector4};
use roxmltree::Node;

/// The `<mimic>` element of a joint that moves.
pub(super) fn mimic(joint: &Joint<'_, '_>) -> Option<Located<MimicDescription>> {
    let node = joint.node;
    let followed = attribute(node, "mimic", "joint")?;
    let mimic = MimicDescription {
        joint: Located::new(followed.to_owned(), place(node, "mimic", "joint")),
        multiplier: number(node, "mimic", "multiplier").unwrap_or(1.0),
        offset: number(node, "mimic", "offset").unwrap_or(0.0),
    };
    let moves = joint.kind != JointType::Fixed;
    moves.then(|| Located::new(mimic, place(node, "mimic", "")))
}

/// The rotation that turns z onto the joint's axis; the identity where the joint has none.
pub(super) fn axis(joint: &Joint<'_, '_>, sink: &mut Sink) -> Option<Matrix3<f64>> {
    if !joint.kind.has_axis() {
        return Some(Matrix3::identity());
    }
    // The default of URDF.
    let axis = vector(joint.node, "axis", "xyz").map_or(Vector3::x(), Vector3::from);
    let axis = Located::new(axis, place(joint.node, "axis", "xyz"));
    rotation::from_axis(&format!("joint `{}`: its axis", joint.name), axis, sink)
}

/// The pose that an `<origin>` inside `node` says; the identity without one.
pub(super) fn origin(
    owner: &str,
    node: Node<'_, '_>,
    version: (u32, u32),
    sink: &mut Sink,
) -> Option<Pose<f64>> {
    let or_zero =
        |name: &str| vector(node, "origin", name).map_or_else(Vector3::zeros, Vector3::from);
    let rotation = match attribute(node, "origin", "quat_xyzw") {
        Some(text) => quaternion(owner, text, node, version, sink)?,
        None => {
            let rpy = Located::new(or_zero("rpy"), place(node, "origin", "rpy"));
            rotation::from_roll_pitch_yaw(&format!("{owner}: `rpy`"), rpy, sink)?
        }
    };
    Some(Pose::new(rotation, or_zero("xyz")))
}

/// The rotation of a `quat_xyzw`, whose text has been found to be four numbers.
fn quaternion(
    owner: &str,
    text: &str,
    node: Node<'_, '_>,
    version: (u32, u32),
    sink: &mut Sink,
) -> Option<Matrix3<f64>> {
    let span = place(node, "origin", "quat_xyzw");
    let turned_twice = child(node, "origin").is_some_and(|origin| origin.has_attribute("rpy"));
    let refused = match (turned_twice, version >= (1, 1)) {
        (true, _) => Some("`rpy` and `quat_xyzw` exclude each other"),
        (_, false) => Some("`quat_xyzw` needs `version=\"1.1\"` of <robot>"),
        _ => None,
    };
    if let Some(why) = refused {
        let message = format!("{owner}: in <origin>, {why}");
        sink.push(Diagnostic::new(span, message));
        return None;
    }
    let [x, y, z, w] = numbers(text)?;
    let wxyz = Located::new(Vector4::new(w, x, y, z), span);
    rotation::from_any_quaternion(&format!("{owner}: `quat_xyzw`"), wxyz, sink)
}

/// What the file says of the joint beyond its motion.
pub(super) fn facts(joint: &Joint<'_, '_>, version: (u32, u32)) -> JointFacts {
    let node = joint.node;
    let has_limits = child(node, "limit").is_some();
    JointFacts {
        name: joint.name.to_owned(),
        limits: has_limits.then(|| limits(joint, version)),
        damping: number(node, "dynamics", "damping").unwrap_or(0.0),
        friction: number(node, "dynamics", "friction").unwrap_or(0.0),
    }
}

/// The `<limit>` element. An end that it does not say is at 0, and since version 1.2 nowhere.
fn limits(joint: &Joint<'_, '_>, version: (u32, u32)) -> Limits {
    let limit = |name: &str| number(joint.node, "limit", name);
    let ends = [limit("lower"), limit("upper")];
    let is_limited = ends.iter().any(Option::is_some) && joint.kind != JointType::Continuous;
    let open = if version < (1, 2) { 0.0 } else { f64::INFINITY };
    let [lower, upper] = ends;
    Limits {
        position: is_limited.then(|| [lower.unwrap_or(-open), upper.unwrap_or(open)]),
        velocity: limit("velocity"),
        effort: limit("effort"),
    }
}

/// The limits of position of a joint that turns or slides, as compliant ones.
pub(super) fn stopped(
    joint: &Joint<'_, '_>,
    facts: &JointFacts,
    stops: Stops,
) -> Option<LimitDescription> {
    let limits = facts.limits.as_ref();
    let limits = limits.filter(|_| has_one_coordinate(joint))?;
    let [lower, upper] = limits
        .position?
        .map(|end| Some(end).filter(|end| end.is_finite()));
    (lower.is_some() || upper.is_some()).then_some(LimitDescription {
        lower,
        upper,
        kind: LimitKind::Compliant {
            stiffness: stops.stiffness,
            damping: stops.damping,
        },
    })
}

/// Its dry friction, where it is of a kind that can have some.
pub(super) fn friction(joint: &Joint<'_, '_>, facts: &JointFacts) -> Option<FrictionDescription> {
    (facts.friction != 0.0 && has_one_coordinate(joint)).then_some(FrictionDescription {
        sliding: facts.friction,
        sticking: facts.friction,
    })
}

/// Whether it becomes a joint with a single coordinate, which limits and friction need.
fn has_one_coordinate(joint: &Joint<'_, '_>) -> bool {
    matches!(joint.kind, JointType::Revolute | JointType::Prismatic)
}

/// Whether a joint is beyond its limits where it begins.
fn is_beyond_at(home: f64, limit: &LimitDescription) -> bool {
    limit.lower.is_some_and(|lower| lower > home) || limit.upper.is_some_and(|upper| upper < home)
}

/// What a joint has of its coupling, which changes what is simulated of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coupled {
    /// Its position where all joints that follow none are at home; `None` where loops decide.
    pub(super) home: Option<f64>,
    /// Whether all joints that are coupled with it follow one.
    pub(super) by_one: bool,
}

/// Tells what of a moving joint is not simulated, and what URDF leaves open.
pub(super) fn tell(
    joint: &Joint<'_, '_>,
    coupled: Coupled,
    (facts, stop): (&JointFacts, &Option<LimitDescription>),
    notices: &mut Notices,
) {
    let limits = facts.limits.as_ref();
    let beyond = stop.as_ref().zip(coupled.home);
    let beyond = beyond.filter(|(stop, home)| is_beyond_at(*home, stop));
    let beyond = beyond.map(|(_, home)| home);
    let has = |name: &str| child(joint.node, name).is_some();
    let owner = format!("joint `{}`", joint.name);
    // What moves otherwise than the file says.
    for (holds, message) in [
        (
            stop.is_none() && limits.is_some_and(|limits| limits.position.is_some()),
            "limits of position are not simulated: the joint moves past them",
        ),
        (
            beyond == Some(0.0),
            "the joint begins at home, 0, which is beyond its limits: the stop pushes it back",
        ),
        (
            beyond.is_some_and(|home| home != 0.0),
            "the joint begins, by the offset of its mimic, beyond its limits: the stop pushes it back",
        ),
        (
            facts.friction != 0.0 && !has_one_coordinate(joint),
            "dry friction is simulated of revolute and prismatic joints alone",
        ),
        (
            facts.friction != 0.0 && has_one_coordinate(joint) && !coupled.by_one,
            "dry friction is not simulated of joints that mimic couples with several independent ones",
        ),
    ] {
        if holds {
            notices.warn(message, &owner);
        }
    }
    for (holds, message) in [
        (
            limits.is_some_and(|limits| limits.velocity.is_some() || limits.effort.is_some()),
            "limits of velocity and effort are not simulated",
        ),
        (
            has("safety_controller"),
            "safety controllers are not simulated",
        ),
        (has("calibration"), "calibrations are not read"),
        (
            joint.kind == JointType::Planar,
            "URDF does not say whether a planar joint turns: it turns about its axis and slides across it",
        ),
        (
            joint.kind.has_axis() && !has("axis"),
            "the axis is not given: it is x, the default of URDF",
        ),
    ] {
        if holds {
            notices.add(message, &owner);
        }
    }
}
