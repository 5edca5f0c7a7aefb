//! Numbers that may change with time: a number, a formula in a text, or a table of values.

use crate::diagnostics::Diagnostic;
use crate::read::{Fields, Sink, Value};
use crate::source::Span;
use hamel_runtime::time_function::{
    Expression, Outside, Table, TableError, TableKind, TimeFunction,
};
use std::sync::Arc;

/// What a time function may be, for messages.
const FORMS: &str = "numbers, formulas and tables";

/// Reads one.
pub(super) fn function(value: &Value<'_>, sink: &mut Sink) -> Option<TimeFunction> {
    if value.is_text() {
        return formula(value, sink);
    }
    if value.is_table() {
        let mut fields = value.table(sink)?;
        let found = table(&mut fields, sink);
        fields.finish(sink);
        return found;
    }
    Some(TimeFunction::Constant(value.number(sink)?.value))
}

/// Reads a list of them.
pub(super) fn functions(value: &Value<'_>, sink: &mut Sink) -> Option<Vec<TimeFunction>> {
    let items = value.items("entry", &format!("a list of {FORMS}"), sink)?;
    let found: Vec<_> = items.iter().map(|item| function(item, sink)).collect();
    found.into_iter().collect()
}

/// Reads the three entries of a vector; all are 0 where it is absent.
pub(super) fn vector(
    fields: &mut Fields<'_>,
    key: &'static str,
    sink: &mut Sink,
) -> Option<[TimeFunction; 3]> {
    let Some(value) = fields.optional(key) else {
        return Some([0.0; 3].map(TimeFunction::Constant));
    };
    let found = functions(&value, sink)?;
    let count = found.len();
    let entries = found.try_into().ok();
    if entries.is_none() {
        let message = format!("{} has length {count}, not 3", value.path());
        sink.push(Diagnostic::new(value.span(), message));
    }
    entries
}

fn formula(value: &Value<'_>, sink: &mut Sink) -> Option<TimeFunction> {
    let text = value.text(sink)?;
    match Expression::new(&text.value) {
        Ok(expression) => Some(TimeFunction::Expression(Arc::new(expression))),
        Err(error) => {
            let message = format!("{} is {:?}: {error}", value.path(), text.value);
            let span = place(&text.value, &text.span, error.position);
            sink.push(Diagnostic::new(span, message));
            None
        }
    }
}

/// Where the character at `position` of a text stands in the file; the whole text where it is not written as it is.
fn place(text: &str, span: &Span, position: usize) -> Span {
    // One quotation mark on either side, and no escapes.
    if span.len() != text.len() + 2 {
        return span.clone();
    }
    let before: usize = text.chars().take(position).map(char::len_utf8).sum();
    let length = text[before..].chars().next().map_or(1, char::len_utf8);
    let start = span.start + 1 + before;
    start..start + length
}

/// The keys of a table of values.
pub(super) fn table(fields: &mut Fields<'_>, sink: &mut Sink) -> Option<TimeFunction> {
    let times = fields.required("times", sink);
    let values = fields.required("values", sink);
    let kind = fields.required("kind", sink);
    let kind = kind.and_then(|kind| kind.choice(&TableKind::NAMES, sink));
    let outside = match fields.optional("outside") {
        Some(outside) => outside.choice(&Outside::NAMES, sink),
        None => Some(Outside::Hold.name()),
    };
    let (times, values) = (times?, values?);
    let numbers = (times.numbers(sink), values.numbers(sink));
    let (kind, outside) = (TableKind::named(kind?)?, Outside::named(outside?)?);
    match Table::new(numbers.0?.value, numbers.1?.value, kind, outside) {
        Ok(table) => Some(TimeFunction::Table(Arc::new(table))),
        Err(error) => {
            let wrong = match &error {
                TableError::Order { .. } | TableError::Short { .. } => &times,
                _ => &values,
            };
            let message = format!("{}: {error}", wrong.path());
            sink.push(Diagnostic::new(wrong.span(), message));
            None
        }
    }
}
