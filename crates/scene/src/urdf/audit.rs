//! Compares a document with the schema: all errors at once, and notices of what is not read. What it finds sound is then read from
//! the same tree.

use super::document::{finite, parse, tag};
use super::schema::{Attribute, Child, Element, Kind, NOT_READ, Need, SHOWN, STRICT};
use crate::diagnostics::Diagnostic;
use crate::notice::Notices;
use crate::read::Sink;
use crate::suggest::{nearest, one_of};
use crate::text::{no_name, quoted, visible_line};
use hamel_runtime::shown::Number;
use roxmltree::Node;
use std::collections::HashMap;

/// The elements of one name in one element, as far as they have been read.
struct Seen<'a, 'i> {
    first: Node<'a, 'i>,
    count: usize,
}

/// Reads a document element by element.
pub(super) struct Audit<'s> {
    /// Errors.
    pub(super) sink: &'s mut Sink,
    /// What is not read.
    pub(super) notices: &'s mut Notices,
    /// Major and minor version of URDF.
    pub(super) version: (u32, u32),
}

impl Audit<'_> {
    /// Reads the root, which has the name of `schema`.
    pub(super) fn root(&mut self, node: Node<'_, '_>, schema: &Element) {
        self.element(node, schema, "");
    }

    /// Reads `node`, which has the name of `schema`. Messages begin with `owner`.
    fn element(&mut self, node: Node<'_, '_>, schema: &Element, owner: &str) {
        for attribute in schema.attributes {
            self.attribute(node, attribute, owner);
        }
        self.unknown_attributes(node, schema, owner);
        if schema.name == "limit" && self.version >= (1, 2) {
            self.limits(node, owner);
        }
        self.text(node, owner);
        // Counted on the way: to look for others of its name from each child would take work in squares.
        let mut seen = HashMap::new();
        for child in node.children().filter(Node::is_element) {
            let name = child.tag_name();
            let first = Seen {
                first: child,
                count: 0,
            };
            let seen = seen.entry((name.namespace(), name.name())).or_insert(first);
            seen.count += 1;
            self.child(child, seen, schema, owner);
        }
        self.missing_children(node, schema, owner);
    }

    fn child(&mut self, node: Node<'_, '_>, seen: &Seen<'_, '_>, schema: &Element, owner: &str) {
        let name = node.tag_name().name();
        let known = schema
            .children
            .iter()
            .find(|child| child.element.name == name && node.tag_name().namespace().is_none());
        let Some(child) = known else {
            return self.not_read(node, seen.count, schema, owner);
        };
        match seen.count > 1 && !child.several {
            true => self.second(node, seen.first, owner),
            false => self.element(node, child.element, &owner_of(node, seen.count, owner)),
        }
    }

    fn second(&mut self, node: Node<'_, '_>, first: Node<'_, '_>, owner: &str) {
        let message = format!("{owner}there are two <{}>", node.tag_name().name());
        let error = Diagnostic::new(tag(node), message).label("the second one");
        self.sink.push(error.context(tag(first), "the first one"));
    }

    fn missing_children(&mut self, node: Node<'_, '_>, schema: &Element, owner: &str) {
        let is_there = |child: &Child| {
            let mut children = node.children();
            children.any(|found| found.has_tag_name(child.element.name))
        };
        for child in schema.children {
            if child.need == Need::Required && !is_there(child) {
                let (name, inside) = (child.element.name, schema.name);
                let message = format!("{owner}<{inside}> has no <{name}>");
                self.sink.push(Diagnostic::new(tag(node), message));
            }
        }
    }

    /// An element that the schema does not have here.
    fn not_read(&mut self, node: Node<'_, '_>, place: usize, schema: &Element, owner: &str) {
        let name = node.tag_name().name();
        if SHOWN.contains(&name) {
            return;
        }
        let element = match owner {
            "" => named(node, place),
            owner => owner.trim_end_matches(": ").to_owned(),
        };
        if let Some((_, message)) = NOT_READ.iter().find(|(known, _)| *known == name) {
            return self.notices.add(*message, element);
        }
        let known = schema.children.iter().map(|child| child.element.name);
        let hint = match nearest(name, known) {
            Some(near) => format!(" (did you mean <{near}>?)"),
            None => String::new(),
        };
        let message = format!(
            "elements <{}> in <{}> are not read{hint}",
            visible_line(name),
            schema.name
        );
        match STRICT.contains(&schema.name) {
            true => {
                let error = Diagnostic::new(tag(node), format!("{owner}{message}"));
                self.sink
                    .push(error.help("without it this would be another mechanism"));
            }
            false => self.notices.add(message, element),
        }
    }

    fn unknown_attributes(&mut self, node: Node<'_, '_>, schema: &Element, owner: &str) {
        for attribute in node.attributes() {
            let known = schema.attributes.iter().map(|known| known.name);
            if known.clone().any(|name| name == attribute.name()) {
                continue;
            }
            let hint = match nearest(attribute.name(), known) {
                Some(near) => format!(" (did you mean `{near}`?)"),
                None => String::new(),
            };
            let name = visible_line(attribute.name());
            let message = format!(
                "attributes `{name}` of <{}> are not read{hint}",
                schema.name
            );
            let element = owner.trim_end_matches(": ");
            let element = if element.is_empty() {
                "<robot>"
            } else {
                element
            };
            self.notices.add(message, element);
        }
    }

    fn attribute(&mut self, node: Node<'_, '_>, attribute: &Attribute, owner: &str) {
        let (name, element) = (attribute.name, node.tag_name().name());
        let Some(found) = node.attribute_node(name) else {
            let needed = match attribute.need {
                Need::Optional => false,
                Need::Required => true,
                Need::Before12 => self.version < (1, 2),
            };
            if needed {
                let message = format!("{owner}<{element}> has no attribute `{name}`");
                self.sink.push(Diagnostic::new(tag(node), message));
            }
            return;
        };
        let value = found.value();
        let Some((why, hint)) = refusal(value, attribute.kind) else {
            return;
        };
        let path = format!("{owner}`{name}` of <{element}>");
        let message = format!("{path} is {}, {why}", quoted(value));
        let error = Diagnostic::new(found.range_value(), message);
        self.sink.push(match hint {
            Some(hint) => error.label(hint),
            None => error,
        });
    }

    /// Since version 1.2 limits must make sense; before, URDF does not say so.
    fn limits(&mut self, node: Node<'_, '_>, owner: &str) {
        let number = |name: &str| node.attribute(name).and_then(parse);
        let place = |name: &str| {
            node.attribute_node(name)
                .map_or(tag(node), |a| a.range_value())
        };
        if let (Some(lower), Some(upper)) = (number("lower"), number("upper"))
            && lower > upper
        {
            let message = format!(
                "{owner}`lower` is {:?}, above `upper`, which is {:?}",
                Number(lower),
                Number(upper)
            );
            self.sink.push(Diagnostic::new(place("lower"), message));
        }
        for name in ["effort", "velocity", "acceleration", "deceleration", "jerk"] {
            if let Some(value) = number(name).filter(|value| *value < 0.0) {
                let message = format!(
                    "{owner}`{name}` is {:?}, but must be at least 0",
                    Number(value)
                );
                self.sink.push(Diagnostic::new(place(name), message));
            }
        }
    }

    fn text(&mut self, node: Node<'_, '_>, owner: &str) {
        let mut texts = node.children().filter(|child| child.is_text());
        let stray = texts.find(|text| text.text().is_some_and(|text| !text.trim().is_empty()));
        if let Some(stray) = stray {
            // As it is written: entities are longer than what they stand for.
            let range = stray.range();
            let raw = &node.document().input_text()[range.clone()];
            let start = range.start + (raw.len() - raw.trim_start().len());
            let name = node.tag_name().name();
            let message = format!("{owner}<{name}> holds the text {}", quoted(raw.trim()));
            let error = Diagnostic::new(start..start + raw.trim().len(), message);
            self.sink
                .push(error.help("a URDF has elements and attributes only"));
        }
    }
}

/// Links, joints, loops and couplings begin the messages about what is in them.
fn owner_of(node: Node<'_, '_>, place: usize, owner: &str) -> String {
    match node.tag_name().name() {
        "link" | "joint" | "loop" | "coupling" if owner.is_empty() => {
            format!("{}: ", named(node, place))
        }
        _ => owner.to_owned(),
    }
}

/// What messages call an element of the robot: by its name, or by what it refers to, or by its place among those of its kind.
fn named(node: Node<'_, '_>, place: usize) -> String {
    let kind = visible_line(node.tag_name().name());
    let name = node.attribute("name").or(node.attribute("reference"));
    match name {
        Some(name) => format!("{kind} `{}`", visible_line(name)),
        None => format!("{kind} {place}"),
    }
}

/// Why the text of an attribute is refused, and a hint.
fn refusal(text: &str, kind: Kind) -> Option<(String, Option<String>)> {
    let plain = |why: &str| Some((why.to_owned(), None));
    match kind {
        Kind::Name => no_name(text).map(|why| (why, None)),
        Kind::Number => match parse(text) {
            Some(number) if number.is_finite() => None,
            _ => plain("not a finite number"),
        },
        Kind::Bound => match parse(text) {
            Some(number) if !number.is_nan() => None,
            _ => plain("not a number"),
        },
        Kind::Vector(size) => {
            let sound = finite(text).is_some_and(|numbers| numbers.len() == size);
            (!sound).then(|| (format!("not {size} finite numbers"), None))
        }
        Kind::Choice(words) if words.contains(&text) => None,
        Kind::Choice(words) => {
            let near = nearest(text, words.iter().copied());
            let why = format!("but must be {}", one_of(words.iter().copied()));
            Some((why, near.map(|near| format!("did you mean `{near}`?"))))
        }
    }
}
