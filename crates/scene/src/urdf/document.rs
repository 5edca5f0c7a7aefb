//! The texts and numbers of a URDF's elements.

pub(super) use crate::robot::xml::{finite, numbers, parse, tag};
use crate::source::Span;
use roxmltree::Node;

/// The child element of that name.
pub(super) fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// Where the value of an attribute of the child element stands; failing that the child's tag, failing that the node's.
pub(super) fn place(node: Node<'_, '_>, name: &str, attribute: &str) -> Span {
    let child = child(node, name);
    let value = child.and_then(|child| child.attribute_node(attribute));
    match (value, child) {
        (Some(value), _) => value.range_value(),
        (None, Some(child)) => tag(child),
        (None, None) => tag(node),
    }
}

/// The text of an attribute of the child element.
pub(super) fn attribute<'a>(node: Node<'a, '_>, name: &str, attribute: &str) -> Option<&'a str> {
    child(node, name)?.attribute(attribute)
}

/// The number in an attribute of the child element.
pub(super) fn number(node: Node<'_, '_>, name: &str, of: &str) -> Option<f64> {
    parse(attribute(node, name, of)?)
}

/// The `N` finite numbers in an attribute of the child element.
pub(super) fn vector<const N: usize>(node: Node<'_, '_>, name: &str, of: &str) -> Option<[f64; N]> {
    numbers(attribute(node, name, of)?)
}
