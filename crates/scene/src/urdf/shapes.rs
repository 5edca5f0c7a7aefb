//! The visual shapes of links: simple ones are kept for pictures. They have no effect on the motion, so nothing in them is a
//! mistake; what cannot be drawn is reported.

use super::document::{child, numbers, parse};
use crate::notice::Notices;
use crate::parse::rotation;
use crate::read::Sink;
use crate::shape::{Geometry, Mesh, ShapeDescription};
use crate::source::Located;
use hamel_runtime::spatial::Pose;
use nalgebra::{Matrix3, Vector3, Vector4};
use roxmltree::Node;
use std::collections::HashMap;

/// The elements of a robot's materials by their names.
type Materials<'a, 'i> = HashMap<&'a str, Node<'a, 'i>>;

/// The shapes of `link`, whose frame stands at `pose` on `body`.
pub(super) fn of_link(
    link: Node<'_, '_>,
    owner: &str,
    materials: &Materials<'_, '_>,
    (body, pose): (Option<usize>, &Pose<f64>),
    notices: &mut Notices,
) -> Vec<ShapeDescription> {
    let visuals = link.children().filter(|node| node.has_tag_name("visual"));
    let shapes = visuals.filter_map(|visual| match shape(visual) {
        Ok((at, geometry)) => Some(ShapeDescription {
            body,
            at: pose.compose(&at),
            geometry,
            color: color(visual, materials),
        }),
        Err(why) => {
            notices.add(why, owner);
            None
        }
    });
    shapes.collect()
}

fn shape(visual: Node<'_, '_>) -> Result<(Pose<f64>, Geometry), &'static str> {
    const ODD: &str = "visual shapes that are not complete are not drawn";
    let geometry = child(visual, "geometry").ok_or(ODD)?;
    let found = geometry.children().find(Node::is_element).ok_or(ODD)?;
    let size = |name: &str| {
        let number = parse(found.attribute(name)?)?;
        (number > 0.0 && number.is_finite()).then_some(number)
    };
    let round = || size("radius").zip(size("length"));
    let geometry = match found.tag_name().name() {
        "box" => found
            .attribute("size")
            .and_then(numbers::<3>)
            .filter(|sides| sides.iter().all(|side| *side > 0.0))
            .map(|sides| Geometry::Box(sides.into())),
        "sphere" => size("radius").map(Geometry::Sphere),
        "cylinder" => round().map(|(radius, length)| Geometry::Cylinder { radius, length }),
        "capsule" => round().map(|(radius, length)| Geometry::Capsule { radius, length }),
        "mesh" => mesh(found).map(Geometry::Mesh),
        _ => {
            return Err(
                "visual shapes other than box, sphere, cylinder, capsule and mesh are not drawn",
            );
        }
    };
    let at = origin(visual).ok_or(ODD)?;
    Ok((at, geometry.ok_or(ODD)?))
}

/// The file of a mesh, with its factors.
fn mesh(element: Node<'_, '_>) -> Option<Mesh> {
    let scale = match element.attribute("scale") {
        Some(scale) => Vector3::from(numbers::<3>(scale)?),
        None => Vector3::repeat(1.0),
    };
    let is_sound = scale
        .iter()
        .all(|factor| factor.is_finite() && *factor != 0.0);
    let file = element
        .attribute("filename")
        .filter(|file| Mesh::is_name(file))?;
    is_sound.then_some(Mesh {
        file: file.to_owned(),
        scale,
    })
}

/// The pose of the shape; the identity without an `<origin>`, `None` where it makes no sense.
fn origin(visual: Node<'_, '_>) -> Option<Pose<f64>> {
    let Some(origin) = child(visual, "origin") else {
        return Some(Pose::identity());
    };
    let or_zero = |name: &str| match origin.attribute(name) {
        Some(text) => numbers::<3>(text).map(Vector3::from),
        None => Some(Vector3::zeros()),
    };
    let rotation = match origin.attribute("quat_xyzw") {
        Some(text) => {
            let [x, y, z, w] = numbers(text)?;
            quiet(|sink| rotation::from_any_quaternion("", at(Vector4::new(w, x, y, z)), sink))
        }
        None => {
            let rpy = or_zero("rpy")?;
            quiet(|sink| rotation::from_roll_pitch_yaw("", at(rpy), sink))
        }
    };
    Some(Pose::new(rotation?, or_zero("xyz")?))
}

/// Reads without telling: an origin that makes no sense leaves the shape out, and that is reported.
fn quiet(read: impl FnOnce(&mut Sink) -> Option<Matrix3<f64>>) -> Option<Matrix3<f64>> {
    read(&mut Sink::default())
}

fn at<T>(value: T) -> Located<T> {
    Located::new(value, 0..0)
}

/// The colour of a visual: its own, or that of the robot's material of its name.
fn color(visual: Node<'_, '_>, materials: &Materials<'_, '_>) -> Option<[u8; 3]> {
    let material = child(visual, "material")?;
    let named = || child(*materials.get(material.attribute("name")?)?, "color");
    let color = child(material, "color").or_else(named)?;
    let [red, green, blue, _] = numbers(color.attribute("rgba")?)?;
    let byte = |part: f64| (part.clamp(0.0, 1.0) * 255.0).round() as u8;
    Some([byte(red), byte(green), byte(blue)])
}
