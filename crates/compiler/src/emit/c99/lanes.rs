//! Functions of many states side by side: loops over states, which C compilers vectorise.
//!
//! Eight states lie side by side, entry after entry. What one state computes stands in a loop over the eight, without branches. Sines and cosines of
//! arguments come before it, in a loop of their own: compilers of C have none that they vectorise.

use super::super::lines::{Formula, Line};
use super::super::parts::{Part, in_lane, parts};
use super::super::{Function, Lowered};
use super::Parameter;
use super::formula::value;
use super::helpers::Used;
use super::statement::{Statement, statements};
use hamel_codegen::text::one_line;
use serde::Serialize;

/// States side by side, as in Rust.
pub const LANES: usize = 8;

/// A function as the templates see it.
#[derive(Serialize)]
pub struct Written {
    name: &'static str,
    summary: String,
    parameters: Vec<Parameter>,
    /// Parameters that it does not read.
    unused: Vec<&'static str>,
    /// How many results a state has.
    count: usize,
    /// The angles of which sines and cosines are taken beforehand.
    angles: Vec<String>,
    /// Loops over the states, one after the other.
    parts: Vec<WrittenPart>,
}

/// A loop over the states as the templates see it.
#[derive(Serialize)]
struct WrittenPart {
    lines: Vec<Statement>,
    /// The array of what later loops read, and its entries.
    array: String,
    kept: Vec<String>,
    results: Vec<Assigned>,
}

/// A result with its place.
#[derive(Serialize)]
struct Assigned {
    place: usize,
    value: String,
}

impl Written {
    /// The function, which has no loops over like bodies, in lines.
    pub fn new(function: &Function, lowered: &Lowered) -> Self {
        let mut used = Used::default();
        used.note(lowered);
        let arguments = function.arguments.iter().map(|(argument, _)| *argument);
        let unused = arguments.filter(|argument| !used.reads(*argument));
        let mut angles = vec![];
        let lines = lowered.lines.iter();
        let lines = lines.flat_map(|line| beforehand(line, &used, &mut angles));
        let outputs = lowered.outputs.as_deref().unwrap_or_default();
        let parts = parts(&lines.collect::<Vec<Line>>(), outputs);
        Self {
            name: function.name,
            summary: one_line(&function.summary),
            parameters: Parameter::all(function),
            unused: unused.map(|argument| argument.name()).collect(),
            count: function.results(),
            angles,
            parts: parts.iter().map(|part| written(part, &used)).collect(),
        }
    }

    /// Whether it takes sines and cosines beforehand.
    pub fn turns(&self) -> bool {
        !self.angles.is_empty()
    }
}

fn written(part: &Part, used: &Used) -> WrittenPart {
    let results = part.results.iter();
    WrittenPart {
        lines: statements(&part.lines, used),
        array: part.array.clone(),
        kept: part.kept.clone(),
        results: results
            .map(|(place, of)| Assigned {
                place: LANES * place,
                value: value(of),
            })
            .collect(),
    }
}

/// The line with sines and cosines of several angles read from arrays, where loops before it leave them.
fn beforehand(line: &Line, used: &Used, angles: &mut Vec<String>) -> Vec<Line> {
    let Line::SinCosAll(all) = line else {
        return vec![line.clone()];
    };
    let mut lines = vec![];
    for (sin, cos, angle) in all {
        let place = angles.len();
        angles.push(value(&in_lane(angle)));
        let both = [(sin, "sines"), (cos, "cosines")].into_iter();
        let read = both.filter(|(name, _)| used.names.contains(*name));
        lines.extend(read.map(|(name, array)| {
            let entry = Formula::Lane(array.to_owned(), place);
            Line::Value(name.clone(), entry)
        }));
    }
    lines
}
