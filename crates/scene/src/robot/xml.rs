//! The XML under the file of a robot: a tree that knows the place of everything, or its syntax error; and numbers in texts.

use crate::diagnostics::Diagnostic;
use crate::kind;
use crate::read::Sink;
use crate::source::Span;
use crate::urdf::of_prefix;
use roxmltree::{Document, Error, Node};

/// Reads the tree. Of several syntax errors XML tells the first.
pub(crate) fn tree<'a>(text: &'a str, sink: &mut Sink) -> Option<Document<'a>> {
    Document::parse(text)
        .map_err(|error| sink.push(refusal(text, &error)))
        .ok()
}

fn refusal(text: &str, error: &Error) -> Diagnostic {
    if let Some(other) = kind::no_robot(text) {
        return other;
    }
    let position = error.pos();
    let message = error.to_string().replace(&format!(" at {position}"), "");
    let span = match error {
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream => text.len()..text.len(),
        Error::DtdDetected => text.find("<!DOCTYPE").map_or(0..0, |at| at..at + 9),
        _ => byte_at(text, position.row, position.col),
    };
    let refusal = Diagnostic::new(span, format!("not valid XML: {message}"));
    match error {
        Error::UnknownNamespace(prefix, _) => {
            let declared = "a prefix is declared by an attribute `xmlns:prefix` of the root";
            refusal.help(of_prefix(prefix).unwrap_or(declared))
        }
        Error::DtdDetected => refusal.help("the file of a robot has no document type"),
        _ => refusal,
    }
}

/// The character in that row and column, both from 1.
fn byte_at(text: &str, row: u32, column: u32) -> Span {
    let lines = text.split_inclusive('\n').take(row.max(1) as usize - 1);
    let line_start: usize = lines.map(str::len).sum();
    let mut characters = text[line_start..].char_indices();
    let start = characters
        .nth(column.max(1) as usize - 1)
        .map_or(text.len(), |(at, _)| line_start + at);
    let length = text[start..].chars().next().map_or(0, char::len_utf8);
    start..start + length
}

/// Where the tag of an element begins, prefix included: what messages underline.
pub(crate) fn tag(node: Node<'_, '_>) -> Span {
    let range = node.range();
    let raw = &node.document().input_text()[range.clone()];
    let ends = |c: char| c.is_whitespace() || c == '/' || c == '>';
    let length = raw.find(ends).unwrap_or(raw.len());
    range.start..range.start + length
}

/// A number, infinite and NaN among them.
pub(crate) fn parse(text: &str) -> Option<f64> {
    text.trim().parse().ok()
}

/// `N` finite numbers.
pub(crate) fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    finite(text)?.try_into().ok()
}

/// Finite numbers between white space.
pub(crate) fn finite(text: &str) -> Option<Vec<f64>> {
    let numbers: Option<Vec<f64>> = text.split_whitespace().map(parse).collect();
    numbers.filter(|numbers| numbers.iter().all(|number| number.is_finite()))
}
