//! The visual shapes of links: simple ones are kept for pictures. They have no effect on the motion, so nothing in them is a mistake; what cannot be drawn is reported.

use super::content::Content;
use super::document::{child, children, number, pose, value, vector};
use super::poses::Poses;
use crate::notice::Notices;
use crate::read::Sink;
use crate::robot::xml::finite;
use crate::shape::{Geometry, Mesh, ShapeDescription};
use hamel_runtime::spatial::Pose;
use nalgebra::Vector3;
use roxmltree::Node;

/// The shapes of a link, whose frame stands at `at` on `body`.
pub(super) fn of_link(
    content: &Content<'_, '_>,
    poses: &Poses,
    link: usize,
    (body, at): (Option<usize>, &Pose<f64>),
    notices: &mut Notices,
) -> Vec<ShapeDescription> {
    let visuals = children(content.entities[link].node, "visual");
    let shapes = visuals.filter_map(|visual| {
        let placed = place(content, poses, link, visual);
        match placed.zip(geometry(visual)) {
            Some((pose, geometry)) => Some(ShapeDescription {
                body,
                at: at.compose(&pose),
                geometry,
                color: color(visual),
            }),
            None => {
                let message = "visual shapes other than box, sphere, cylinder, capsule and mesh, and those that are not complete, are not drawn";
                notices.add(message, content.called(link));
                None
            }
        }
    });
    shapes.collect()
}

/// The pose of a shape in the frame of its link.
fn place(
    content: &Content<'_, '_>,
    poses: &Poses,
    link: usize,
    visual: Node<'_, '_>,
) -> Option<Pose<f64>> {
    let quiet = &mut Sink::default();
    let own = pose("", visual, quiet)?;
    let mut told = Sink::default();
    let base = content.base_of_pose(link, visual, &mut told);
    let base = base.or((told.len() == 0).then_some(link))?;
    Some(poses.of(base, link) * own)
}

fn geometry(visual: Node<'_, '_>) -> Option<Geometry> {
    let geometry = child(visual, "geometry")?;
    let found = geometry.children().find(Node::is_element)?;
    let size = |name: &str| number(found, name).filter(|size| *size > 0.0 && size.is_finite());
    let round = || size("radius").zip(size("length"));
    match found.tag_name().name() {
        "box" => vector(found, "size")
            .filter(|sides| sides.iter().all(|side| *side > 0.0))
            .map(Geometry::Box),
        "sphere" => size("radius").map(Geometry::Sphere),
        "cylinder" => round().map(|(radius, length)| Geometry::Cylinder { radius, length }),
        "capsule" => round().map(|(radius, length)| Geometry::Capsule { radius, length }),
        "mesh" => mesh(found).map(Geometry::Mesh),
        _ => None,
    }
}

/// The file of a mesh, with its factors.
fn mesh(element: Node<'_, '_>) -> Option<Mesh> {
    let scale = match child(element, "scale") {
        Some(_) => vector(element, "scale")?,
        None => Vector3::repeat(1.0),
    };
    let is_sound = scale.iter().all(|factor| *factor != 0.0);
    let file = value(element, "uri").filter(|file| Mesh::is_name(file))?;
    is_sound.then(|| Mesh {
        file: file.to_owned(),
        scale,
    })
}

/// The colour of a visual: what it scatters, or else what it shows in all light.
fn color(visual: Node<'_, '_>) -> Option<[u8; 3]> {
    let material = child(visual, "material")?;
    let said = value(material, "diffuse").or(value(material, "ambient"))?;
    let parts = finite(said)?;
    let [red, green, blue, ..] = parts.as_slice() else {
        return None;
    };
    let byte = |part: &f64| (part.clamp(0.0, 1.0) * 255.0).round() as u8;
    Some([byte(red), byte(green), byte(blue)])
}
