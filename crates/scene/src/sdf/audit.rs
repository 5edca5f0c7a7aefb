//! Compares a document with the schema: all errors at once, and notices of what is not read. What it finds sound is then read from the same tree.

use super::document::{attribute, attribute_node, is, is_of_sdf, switch, text, text_span};
use super::schema::{self, Kind, NOT_READ, REFUSED, SEVERAL, SILENT, Tag};
use crate::diagnostics::Diagnostic;
use crate::notice::Notices;
use crate::read::Sink;
use crate::robot::xml::{finite, parse, tag};
use crate::suggest::nearest;
use crate::text::{no_name, quoted, visible_line};
use roxmltree::{Attribute, Node};
use std::collections::HashMap;

/// Models in models beyond which a file is refused.
const DEEPEST: usize = 32;

/// Notes all that is wrong in the document of that root, and what is not read of it.
pub(super) fn audit(root: Node<'_, '_>, notices: &mut Notices, sink: &mut Sink) {
    let Some(schema) = schema::of("sdf", "") else {
        return;
    };
    let mut open = vec![(root, schema, String::new(), 0)];
    while let Some((node, schema, owner, depth)) = open.pop() {
        attributes(node, schema, &owner, notices, sink);
        value(node, schema.kind, &owner, sink);
        missing(node, schema, &owner, sink);
        let mut first: HashMap<&str, Node<'_, '_>> = HashMap::new();
        let mut below = Vec::new();
        for child in node.children().filter(Node::is_element) {
            let name = child.tag_name().name();
            if !is_of_sdf(child) {
                let owner = if owner.is_empty() {
                    "<sdf>"
                } else {
                    owner.trim_end_matches(": ")
                };
                notices.add("elements of other namespaces are not read", owner);
                continue;
            }
            let known = words(schema.children).any(|known| known == name);
            let tag_of = schema::of(name, schema.name).filter(|_| known);
            let Some(found) = tag_of else {
                not_read(child, schema, &owner, notices, sink);
                continue;
            };
            if !SEVERAL.contains(&name) {
                if let Some(first) = first.get(name) {
                    second(child, *first, &owner, sink);
                    continue;
                }
                first.insert(name, child);
            }
            let depth = depth + usize::from(name == "model");
            if depth > DEEPEST {
                let message = format!("models stand in models, more than {DEEPEST} deep");
                sink.push(Diagnostic::new(tag(child), message));
                continue;
            }
            below.push((child, found, owner_of(child, &owner), depth));
        }
        open.extend(below.into_iter().rev());
    }
}

/// The words of a list, without the mark of those that must be there.
fn words(list: &'static str) -> impl Iterator<Item = &'static str> {
    list.split_whitespace()
        .map(|word| word.trim_start_matches('!'))
}

/// The words of a list that must be there.
fn required(list: &'static str) -> impl Iterator<Item = &'static str> {
    list.split_whitespace()
        .filter_map(|word| word.strip_prefix('!'))
}

fn second(node: Node<'_, '_>, first: Node<'_, '_>, owner: &str, sink: &mut Sink) {
    let message = format!("{owner}there are two <{}>", node.tag_name().name());
    let error = Diagnostic::new(tag(node), message).label("the second one");
    sink.push(error.context(tag(first), "the first one"));
}

fn missing(node: Node<'_, '_>, schema: &Tag, owner: &str, sink: &mut Sink) {
    for name in required(schema.children) {
        if !node.children().any(|child| is(child, name)) {
            let message = format!("{owner}<{}> has no <{name}>", schema.name);
            sink.push(Diagnostic::new(tag(node), message));
        }
    }
}

/// An element that the schema does not have here.
fn not_read(node: Node<'_, '_>, schema: &Tag, owner: &str, notices: &mut Notices, sink: &mut Sink) {
    let name = node.tag_name().name();
    let element = match owner {
        "" => format!("<{}>", schema.name),
        owner => owner.trim_end_matches(": ").to_owned(),
    };
    if SILENT.contains(&name) {
        return;
    }
    if let Some((_, message)) = NOT_READ.iter().find(|(known, _)| *known == name) {
        return notices.add(*message, element);
    }
    if name == "include" && schema.name == "world" {
        let uri = node.children().find(|child| is(*child, "uri"));
        let file = uri.map_or("", text);
        let message = "models that <include> names in a world are left out";
        return notices.warn(message, format!("`{}`", visible_line(file)));
    }
    if let Some((_, why, help)) = REFUSED.iter().find(|(known, _, _)| *known == name) {
        let error = Diagnostic::new(tag(node), format!("{owner}{why}"));
        return sink.push(error.help(*help));
    }
    let hint = match nearest(name, words(schema.children)) {
        Some(near) => format!(" (did you mean <{near}>?)"),
        None => String::new(),
    };
    let message = format!(
        "elements <{}> in <{}> are not read{hint}",
        visible_line(name),
        schema.name
    );
    match hint.is_empty() {
        true => notices.add(message, element),
        false => notices.warn(message, element),
    }
}

fn attributes(
    node: Node<'_, '_>,
    schema: &Tag,
    owner: &str,
    notices: &mut Notices,
    sink: &mut Sink,
) {
    let element = schema.name;
    for name in required(schema.attributes) {
        match attribute_node(node, name) {
            None => {
                let message = format!("{owner}<{element}> has no attribute `{name}`");
                sink.push(Diagnostic::new(tag(node), message));
            }
            Some(found) => {
                if let Some(why) = no_name(found.value()) {
                    let value = quoted(found.value());
                    let message = format!("{owner}`{name}` of <{element}> is {value}, {why}");
                    sink.push(Diagnostic::new(found.range_value(), message));
                }
            }
        }
    }
    let own = |found: &Attribute<'_, '_>| found.namespace().is_none();
    for attribute in node.attributes().filter(own) {
        let name = attribute.name();
        let refused = REFUSED.iter().find(|(known, _, _)| *known == name);
        if let Some((_, why, help)) = refused.filter(|_| !attribute.value().is_empty()) {
            let error = Diagnostic::new(attribute.range_value(), format!("{owner}{why}"));
            sink.push(error.help(*help));
        } else if !words(schema.attributes).any(|known| known == name) {
            let hint = match nearest(name, words(schema.attributes)) {
                Some(near) => format!(" (did you mean `{near}`?)"),
                None => String::new(),
            };
            let name = visible_line(name);
            let message = format!("attributes `{name}` of <{element}> are not read{hint}");
            let at = owner.trim_end_matches(": ");
            notices.add(message, if at.is_empty() { "<sdf>" } else { at });
        }
    }
}

fn value(node: Node<'_, '_>, kind: Kind, owner: &str, sink: &mut Sink) {
    let said = text(node);
    let Some(why) = refusal(node, said, kind) else {
        return;
    };
    let message = format!(
        "{owner}<{}> is {}, {why}",
        node.tag_name().name(),
        quoted(said)
    );
    sink.push(Diagnostic::new(text_span(node), message));
}

/// Why the text of an element is refused.
fn refusal(node: Node<'_, '_>, said: &str, kind: Kind) -> Option<String> {
    let refused = |sound: bool, why: &str| (!sound).then(|| why.to_owned());
    let count = |said: &str| finite(said).map(|numbers| numbers.len());
    match kind {
        Kind::Elements => refused(said.is_empty(), "but it holds elements only"),
        Kind::Name => no_name(said),
        Kind::Number => refused(count(said) == Some(1), "not a finite number"),
        Kind::Bound => refused(
            parse(said).is_some_and(|number| !number.is_nan()),
            "not a number",
        ),
        Kind::Switch => refused(switch(said).is_some(), "but must be true or false"),
        Kind::Vector => refused(count(said) == Some(3), "not 3 finite numbers"),
        Kind::Pose => {
            let turned = attribute(node, "rotation_format").unwrap_or("euler_rpy");
            let wanted = match turned {
                "euler_rpy" => 6,
                "quat_xyzw" => 7,
                _ => {
                    return Some(format!(
                        "in the rotation format {}, which is not known",
                        quoted(turned)
                    ));
                }
            };
            let sound = count(said).is_some_and(|count| count == wanted || count == 0);
            refused(sound, &format!("not {wanted} finite numbers"))
        }
    }
}

/// Links, joints, frames and models begin the messages about what is in them.
fn owner_of(node: Node<'_, '_>, owner: &str) -> String {
    let kind = node.tag_name().name();
    match (SEVERAL.contains(&kind), attribute(node, "name")) {
        (true, Some(name)) => format!("{kind} `{}`: ", visible_line(name)),
        _ => owner.to_owned(),
    }
}
