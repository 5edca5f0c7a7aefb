//! Functions of many states side by side: loops over states, which C compilers vectorise.
//!
//! Eight states lie side by side, entry after entry. What one state computes stands in a loop over the eight, without branches. Sines and cosines of
//! arguments come before it, in a loop of their own: compilers of C have none that they vectorise.

use super::super::lines::{Formula, Line, Place};
use super::super::{Function, Lowered};
use super::Parameter;
use super::formula::value;
use super::helpers::Used;
use super::statement::{Statement, statements};
use crate::alike::Read;
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
    lines: Vec<Statement>,
    outputs: Vec<String>,
}

impl Written {
    /// The function, which has no loops over like bodies, in lines.
    pub fn new(function: &Function, lowered: &Lowered) -> Self {
        let mut used = Used::default();
        used.note(lowered);
        let arguments = function.arguments.iter().map(|(argument, _)| *argument);
        let unused = arguments.filter(|argument| !used.reads(*argument));
        let mut side = Side::default();
        let lines: Vec<Line> = lowered
            .lines
            .iter()
            .flat_map(|line| side.line(line, &used))
            .collect();
        let outputs = lowered.outputs.iter().flatten();
        Self {
            name: function.name,
            summary: one_line(&function.summary),
            parameters: Parameter::all(function),
            unused: unused.map(|argument| argument.name()).collect(),
            count: function.results(),
            angles: side.angles,
            lines: statements(&lines, &used),
            outputs: outputs.map(|output| value(&in_lane(output))).collect(),
        }
    }

    /// Whether it takes sines and cosines beforehand.
    pub fn turns(&self) -> bool {
        !self.angles.is_empty()
    }
}

/// Lines of one state as those of a lane.
#[derive(Default)]
struct Side {
    angles: Vec<String>,
}

impl Side {
    fn line(&mut self, line: &Line, used: &Used) -> Vec<Line> {
        match line {
            Line::SinCosAll(all) => {
                let mut lines = vec![];
                for (sin, cos, angle) in all {
                    let place = self.angles.len();
                    self.angles.push(value(&in_lane(angle)));
                    let both = [(sin, "sines"), (cos, "cosines")].into_iter();
                    let read = both.filter(|(name, _)| used.names.contains(*name));
                    lines.extend(read.map(|(name, array)| {
                        let entry = Formula::Name(entry(array, place));
                        Line::Value(name.clone(), entry)
                    }));
                }
                lines
            }
            Line::SinCos(sin, cos, angle) => {
                vec![Line::SinCos(sin.clone(), cos.clone(), in_lane(angle))]
            }
            Line::Value(name, formula) => vec![Line::Value(name.clone(), in_lane(formula))],
            other => vec![other.clone()],
        }
    }
}

/// An entry of an array of the states side by side, in the loop over them.
fn entry(array: &str, place: usize) -> String {
    match LANES * place {
        0 => format!("{array}[lane]"),
        first => format!("{array}[{first} + lane]"),
    }
}

/// The formula with arguments of the lane.
fn in_lane(formula: &Formula) -> Formula {
    let boxed = |of: &Formula| Box::new(in_lane(of));
    let all = |of: &[Formula]| of.iter().map(in_lane).collect();
    match formula {
        Formula::Input(Read::Argument(argument), Place::Known(place)) => {
            Formula::Name(entry(argument.name(), *place))
        }
        Formula::Sum(terms) => {
            let terms = terms.iter();
            Formula::Sum(terms.map(|(minus, term)| (*minus, in_lane(term))).collect())
        }
        Formula::Product(a, b) => Formula::Product(boxed(a), boxed(b)),
        Formula::Quotient(a, b) => Formula::Quotient(boxed(a), boxed(b)),
        Formula::Negative(of) => Formula::Negative(boxed(of)),
        Formula::Call(function, arguments) => Formula::Call(*function, all(arguments)),
        Formula::Several(function, arguments) => Formula::Several(*function, all(arguments)),
        Formula::Part(of, result) => Formula::Part(boxed(of), *result),
        Formula::Number(_)
        | Formula::Column(_)
        | Formula::Input(..)
        | Formula::Source(..)
        | Formula::Row(..)
        | Formula::Name(_) => formula.clone(),
    }
}
