//! Each `[[shape]]`.

use super::body::name_of;
use super::value::{list, number, table, text};
use super::{entry, pose};
use crate::description::SceneDescription;
use crate::shape::{Geometry, Mesh};
use nalgebra::Vector3;

/// Appends the shapes.
pub(super) fn shapes(out: &mut String, scene: &SceneDescription) {
    for shape in &scene.shapes {
        out.push_str("\n[[shape]]\n");
        entry(out, "body", &text(name_of(shape.body, &scene.bodies)));
        let (key, value) = geometry(&shape.geometry);
        entry(out, key, &value);
        if let Some(at) = pose::pose(&shape.at) {
            entry(out, "at", &at);
        }
        if let Some([red, green, blue]) = shape.color {
            let color = format!("#{red:02x}{green:02x}{blue:02x}");
            entry(out, "color", &text(&color));
        }
    }
}

fn geometry(geometry: &Geometry) -> (&'static str, String) {
    let round = |radius, length| table(&[("radius", number(radius)), ("length", number(length))]);
    match *geometry {
        Geometry::Box(sides) => ("box", list(&sides)),
        Geometry::Sphere(radius) => ("sphere", number(radius)),
        Geometry::Mesh(ref mesh) => ("mesh", self::mesh(mesh)),
        Geometry::Cylinder { radius, length } => ("cylinder", round(radius, length)),
        Geometry::Capsule { radius, length } => ("capsule", round(radius, length)),
    }
}

fn mesh(mesh: &Mesh) -> String {
    let mut entries = vec![("file", text(&mesh.file))];
    let scale = mesh.scale;
    if scale != Vector3::repeat(scale.x) {
        entries.push(("scale", list(&scale)));
    } else if scale.x != 1.0 {
        entries.push(("scale", number(scale.x)));
    }
    table(&entries)
}
