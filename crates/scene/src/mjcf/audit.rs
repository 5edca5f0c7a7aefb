//! Compares a document with the schema: all errors at once. What it finds sound is then read from the same tree.

use super::element::Lines;
use super::schema::{self, Kind, Tag};
use crate::diagnostics::Diagnostic;
use crate::read::Sink;
use crate::robot::xml::{finite, tag};
use crate::suggest::{nearest, one_of};
use crate::text::{no_name, quoted, visible_line};
use roxmltree::{Attribute, Node};

/// Elements that make bodies out of what they say, in ways that are not read: without them this would be another mechanism.
const BUILDERS: [&str; 4] = ["composite", "flexcomp", "replicate", "attach"];

/// What becomes of them.
const EXPAND: &str = "MuJoCo writes the model with its bodies in their place: \
    `mujoco.mj_saveLastXML('expanded.xml', mujoco.MjModel.from_xml_path('robot.xml'))`, after `pip install mujoco`";

/// Elements that may stand once in another.
const ONCE: [&str; 2] = ["inertial", "flag"];

/// Notes all that is wrong in the document of that root.
pub(super) fn audit(root: Node<'_, '_>, lines: &Lines, sink: &mut Sink) {
    let Some(schema) = schema::tag("", "mujoco") else {
        return;
    };
    let mut open = vec![(root, schema)];
    while let Some((node, schema)) = open.pop() {
        attributes(node, schema, sink);
        let mut once: Vec<(&str, Node<'_, '_>)> = Vec::new();
        for child in node.children().filter(Node::is_element) {
            let name = child.tag_name().name();
            if let Some((_, first)) = once.iter().find(|(known, _)| *known == name) {
                second(child, *first, sink);
            } else if ONCE.contains(&name) {
                once.push((name, child));
            }
            if let Some(schema) = known(child, (node, schema), lines, sink) {
                open.push((child, schema));
            }
        }
    }
}

/// What is looked into of a child; an error where there is no such element.
fn known(
    child: Node<'_, '_>,
    (node, schema): (Node<'_, '_>, &Tag),
    lines: &Lines,
    sink: &mut Sink,
) -> Option<&'static Tag> {
    let (name, inside) = (child.tag_name().name(), node.tag_name().name());
    let mut children = schema.children.split_whitespace();
    if name == "include" {
        let error = Diagnostic::new(tag(child), "<include> names a file that has not been read");
        sink.push(
            error.help("a model with includes is read from its file, with the files beside it"),
        );
        return None;
    }
    if BUILDERS.contains(&name) && children.clone().any(|known| known == name) {
        let message = format!("<{name}> makes bodies in a way that is not read");
        sink.push(Diagnostic::new(tag(child), message).help(EXPAND));
        return None;
    }
    if child.tag_name().namespace().is_none() && children.any(|known| known == name) {
        return schema::tag(inside, name);
    }
    let line = lines.of(child.range().start);
    let message = format!(
        "there is no element <{}> in <{inside}>, in line {line}",
        visible_line(name)
    );
    let error = Diagnostic::new(tag(child), message);
    sink.push(match nearest(name, schema.children.split_whitespace()) {
        Some(near) => error.label(format!("did you mean <{near}>?")),
        None => error.help(format!(
            "MuJoCo knows {}",
            one_of(schema.children.split_whitespace())
        )),
    });
    None
}

fn second(node: Node<'_, '_>, first: Node<'_, '_>, sink: &mut Sink) {
    let message = format!("there are two <{}>", node.tag_name().name());
    let error = Diagnostic::new(tag(node), message).label("the second one");
    sink.push(error.context(tag(first), "the first one"));
}

fn attributes(node: Node<'_, '_>, schema: &Tag, sink: &mut Sink) {
    let element = node.tag_name().name();
    for attribute in node.attributes() {
        let name = attribute.name();
        let mut all = schema.attributes.split_whitespace();
        if !all.any(|known| known == name) {
            unknown(element, attribute, schema, sink);
            continue;
        }
        let read = schema.read.iter().find(|(known, _)| *known == name);
        let refused = read.and_then(|(_, kind)| refusal(attribute.value(), *kind));
        if let Some((why, hint)) = refused {
            let value = quoted(attribute.value());
            let message = format!("`{name}` of <{element}> is {value}, {why}");
            let error = Diagnostic::new(attribute.range_value(), message);
            sink.push(match hint {
                Some(hint) => error.label(hint),
                None => error,
            });
        }
    }
    for name in schema
        .required
        .iter()
        .filter(|name| !node.has_attribute(**name))
    {
        let message = format!("<{element}> has no attribute `{name}`");
        sink.push(Diagnostic::new(tag(node), message));
    }
}

fn unknown(element: &str, attribute: Attribute<'_, '_>, schema: &Tag, sink: &mut Sink) {
    let name = visible_line(attribute.name());
    let message = format!("there is no attribute `{name}` of <{element}>");
    let error = Diagnostic::new(attribute.range_qname(), message);
    sink.push(match nearest(&name, schema.attributes.split_whitespace()) {
        Some(near) => error.label(format!("did you mean `{near}`?")),
        None => error,
    });
}

/// Why the text of an attribute is refused, and a hint.
fn refusal(text: &str, kind: Kind) -> Option<(String, Option<String>)> {
    match kind {
        Kind::Name => no_name(text).map(|why| (why, None)),
        Kind::Numbers(least, most) => {
            let sound = finite(text).is_some_and(|all| (least..=most).contains(&all.len()));
            let why = match (least, most) {
                (1, 1) => String::from("not a finite number"),
                (least, most) if least == most => format!("not {least} finite numbers"),
                (least, most) => format!("not {least} to {most} finite numbers"),
            };
            (!sound).then_some((why, None))
        }
        Kind::Choice(words) if words.contains(&text) => None,
        Kind::Choice(words) => {
            let near = nearest(text, words.iter().copied());
            let why = format!("but must be {}", one_of(words.iter().copied()));
            Some((why, near.map(|near| format!("did you mean `{near}`?"))))
        }
        Kind::Sequence => {
            let sound = text.len() == 3 && text.chars().all(|c| "xyzXYZ".contains(c));
            (!sound).then(|| {
                (
                    String::from("not three letters of x, y, z, X, Y and Z"),
                    None,
                )
            })
        }
    }
}
