//! Lines as the templates see them.

use super::super::lines::{Formula, Line, Loop};
use super::super::{Lowered, array, list};
use super::formula::{index, literal, value};
use super::helpers::{Used, several};
use hamel_codegen::text::one_line;
use serde::Serialize;

/// A statement, its parts as text.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Statement {
    /// What stands above others.
    Comment { text: String },
    /// A name for a value.
    Value { name: String, value: String },
    /// A name for the results of a helper that has several.
    Several {
        name: String,
        count: usize,
        helper: &'static str,
        arguments: Vec<String>,
    },
    /// A name for several values.
    List { name: String, values: Vec<String> },
    /// Values for other blocks.
    Row { row: String, values: Vec<String> },
    /// A result of the function.
    Result { place: String, value: String },
    /// Like blocks.
    Loop {
        bodies: String,
        count: usize,
        tables: Vec<Table>,
        sources: Vec<Source>,
        lines: Vec<Statement>,
    },
}

/// Numbers or places in which like blocks differ, one row a turn.
#[derive(Serialize)]
pub struct Table {
    name: String,
    kind: &'static str,
    row_name: &'static str,
    width: usize,
    rows: Vec<Vec<String>>,
}

/// What a loop reads of other blocks.
#[derive(Serialize)]
pub struct Source {
    name: String,
    row: String,
}

/// An array of rows of one length.
#[derive(Serialize)]
pub struct Array {
    name: String,
    width: usize,
    rows: usize,
}

/// The arrays of a function.
pub fn arrays(lowered: &Lowered) -> Vec<Array> {
    let one = |(&width, &rows): (&usize, &usize)| Array {
        name: array(width),
        width,
        rows,
    };
    lowered.arrays.iter().map(one).collect()
}

/// The lines of a function; `used` is what it reads.
pub fn statements(lines: &[Line], used: &Used) -> Vec<Statement> {
    lines.iter().flat_map(|line| of_line(line, used)).collect()
}

fn of_line(line: &Line, used: &Used) -> Vec<Statement> {
    match line {
        Line::Heading(heading) => vec![Statement::Comment {
            text: one_line(&format!(
                "{}: {} ({})",
                heading.body, heading.topic, heading.operations
            )),
        }],
        Line::Value(name, Formula::Several(function, arguments)) => {
            let (helper, count) = several(*function);
            vec![Statement::Several {
                name: name.clone(),
                count,
                helper,
                arguments: arguments.iter().map(value).collect(),
            }]
        }
        Line::Value(name, formula) => vec![Statement::Value {
            name: name.clone(),
            value: value(formula),
        }],
        Line::SinCos(sin, cos, angle) => sin_cos(sin, cos, angle, used),
        Line::SinCosAll(all) => all
            .iter()
            .flat_map(|(sin, cos, angle)| sin_cos(sin, cos, angle, used))
            .collect(),
        Line::Angles(angles) => {
            let of = |name: &str, function: &str| Statement::List {
                name: name.to_owned(),
                values: angles
                    .iter()
                    .map(|angle| format!("{function}({})", value(angle)))
                    .collect(),
            };
            let both = [
                (used.sines, of("sines", "sin")),
                (used.cosines, of("cosines", "cos")),
            ];
            let read = both.into_iter().filter(|(is_read, _)| *is_read);
            read.map(|(_, list)| list).collect()
        }
        Line::Row(row) => vec![Statement::Row {
            row: format!("{}[{}]", array(row.values.len()), index(row.place)),
            values: row.values.iter().map(value).collect(),
        }],
        Line::Result(place, formula) => vec![Statement::Result {
            place: index(*place),
            value: value(formula),
        }],
        Line::Loop(looped) => vec![turns(looped, used)],
        // Of functions in Rust alone.
        Line::Extracted(..) => vec![],
    }
}

/// Sine and cosine of one angle, those that are read.
fn sin_cos(sin: &str, cos: &str, angle: &Formula, used: &Used) -> Vec<Statement> {
    let angle = value(angle);
    let both = [(sin, "sin"), (cos, "cos")].into_iter();
    let read = both.filter(|(name, _)| used.names.contains(*name));
    read.map(|(name, function)| Statement::Value {
        name: name.to_owned(),
        value: format!("{function}({angle})"),
    })
    .collect()
}

/// A loop over like bodies, with its tables.
fn turns(looped: &Loop, used: &Used) -> Statement {
    let named = |what: &str| format!("{}_{what}", looped.name.to_uppercase());
    let numbers = table(&looped.numbers, |number| literal(*number)).map(|(width, rows)| Table {
        name: named("NUMBERS"),
        kind: "double",
        row_name: "numbers",
        width,
        rows,
    });
    let places = table(&looped.places, usize::to_string).map(|(width, rows)| Table {
        name: named("PLACES"),
        kind: "int",
        row_name: "places",
        width,
        rows,
    });
    let sources = looped.sources.iter();
    let sources = sources.map(|(name, width, place)| Source {
        name: name.clone(),
        row: format!("{}[{}]", array(*width), index(*place)),
    });
    Statement::Loop {
        bodies: one_line(&list(&looped.bodies)),
        count: looped.bodies.len(),
        tables: numbers.into_iter().chain(places).collect(),
        sources: sources.collect(),
        lines: statements(&looped.lines, used),
    }
}

/// Width and rows of a table; none where it has no columns.
fn table<T>(rows: &[Vec<T>], entry: impl Fn(&T) -> String) -> Option<(usize, Vec<Vec<String>>)> {
    let width = rows.first().map_or(0, Vec::len);
    let row = |row: &Vec<T>| row.iter().map(&entry).collect();
    (width > 0).then(|| (width, rows.iter().map(row).collect()))
}
