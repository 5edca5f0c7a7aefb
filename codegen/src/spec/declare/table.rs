//! Files of knots: CSV with a line of names, and one line for each knot.

use super::super::ast::Name;
use super::super::syntax::number;
use super::super::{Fallible, code, limits};
use super::curve::Knot;
use crate::diagnostic::Diagnostic;
use crate::expr::Rational;
use crate::source;
use std::path::{Component, Path};

/// Longest part of a line that a message quotes, in characters.
const LONGEST_QUOTED: usize = 40;

/// The knots of a file, and the same as a spec writes them. `units` are those of argument and value.
pub(super) fn read(
    name: &Name,
    units: [&Name; 2],
    folder: Option<&Path>,
) -> Fallible<(Vec<Knot>, String)> {
    let text = text(name, folder)?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let mut lines = text
        .lines()
        .zip(1..)
        .filter(|(line, _)| !line.trim().is_empty());
    let header = lines.next().map(|(line, _)| line).unwrap_or_default();
    check_header(name, header, units)?;
    let (mut knots, mut written) = (vec![], vec![]);
    for (line, number) in lines {
        if knots.len() > limits::MOST_KNOTS {
            break;
        }
        let [x, y] = fields(name, line, number)?.map(unsigned);
        written.push(format!("[{x}, {y}]"));
        let numbers = [decimal(name, x, number)?, decimal(name, y, number)?];
        knots.push(Knot {
            span: name.span.clone(),
            line: Some(number),
            numbers,
        });
    }
    Ok((knots, format!("through {}", written.join(", "))))
}

fn error(name: &Name, message: String) -> Box<Diagnostic> {
    let error = Diagnostic::new(code::TABLE, name.span.clone(), message);
    Box::new(error.label("this file"))
}

/// The text of the file, which stands beside the spec.
fn text(name: &Name, folder: Option<&Path>) -> Fallible<String> {
    let mut parts = Path::new(&name.text).components();
    let is_plain = matches!(
        (parts.next(), parts.next()),
        (Some(Component::Normal(_)), None)
    );
    if !is_plain || name.text.contains(['/', '\\']) {
        let message = format!("`{}` is not the name of a file beside the spec", name.text);
        return Err(error(name, message));
    }
    let Some(folder) = folder else {
        let message = format!(
            "`{}` cannot be looked for: the spec is in no folder",
            name.text
        );
        return Err(error(name, message));
    };
    source::read(&folder.join(&name.text)).map_err(|reason| {
        error(
            name,
            format!("cannot read `{}`: {}", name.text, said(&reason)),
        )
    })
}

/// What is wrong with a file, in the same words on every system.
fn said(reason: &std::io::Error) -> String {
    match reason.kind() {
        std::io::ErrorKind::NotFound => "there is no such file beside the spec".to_owned(),
        _ => reason.to_string(),
    }
}

/// The two fields of a line.
fn fields<'t>(name: &Name, line: &'t str, number: usize) -> Fallible<[&'t str; 2]> {
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    match fields.as_slice() {
        [x, y] => Ok([x, y]),
        _ => {
            let message = format!(
                "`{}`, line {number}: expected an argument and a value with a comma between them, found `{}`",
                name.text,
                quoted(line)
            );
            Err(error(name, message))
        }
    }
}

/// A number as a spec writes it: without a plus before it.
fn unsigned(number: &str) -> &str {
    number.strip_prefix('+').unwrap_or(number)
}

fn quoted(text: &str) -> String {
    let visible = text.chars().filter(|c| !c.is_control());
    visible.take(LONGEST_QUOTED).collect()
}

/// Names that end with the declared units: `angle_deg,lift_mm`.
fn check_header(name: &Name, header: &str, units: [&Name; 2]) -> Fallible<()> {
    let columns = fields(name, header, 1)?;
    for (column, unit) in columns.into_iter().zip(units) {
        if unit.text == "1" {
            continue;
        }
        let ending = unit.text.replace('/', "_per_").replace('*', "_");
        let of_unit = column == ending || column.ends_with(&format!("_{ending}"));
        if !of_unit {
            let message = format!(
                "`{}`: the column `{}` is not in {}, which the curve declares: its name would end with `_{ending}`",
                name.text,
                quoted(column),
                unit.text
            );
            return Err(Box::new(error(name, message).help(
                "the first line names the columns with their units: `angle_deg,lift_mm`",
            )));
        }
    }
    Ok(())
}

/// The exact number of a field.
fn decimal(name: &Name, text: &str, line: usize) -> Fallible<Rational> {
    let (negative, size) = match text.strip_prefix('-') {
        Some(size) => (true, size),
        None => (false, text),
    };
    match number::rational(size, &name.span) {
        Ok(value) => Ok(if negative { -value } else { value }),
        Err(_) => {
            let message = format!(
                "`{}`, line {line}: `{}` is not a number of the language",
                name.text,
                quoted(text)
            );
            let error = error(name, message);
            Err(Box::new(error.help(
                "write digits, a point, an exponent: 12, 0.5, 1e-3; at most 64 digits",
            )))
        }
    }
}
