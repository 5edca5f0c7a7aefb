//! One `[[shape]]`: what stands for a body in pictures.

use super::elements::Bodies;
use super::placement;
use crate::diagnostics::Diagnostic;
use crate::read::{Fields, Sink, Value};
use crate::shape::{Geometry, Mesh, ShapeDescription};
use hamel_runtime::spatial::Pose;
use nalgebra::Vector3;

/// Reads a shape.
pub(super) fn shape(
    fields: &mut Fields<'_>,
    bodies: &Bodies<'_>,
    sink: &mut Sink,
) -> Option<ShapeDescription> {
    let body = fields.required("body", sink);
    let body = body.and_then(|body| bodies.find(&body, sink));
    let geometry = fields.exactly_one(&Geometry::NAMES, sink);
    let geometry = geometry.and_then(|(kind, value)| geometry_of(kind, &value, sink));
    let at = match fields.optional("at") {
        Some(at) => placement::pose(&at, sink).map(|at| at.value),
        None => Some(Pose::identity()),
    };
    let color = match fields.optional("color") {
        Some(color) => rgb(&color, sink).map(Some),
        None => Some(None),
    };
    Some(ShapeDescription {
        body: body?,
        at: at?,
        geometry: geometry?,
        color: color?,
    })
}

fn geometry_of(kind: usize, value: &Value<'_>, sink: &mut Sink) -> Option<Geometry> {
    match kind {
        0 => sides(value, sink).map(Geometry::Box),
        1 => positive(value, sink).map(Geometry::Sphere),
        4 => mesh(value, sink).map(Geometry::Mesh),
        _ => {
            let mut fields = value.table(sink)?;
            let radius = fields.required("radius", sink);
            let radius = radius.and_then(|radius| positive(&radius, sink));
            let length = fields.required("length", sink);
            let length = length.and_then(|length| positive(&length, sink));
            fields.finish(sink);
            let (radius, length) = (radius?, length?);
            Some(match kind {
                2 => Geometry::Cylinder { radius, length },
                _ => Geometry::Capsule { radius, length },
            })
        }
    }
}

fn mesh(value: &Value<'_>, sink: &mut Sink) -> Option<Mesh> {
    let mut fields = value.table(sink)?;
    let file = fields.required("file", sink);
    let file = file.and_then(|file| file.text(sink));
    let scale = match fields.optional("scale") {
        Some(scale) => self::scale(&scale, sink),
        None => Some(Vector3::repeat(1.0)),
    };
    fields.finish(sink);
    Some(Mesh {
        file: file?.value,
        scale: scale?,
    })
}

/// One factor, or one along each axis. A negative one mirrors.
fn scale(value: &Value<'_>, sink: &mut Sink) -> Option<Vector3<f64>> {
    let factor = |value: &Value<'_>, sink: &mut Sink| {
        let number = value.number_within(|number| number != 0.0, "other than 0", sink)?;
        Some(number.value)
    };
    if !value.is_list() {
        return factor(value, sink).map(Vector3::repeat);
    }
    let scale = value.vector(sink)?;
    let items = value.items("entry", "a list of numbers", sink)?;
    let checked: Vec<_> = items.iter().map(|item| factor(item, sink)).collect();
    checked.iter().all(Option::is_some).then_some(scale.value)
}

fn sides(value: &Value<'_>, sink: &mut Sink) -> Option<Vector3<f64>> {
    let sides = value.vector(sink)?;
    let items = value.items("entry", "a list of numbers", sink)?;
    let checked: Vec<_> = items.iter().map(|side| positive(side, sink)).collect();
    checked.iter().all(Option::is_some).then_some(sides.value)
}

fn positive(value: &Value<'_>, sink: &mut Sink) -> Option<f64> {
    let number = value.number_within(|number| number > 0.0, "above 0", sink)?;
    Some(number.value)
}

/// A colour as `#rrggbb`.
fn rgb(value: &Value<'_>, sink: &mut Sink) -> Option<[u8; 3]> {
    let text = value.text(sink)?;
    let digits = text.value.strip_prefix('#').filter(|digits| {
        digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit())
    });
    let Some(number) = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok()) else {
        let message = format!("{} is {:?}, not a colour", value.path(), text.value);
        let error = Diagnostic::new(text.span, message);
        sink.push(
            error.help("write red, green and blue in hexadecimal digits: `color = \"#3377aa\"`"),
        );
        return None;
    };
    let [_, red, green, blue] = number.to_be_bytes();
    Some([red, green, blue])
}
