//! What links weigh.

use super::content::Content;
use super::document::{attribute, attribute_node, child, number, pose, switch};
use crate::diagnostics::Diagnostic;
use crate::notice::Notices;
use crate::read::Sink;
use crate::robot::mass::moved;
use crate::robot::xml::tag;
use hamel_runtime::spatial::MassProperties;
use nalgebra::{Matrix3, Vector3};

/// The mass properties of a link in its frame. What the file does not say is 1 kg at the origin and 1 kg m² about each axis, as SDF has it.
pub(super) fn of_link(
    content: &Content<'_, '_>,
    link: usize,
    notices: &mut Notices,
    sink: &mut Sink,
) -> Option<MassProperties> {
    let (owner, node) = (content.called(link), content.entities[link].node);
    let Some(inertial) = child(node, "inertial") else {
        notices.warn(
            "links without <inertial> weigh 1 kg, with 1 kg m² about each axis, as SDF has it",
            owner,
        );
        return Some(of_default());
    };
    if attribute(inertial, "auto").and_then(switch) == Some(true) {
        let message = format!("{owner}: masses of collision shapes are not computed");
        let error = Diagnostic::new(tag(inertial), message);
        sink.push(error.help("say <mass> and <inertia>, and leave `auto` out"));
        return None;
    }
    let base = child(inertial, "pose").and_then(|pose| attribute_node(pose, "relative_to"));
    if let Some(base) = base.filter(|base| !base.value().is_empty()) {
        let message = format!(
            "{owner}: the <pose> of <inertial> is that in the link, and relative to nothing else"
        );
        sink.push(Diagnostic::new(base.range_value(), message));
        return None;
    }
    let inertia = child(inertial, "inertia");
    let says = |name: &str| inertia.is_some_and(|inertia| child(inertia, name).is_some());
    if !["ixx", "iyy", "izz"].into_iter().all(says) {
        notices.warn(
            "moments of inertia that are not said are 1 kg m², as SDF has it",
            owner.clone(),
        );
    }
    if child(inertial, "mass").is_none() {
        notices.warn(
            "masses that are not said are 1 kg, as SDF has it",
            owner.clone(),
        );
    }
    let moment = |name: &str, default: f64| {
        inertia
            .and_then(|inertia| number(inertia, name))
            .unwrap_or(default)
    };
    let [xx, yy, zz] = ["ixx", "iyy", "izz"].map(|name| moment(name, 1.0));
    let [xy, xz, yz] = ["ixy", "ixz", "iyz"].map(|name| moment(name, 0.0));
    let own = MassProperties {
        mass: number(inertial, "mass").unwrap_or(1.0),
        com: Vector3::zeros(),
        inertia_com: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    };
    let at = pose(&format!("{owner}: <inertial>"), inertial, sink)?;
    let mass = moved(&own, &at);
    if let Err(error) = mass.check() {
        sink.push(Diagnostic::new(tag(inertial), format!("{owner}: {error}")));
        return None;
    }
    Some(mass)
}

fn of_default() -> MassProperties {
    MassProperties {
        mass: 1.0,
        com: Vector3::zeros(),
        inertia_com: Matrix3::identity(),
    }
}
