//! Mass properties of a link from its `<inertial>`.

use super::document::number;
use hamel_runtime::spatial::MassProperties;
use nalgebra::{Matrix3, Vector3};
use roxmltree::Node;

/// Mass properties that an `<inertial>` element says, in its own axes.
pub(super) fn of_inertial(inertial: Node<'_, '_>) -> Option<MassProperties> {
    let moment = |name: &str| number(inertial, "inertia", name);
    let [xx, yy, zz] = [moment("ixx")?, moment("iyy")?, moment("izz")?];
    let [xy, xz, yz] = [moment("ixy")?, moment("ixz")?, moment("iyz")?];
    Some(MassProperties {
        mass: number(inertial, "mass", "value")?,
        com: Vector3::zeros(),
        inertia_com: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    })
}
