//! Elements of an SDF: their values are texts, and where they stand.

use crate::parse::rotation;
use crate::read::Sink;
use crate::robot::xml::{finite, parse, tag};
use crate::source::{Located, Span};
use hamel_runtime::spatial::Pose;
use nalgebra::{Vector3, Vector4};
use roxmltree::{Attribute, Node};

/// Whether this is the element of SDF of that name; those of others have namespaces of their own.
pub(super) fn is(node: Node<'_, '_>, name: &str) -> bool {
    node.tag_name().name() == name && is_of_sdf(node)
}

/// Whether this is an element of SDF: in the namespace of the root, if that has one.
pub(super) fn is_of_sdf(node: Node<'_, '_>) -> bool {
    let root = node.document().root_element();
    node.is_element() && node.tag_name().namespace() == root.tag_name().namespace()
}

/// An attribute of SDF, which has no namespace.
pub(super) fn attribute_node<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Attribute<'a, 'i>> {
    let mut all = node.attributes();
    all.find(|found| found.name() == name && found.namespace().is_none())
}

/// The text of an attribute of SDF.
pub(super) fn attribute<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    attribute_node(node, name).map(|found| found.value())
}

/// The first child element of that name.
pub(super) fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| is(*child, name))
}

/// The child elements of that name.
pub(super) fn children<'a, 'i>(
    node: Node<'a, 'i>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |child| is(*child, name))
}

/// The text of an element, without comments before it and white space around it.
pub(super) fn text<'a>(node: Node<'a, '_>) -> &'a str {
    let texts = node.children().filter(|child| child.is_text());
    let mut texts = texts.filter_map(|text| text.text().map(str::trim));
    texts.find(|text| !text.is_empty()).unwrap_or_default()
}

/// The text of a child element.
pub(super) fn value<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    child(node, name).map(text)
}

/// The number in a child element.
pub(super) fn number(node: Node<'_, '_>, name: &str) -> Option<f64> {
    parse(value(node, name)?)
}

/// The switch in a child element.
pub(super) fn flag(node: Node<'_, '_>, name: &str) -> Option<bool> {
    switch(value(node, name)?)
}

/// The three numbers in a child element.
pub(super) fn vector(node: Node<'_, '_>, name: &str) -> Option<Vector3<f64>> {
    let numbers: [f64; 3] = finite(value(node, name)?)?.try_into().ok()?;
    Some(numbers.into())
}

/// `true`, `false`, `1` or `0`.
pub(super) fn switch(text: &str) -> Option<bool> {
    match text {
        "1" => Some(true),
        "0" => Some(false),
        text if text.eq_ignore_ascii_case("true") => Some(true),
        text if text.eq_ignore_ascii_case("false") => Some(false),
        _ => None,
    }
}

/// Where the text of a child element stands; failing that the child's tag, or the element's own.
pub(super) fn place(node: Node<'_, '_>, name: &str) -> Span {
    child(node, name).map_or_else(|| tag(node), text_span)
}

/// Where the text of an element stands; its tag where it has none.
pub(super) fn text_span(node: Node<'_, '_>) -> Span {
    let texts = node.children().filter(|child| child.is_text());
    for found in texts {
        let range = found.range();
        let raw = &node.document().input_text()[range.clone()];
        let trimmed = raw.trim();
        if !trimmed.is_empty() {
            let start = range.start + (raw.len() - raw.trim_start().len());
            return start..start + trimmed.len();
        }
    }
    tag(node)
}

/// Where the name of an element stands.
pub(super) fn name_span(node: Node<'_, '_>) -> Span {
    let name = attribute_node(node, "name");
    name.map_or_else(|| tag(node), |name| name.range_value())
}

/// The pose that the `<pose>` inside `node` says; the identity without one. Messages begin with `owner`.
pub(super) fn pose(owner: &str, node: Node<'_, '_>, sink: &mut Sink) -> Option<Pose<f64>> {
    let Some(element) = child(node, "pose") else {
        return Some(Pose::identity());
    };
    let path = format!("{owner}: <pose>");
    let at = text_span(element);
    match finite(text(element))?.as_slice() {
        [] => Some(Pose::identity()),
        &[x, y, z, roll, pitch, yaw] => {
            let degrees = attribute(element, "degrees").and_then(switch) == Some(true);
            let scale = if degrees { 1f64.to_radians() } else { 1.0 };
            let rpy = Located::new(Vector3::new(roll, pitch, yaw) * scale, at);
            let rotation = rotation::from_roll_pitch_yaw(&path, rpy, sink)?;
            Some(Pose::new(rotation, Vector3::new(x, y, z)))
        }
        &[x, y, z, qx, qy, qz, qw] => {
            let wxyz = Located::new(Vector4::new(qw, qx, qy, qz), at);
            let rotation = rotation::from_any_quaternion(&path, wxyz, sink)?;
            Some(Pose::new(rotation, Vector3::new(x, y, z)))
        }
        _ => None,
    }
}
