//! Joint types of URDF in the library, and what else a file says of a joint.

use super::document::{child, place};
use crate::diagnostics::Diagnostic;
use crate::notice::Notices;
use crate::parse::rotation;
use crate::read::Sink;
use crate::source::Located;
use hamel::spatial::Pose;
use nalgebra::{Matrix3, Vector3, Vector4};
use roxmltree::Node;
use urdf_rs::{Joint, JointType};

/// What a file says of a joint beyond its motion. None of it but `damping` is simulated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointFacts {
    /// Name of the joint.
    pub name: String,
    /// The `<limit>` element.
    pub limits: Option<Limits>,
    /// The `<mimic>` element: `multiplier · q + offset` of another joint.
    pub mimic: Option<Mimic>,
    /// Viscous damping, N m s/rad or N s/m.
    pub damping: f64,
    /// Dry friction, N m or N.
    pub friction: f64,
}

impl JointFacts {
    /// What is not simulated of it, a line each.
    pub(super) fn lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(limits) = &self.limits {
            lines.extend(limits.line());
        }
        if let Some(Mimic {
            joint,
            multiplier,
            offset,
        }) = &self.mimic
        {
            lines.push(format!(
                "mimics `{joint}`: {multiplier:?} times its position, and {offset:?}"
            ));
        }
        if self.friction != 0.0 {
            lines.push(format!("dry friction {:?}", self.friction));
        }
        lines
    }
}

impl Limits {
    fn line(&self) -> Option<String> {
        let position = self
            .position
            .map(|[lower, upper]| format!("position {lower:?} to {upper:?}"));
        let velocity = self
            .velocity
            .map(|velocity| format!("velocity {velocity:?}"));
        let effort = self.effort.map(|effort| format!("effort {effort:?}"));
        let parts: Vec<String> = [position, velocity, effort].into_iter().flatten().collect();
        (!parts.is_empty()).then(|| format!("limits: {}", parts.join(", ")))
    }
}

/// Limits of a joint: rad or m, rad/s or m/s, N m or N.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Least and largest position.
    pub position: Option<[f64; 2]>,
    /// Largest velocity.
    pub velocity: Option<f64>,
    /// Largest effort.
    pub effort: Option<f64>,
}

/// A joint that follows another.
#[derive(Clone, Debug, PartialEq)]
pub struct Mimic {
    /// The joint that it follows.
    pub joint: String,
    /// Its motion per motion of the other.
    pub multiplier: f64,
    /// Its position where the other is at 0.
    pub offset: f64,
}

/// The library's joint type; `None` for a fixed joint. All of them act about or along the z axis of their frame.
pub(super) const fn kind(joint: &JointType) -> Option<&'static str> {
    match joint {
        JointType::Fixed => None,
        JointType::Revolute => Some("revolute"),
        JointType::Continuous => Some("revolute_circle"),
        JointType::Prismatic => Some("prismatic"),
        JointType::Planar => Some("planar"),
        JointType::Floating => Some("free"),
        JointType::Spherical => Some("ball_child"),
    }
}

/// The rotation that turns z onto the joint's axis; the identity where the joint has none.
pub(super) fn axis(joint: &Joint, node: Node<'_, '_>, sink: &mut Sink) -> Option<Matrix3<f64>> {
    match joint.joint_type {
        JointType::Fixed | JointType::Floating | JointType::Spherical => Some(Matrix3::identity()),
        _ => {
            let axis = Vector3::from(joint.axis.xyz.0);
            let axis = Located::new(axis, place(node, "axis", "xyz"));
            rotation::from_axis(&format!("joint `{}`: its axis", joint.name), axis, sink)
        }
    }
}

/// The pose that an `<origin>` inside `node` says; the identity without one.
pub(super) fn origin(
    owner: &str,
    origin: &urdf_rs::Pose,
    node: Node<'_, '_>,
    version: (u32, u32),
    sink: &mut Sink,
) -> Option<Pose<f64>> {
    let element = child(node, "origin");
    let rotation = match element.and_then(|element| element.attribute("quat_xyzw")) {
        Some(text) => quaternion(owner, text, node, version, sink)?,
        None => {
            let rpy = Located::new(Vector3::from(origin.rpy.0), place(node, "origin", "rpy"));
            rotation::from_roll_pitch_yaw(&format!("{owner}: `rpy`"), rpy, sink)?
        }
    };
    Some(Pose::new(rotation, Vector3::from(origin.xyz.0)))
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
    let words = text.split_whitespace();
    let mut numbers = words.map(|word| word.parse().unwrap_or(f64::NAN));
    let [x, y, z, w] = std::array::from_fn(|_| numbers.next().unwrap_or(f64::NAN));
    let wxyz = Located::new(Vector4::new(w, x, y, z), span);
    rotation::from_any_quaternion(&format!("{owner}: `quat_xyzw`"), wxyz, sink)
}

/// What the file says of the joint beyond its motion.
pub(super) fn facts(joint: &Joint, node: Node<'_, '_>) -> JointFacts {
    let limit = child(node, "limit");
    let has = |name: &str| limit.is_some_and(|limit| limit.has_attribute(name));
    let positions = has("lower") || has("upper");
    let ends = [joint.limit.lower, joint.limit.upper];
    let dynamics = joint.dynamics.clone().unwrap_or_default();
    JointFacts {
        name: joint.name.clone(),
        limits: limit.map(|_| Limits {
            position: (positions && joint.joint_type != JointType::Continuous).then_some(ends),
            velocity: has("velocity").then_some(joint.limit.velocity),
            effort: has("effort").then_some(joint.limit.effort),
        }),
        mimic: joint.mimic.as_ref().map(|mimic| Mimic {
            joint: mimic.joint.clone(),
            multiplier: mimic.multiplier.unwrap_or(1.0),
            offset: mimic.offset.unwrap_or(0.0),
        }),
        damping: dynamics.damping,
        friction: dynamics.friction,
    }
}

/// Tells what of a moving joint, one of `joints`, is not simulated, and what URDF leaves open.
pub(super) fn tell(
    joint: &Joint,
    joints: &[Joint],
    facts: &JointFacts,
    node: Node<'_, '_>,
    notices: &mut Notices,
) {
    let limits = facts.limits.as_ref();
    let follows = |mimic: &Mimic| {
        let mut names = joints.iter().map(|joint| &joint.name);
        mimic.joint != joint.name && names.any(|name| *name == mimic.joint)
    };
    let mimic = facts.mimic.as_ref().map(follows);
    let has_axis = matches!(
        joint.joint_type,
        JointType::Revolute | JointType::Continuous | JointType::Prismatic | JointType::Planar
    );
    for (holds, message) in [
        (
            limits.is_some_and(|limits| limits.position.is_some()),
            "limits of position are not simulated: the joint moves past them",
        ),
        (
            limits.is_some_and(|limits| limits.velocity.is_some() || limits.effort.is_some()),
            "limits of velocity and effort are not simulated",
        ),
        (
            mimic == Some(true),
            "mimic joints are not coupled: the joint moves by itself",
        ),
        (
            mimic == Some(false),
            "mimic joints follow no other joint of the robot: the joint moves by itself",
        ),
        (facts.friction != 0.0, "dry friction is not simulated"),
        (
            joint.safety_controller.is_some(),
            "safety controllers are not simulated",
        ),
        (joint.calibration.is_some(), "calibrations are not read"),
        (
            joint.joint_type == JointType::Planar,
            "URDF does not say whether a planar joint turns: it turns about its axis and slides across it",
        ),
        (
            has_axis && child(node, "axis").is_none(),
            "the axis is not given: it is x, the default of URDF",
        ),
    ] {
        if holds {
            notices.add(message, format!("joint `{}`", joint.name));
        }
    }
}
