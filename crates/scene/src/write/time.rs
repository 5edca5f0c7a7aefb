//! Functions of time, as the reader takes them.

use super::forces::speed;
use super::value::{list, number, table, text};
use hamel_runtime::time_function::TimeFunction;

/// A list of them.
pub(super) fn functions(functions: &[TimeFunction]) -> String {
    let entries: Vec<String> = functions.iter().map(function).collect();
    format!("[{}]", entries.join(", "))
}

/// One of them.
pub(super) fn function(function: &TimeFunction) -> String {
    match function {
        TimeFunction::Constant(value) => number(*value),
        TimeFunction::Sine(law) => speed(law),
        TimeFunction::Expression(expression) => text(expression.text()),
        TimeFunction::Table(values) => table(&[
            ("times", list(values.times())),
            ("values", list(values.values())),
            ("kind", text(values.kind().name())),
            ("outside", text(values.outside().name())),
        ]),
    }
}
