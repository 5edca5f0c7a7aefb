//! An element with the defaults of its class, and where elements stand.

use crate::robot::xml::{finite, tag};
use crate::source::{Located, Span};
use crate::text::visible_line;
use roxmltree::Node;

/// An element, whose attributes may be those of its class.
#[derive(Clone, Debug)]
pub(super) struct Element<'a> {
    /// The element itself.
    pub(super) node: Node<'a, 'a>,
    /// It, and the elements of its classes from the innermost out, which say what it does not say.
    pub(super) chain: Vec<Node<'a, 'a>>,
}

impl<'a> Element<'a> {
    /// An element without a class.
    pub(super) fn plain(node: Node<'a, 'a>) -> Self {
        Self {
            node,
            chain: vec![node],
        }
    }

    /// The text of an attribute.
    pub(super) fn text(&self, name: &str) -> Option<&'a str> {
        self.chain.iter().find_map(|node| node.attribute(name))
    }

    /// Whether a switch is on; `None` where nothing is said, or `auto`.
    pub(super) fn switch(&self, name: &str) -> Option<bool> {
        match self.text(name)? {
            "true" => Some(true),
            "false" => Some(false),
            _ => None,
        }
    }

    /// Numbers of an attribute. Where there are fewer than the class says, its last ones stay.
    pub(super) fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        let mut all: Option<Vec<f64>> = None;
        for node in self.chain.iter().rev() {
            let Some(own) = node.attribute(name).and_then(finite) else {
                continue;
            };
            let known = all.get_or_insert_default();
            let rest = known.split_off(own.len().min(known.len()));
            *known = own;
            known.extend(rest);
        }
        all
    }

    /// The first of these numbers.
    pub(super) fn number(&self, name: &str) -> Option<f64> {
        self.numbers(name)?.first().copied()
    }

    /// `N` numbers.
    pub(super) fn vector<const N: usize>(&self, name: &str) -> Option<[f64; N]> {
        self.numbers(name)?.try_into().ok()
    }

    /// Where an attribute stands, of the element or its class; failing that the element's tag.
    pub(super) fn span(&self, name: &str) -> Span {
        let found = self.chain.iter().find_map(|node| node.attribute_node(name));
        found.map_or_else(|| tag(self.node), |found| found.range_value())
    }

    /// The name, where it stands.
    pub(super) fn name(&self) -> Option<Located<String>> {
        let name = self.node.attribute_node("name")?;
        Some(Located::new(name.value().to_owned(), name.range_value()))
    }
}

/// What messages call an element: by its name, or by its line.
pub(super) fn label(node: Node<'_, '_>, lines: &Lines) -> String {
    let kind = visible_line(node.tag_name().name());
    match node.attribute("name") {
        Some(name) => format!("{kind} `{}`", visible_line(name)),
        None => format!("<{kind}> in line {}", lines.of(node.range().start)),
    }
}

/// The lines of a text.
#[derive(Debug)]
pub(super) struct Lines {
    /// Where they begin.
    starts: Vec<usize>,
}

impl Lines {
    /// Those of a text.
    pub(super) fn new(text: &str) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let starts = std::iter::once(0).chain(ends.map(|(at, _)| at + 1));
        Self {
            starts: starts.collect(),
        }
    }

    /// The number of the line of a byte, from 1.
    pub(super) fn of(&self, byte: usize) -> usize {
        self.starts.partition_point(|start| *start <= byte)
    }
}

#[cfg(test)]
mod tests {
    use super::Lines;

    #[test]
    fn lines_are_counted_from_one() {
        let lines = Lines::new("a\nbc\n\nd");
        let numbers = [0, 1, 2, 4, 5, 6].map(|byte| lines.of(byte));
        assert_eq!(numbers, [1, 1, 2, 2, 3, 4]);
    }
}
