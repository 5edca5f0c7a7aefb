//! What [`Options::lenient`](super::Options::lenient) changes of a robot whose masses no rigid bodies have.

use super::document::attribute;
use super::mass;
use super::masses::Part;
use super::robot::{JointType, Robot};
use crate::notice::Notices;
use crate::robot::mass::is_nothing;
use hamel_runtime::spatial::MassProperties;
use nalgebra::{Matrix3, Vector3};
use std::collections::{HashMap, HashSet};

/// Fixes the joints below which nothing has mass, and tells which. Loops, couplings and followers may hold what hangs on them: those joints stay as they are.
pub(super) fn fix_massless(robot: &mut Robot<'_, '_>, notices: &mut Notices) {
    let above: HashMap<&str, &str> = robot
        .joints
        .iter()
        .map(|joint| (joint.child, joint.parent))
        .collect();
    // A joint that another one follows moves what hangs on that.
    let moved: HashMap<&str, &str> = robot
        .joints
        .iter()
        .map(|joint| (joint.name, joint.child))
        .collect();
    let led_by: HashMap<&str, &str> = robot
        .joints
        .iter()
        .filter_map(|joint| {
            Some((
                joint.child,
                *moved.get(attribute(joint.node, "mimic", "joint")?)?,
            ))
        })
        .collect();
    let ties = robot.loops.iter().chain(&robot.couplings);
    let tied = ties
        .flat_map(|tie| tie.children())
        .filter_map(|end| end.attribute("link"));
    let links = robot.links.iter().filter(|link| {
        let own = link.inertial().and_then(mass::of_inertial);
        own.is_some_and(|own| !is_nothing(&own))
    });
    let mut waiting: Vec<&str> = links.map(|link| link.name).chain(tied).collect();
    let mut carried = HashSet::new();
    while let Some(link) = waiting.pop() {
        if carried.insert(link) {
            waiting.extend([&above, &led_by].iter().filter_map(|next| next.get(link)));
        }
    }
    let moves_nothing = robot
        .joints
        .iter_mut()
        .filter(|joint| joint.kind != JointType::Fixed && !carried.contains(joint.child));
    for joint in moves_nothing {
        joint.kind = JointType::Fixed;
        let message = "joints that move nothing with mass are fixed";
        notices.warn(message, format!("joint `{}`", joint.name));
    }
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
