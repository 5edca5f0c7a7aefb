//! Classes of defaults: what elements say that do not say it themselves.

use super::element::Element;
use super::schema::ACTUATORS;
use crate::diagnostics::Diagnostic;
use crate::read::Sink;
use crate::robot::xml::tag;
use crate::source::Span;
use roxmltree::Node;
use std::collections::HashMap;

/// The class of elements that name none.
pub(super) const MAIN: usize = 0;

/// A class.
#[derive(Debug, Default)]
struct Class<'a> {
    /// The class around it, which says what it does not say.
    parent: Option<usize>,
    /// Its elements by what they are defaults of, the last ones first.
    elements: HashMap<&'a str, Vec<Node<'a, 'a>>>,
}

/// The classes of a model.
#[derive(Debug)]
pub(super) struct Defaults<'a> {
    classes: Vec<Class<'a>>,
    names: HashMap<&'a str, usize>,
}

impl<'a> Defaults<'a> {
    /// Those of the document of that root.
    pub(super) fn read(root: Node<'a, 'a>, sink: &mut Sink) -> Self {
        let mut own = Self {
            classes: vec![Class::default()],
            names: HashMap::from([("main", MAIN)]),
        };
        for node in root.children().filter(|node| node.has_tag_name("default")) {
            if let Some(name) = node.attribute("class").filter(|name| *name != "main") {
                let message =
                    format!("the outermost <default> has the class `{name}`: it is always `main`");
                let error = Diagnostic::new(class_span(node, "class"), message);
                sink.push(error.help("put a <default> with this class into it"));
            }
            own.class(node, sink);
        }
        own
    }

    fn class(&mut self, outermost: Node<'a, 'a>, sink: &mut Sink) {
        let mut open = vec![(outermost, MAIN)];
        while let Some((node, class)) = open.pop() {
            for child in node.children().filter(Node::is_element) {
                let name = child.tag_name().name();
                if name != "default" {
                    let elements = &mut self.classes[class].elements;
                    elements.entry(kind(name)).or_default().insert(0, child);
                    continue;
                }
                let Some(own) = child.attribute("class") else {
                    let error = Diagnostic::new(
                        tag(child),
                        "<default> in <default> has no attribute `class`",
                    );
                    sink.push(error);
                    continue;
                };
                if self.names.contains_key(own) {
                    let message = format!("two classes of defaults are called `{own}`");
                    sink.push(Diagnostic::new(class_span(child, "class"), message));
                    continue;
                }
                let place = self.classes.len();
                self.classes.push(Class {
                    parent: Some(class),
                    elements: HashMap::new(),
                });
                self.names.insert(own, place);
                open.push((child, place));
            }
        }
    }

    /// The class that `node` names by `attribute`; `otherwise` where it names none.
    pub(super) fn named(
        &self,
        node: Node<'a, 'a>,
        attribute: &str,
        otherwise: usize,
        sink: &mut Sink,
    ) -> usize {
        let Some(name) = node.attribute(attribute) else {
            return otherwise;
        };
        if let Some(class) = self.names.get(name) {
            return *class;
        }
        let message = format!(
            "`{attribute}` of <{}> is `{name}`, which is no class of defaults",
            node.tag_name().name()
        );
        let error = Diagnostic::new(class_span(node, attribute), message);
        let mut known: Vec<&str> = self.names.keys().copied().collect();
        known.sort_unstable();
        sink.unknown(error, name, &known, "a class is");
        otherwise
    }

    /// An element of `class`, or of the class that it names.
    pub(super) fn element(&self, node: Node<'a, 'a>, class: usize, sink: &mut Sink) -> Element<'a> {
        let mut element = Element::plain(node);
        let kind = kind(node.tag_name().name());
        let mut class = Some(self.named(node, "class", class, sink));
        while let Some(place) = class {
            let own = &self.classes[place];
            element
                .chain
                .extend(own.elements.get(kind).into_iter().flatten());
            class = own.parent;
        }
        element
    }
}

/// What shares defaults: all kinds of actuators do.
fn kind(name: &str) -> &str {
    match ACTUATORS.contains(&name) {
        true => "general",
        false => name,
    }
}

fn class_span(node: Node<'_, '_>, attribute: &str) -> Span {
    let found = node.attribute_node(attribute);
    found.map_or_else(|| tag(node), |found| found.range_value())
}
