//! What [`Options::lenient`](super::Options::lenient) changes of a robot whose masses no rigid bodies have, or whose joints mimic one that is not there.

use super::document::attribute;
use super::mass;
use super::masses::Part;
use super::robot::{JointType, Robot};
use crate::description::MimicDescription;
use crate::notice::Notices;
use crate::robot::mass::is_nothing;
use crate::source::Located;
use hamel_runtime::spatial::MassProperties;
use nalgebra::{Matrix3, Vector3};
use std::collections::{HashMap, HashSet};

/// Fixes the joints below which nothing has mass, and tells which. Loops and couplings may hold what hangs on them, and joints that follow each other move together, whichever of them moves a
/// mass: those joints stay as they are.
pub(super) fn fix_massless(robot: &mut Robot<'_, '_>, notices: &mut Notices) {
    let joints = || robot.joints.iter();
    let names: HashSet<&str> = joints().map(|joint| joint.name).collect();
    let above: Neighbours<'_> = joints()
        .map(|joint| (joint.child, vec![joint.parent]))
        .collect();
    let mut coupled = Neighbours::new();
    for joint in joints() {
        let followed = attribute(joint.node, "mimic", "joint");
        // Those that mimic one that is not there do not move together.
        if let Some(followed) = followed.filter(|followed| names.contains(followed)) {
            coupled.entry(joint.name).or_default().push(followed);
            coupled.entry(followed).or_default().push(joint.name);
        }
    }
    let ties = robot.loops.iter().chain(&robot.couplings);
    let tied = ties
        .flat_map(|tie| tie.children())
        .filter_map(|end| end.attribute("link"));
    let links = robot.links.iter().filter(|link| {
        let own = link.inertial().and_then(mass::of_inertial);
        own.is_some_and(|own| !is_nothing(&own))
    });
    let links = links.map(|link| link.name).chain(tied).collect();
    let carried = reached(links, &above);
    let carrying = joints().filter(|joint| carried.contains(joint.child));
    let moving = reached(carrying.map(|joint| joint.name).collect(), &coupled);
    let moves_nothing = robot
        .joints
        .iter_mut()
        .filter(|joint| joint.kind != JointType::Fixed && !moving.contains(joint.name));
    for joint in moves_nothing {
        joint.kind = JointType::Fixed;
        let message = "joints that move nothing with mass are fixed";
        notices.warn(message, format!("joint `{}`", joint.name));
    }
}

/// Has joints move by themselves that mimic one that the robot does not have, and tells which.
pub(super) fn free(
    robot: &Robot<'_, '_>,
    mimics: &mut [Option<Located<MimicDescription>>],
    notices: &mut Notices,
) {
    let names: HashSet<&str> = robot.joints.iter().map(|joint| joint.name).collect();
    for (joint, mimic) in robot.joints.iter().zip(mimics) {
        let followed = mimic.as_ref().map(|own| &*own.value.joint.value);
        if followed.is_some_and(|followed| !names.contains(followed)) {
            let message = "joints that mimic one that the robot does not have move by themselves";
            notices.warn(message, format!("joint `{}`", joint.name));
            *mimic = None;
        }
    }
}

/// Names, with those that each leads to.
type Neighbours<'a> = HashMap<&'a str, Vec<&'a str>>;

/// These names and all to which they lead.
fn reached<'a>(mut waiting: Vec<&'a str>, neighbours: &Neighbours<'a>) -> HashSet<&'a str> {
    let mut reached = HashSet::new();
    while let Some(name) = waiting.pop() {
        if reached.insert(name) {
            waiting.extend(neighbours.get(name).into_iter().flatten());
        }
    }
    reached
}

/// Gives each part of a body whose inertia no rigid body has that of a ball with the mean of its principal moments, and tells which.
pub(super) fn balance(
    robot: &Robot<'_, '_>,
    parts: &[Part],
    notices: &mut Notices,
) -> Vec<MassProperties> {
    let balanced = parts.iter().map(|part| {
        if part.mass.check().is_ok() {
            return part.mass;
        }
        let message = "no rigid body has such an inertia: it is taken as that of a ball with the mean of its moments";
        let name = robot.links[part.link].name;
        notices.warn(message, format!("link `{name}`"));
        let moments = part.mass.inertia_com.symmetric_eigenvalues();
        let mean = moments.map(|moment| moment.max(0.0)).mean();
        MassProperties {
            inertia_com: Matrix3::from_diagonal(&Vector3::repeat(mean)),
            ..part.mass
        }
    });
    balanced.collect()
}
