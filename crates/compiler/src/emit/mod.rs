//! The graph as source text.
//!
//! [`Lowered`] is what every target language writes: lines in order, each a name for a value, under a heading for each part of a body's
//! equations, and loops of such lines. It holds no decision of a language: names are ASCII identifiers, sums and products are as they are
//! computed.

pub mod c99;
mod evaluate;
pub mod lines;
mod looped;
mod lower;
mod packed;
mod parts;
mod rust;
mod straight;

pub use rust::module;

use super::alike::Plan;
use super::graph::{Argument, Graph, Operation, Operations, Value};
use super::model::Model;
use super::packs::Packs;
use super::pairs::Tables;
use hamel_codegen::expr::Function as Known;
use hamel_codegen::expr::curve::Curve;
use hamel_codegen::formula::names::NameSet;
use lines::{Formula, Line};
use std::collections::{BTreeMap, BTreeSet};

/// One function to be written.
#[derive(Clone, Debug)]
pub struct Function {
    /// Its name.
    pub name: &'static str,
    /// What it computes, in a sentence.
    pub summary: String,
    /// What it reads, in order, with their sizes.
    pub arguments: Vec<(Argument, usize)>,
    /// What computes it.
    pub graph: Graph,
    /// Its results; rows of equal length where they are a matrix.
    pub outputs: Vec<Value>,
    /// Columns of the result; none for a vector.
    pub columns: Option<usize>,
    /// Its like parts, where they are looped over.
    pub plan: Option<Plan>,
    /// Its like limbs, where they are computed side by side: in Rust.
    pub packs: Option<Packs>,
    /// What loops over pairs of joints make of the outputs; without, these are the results.
    pub pairs: Option<Tables>,
}

impl Function {
    /// Its operations.
    pub fn operations(&self) -> Operations {
        let mut operations = self.operations_of_bodies();
        operations += self
            .pairs
            .as_ref()
            .map(Tables::operations)
            .unwrap_or_default();
        operations
    }

    /// Its operations without those of loops over pairs of joints.
    fn operations_of_bodies(&self) -> Operations {
        Operations::of(&self.graph, &self.outputs)
    }

    /// How many results it has.
    pub fn results(&self) -> usize {
        let pairs = self.pairs.as_ref();
        pairs.map_or(self.outputs.len(), |pairs| pairs.size.iter().product())
    }

    /// Operations that are written, where those of loops over like bodies stand once; loops over pairs of joints are not written.
    pub fn written(&self) -> usize {
        match &self.plan {
            Some(plan) => plan.written(&self.graph),
            None => self.operations_of_bodies().flops(),
        }
    }
}

/// A function in lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Lowered {
    /// The lines.
    pub lines: Vec<Line>,
    /// Arrays of the rows that blocks leave: how many rows of which length.
    pub arrays: BTreeMap<usize, usize>,
    /// Its results, where no line assigns them.
    pub outputs: Option<Vec<Formula>>,
}

impl Lowered {
    /// The lines of a function; `bodies` are the names of the sections, `reserved` must not be used.
    pub fn new(function: &Function, bodies: &[String], reserved: &[&str]) -> Self {
        let mut names = taken(reserved);
        match &function.plan {
            None => straight::lowered(function, bodies, &mut names),
            Some(plan) => {
                for width in plan.arrays.keys() {
                    names.claim(&array(*width));
                }
                looped::lowered(function, plan, bodies, &mut names)
            }
        }
    }

    /// The same with like limbs side by side, where the function has them so.
    pub fn with_packs(function: &Function, bodies: &[String], reserved: &[&str]) -> Self {
        match &function.packs {
            None => Self::new(function, bodies, reserved),
            Some(packs) => packed::lowered(packs, bodies, &mut taken(reserved)),
        }
    }
}

/// Names that must not be used.
fn taken(reserved: &[&str]) -> NameSet {
    let mut names = NameSet::default();
    for name in reserved {
        names.claim(name);
    }
    names
}

/// The curves that functions call, in one order on every machine.
fn curves<'f>(functions: impl IntoIterator<Item = &'f Function>) -> BTreeSet<Curve> {
    let mut found = BTreeSet::new();
    for function in functions {
        let uses = function.graph.uses(&function.outputs);
        for (node, uses) in function.graph.nodes.iter().zip(uses) {
            if let (Operation::Call(Known::Curve(curve, _), ..), true) = (&node.operation, uses > 0)
            {
                found.insert(*curve);
            }
        }
    }
    found
}

/// Name of the array of rows of a length.
fn array(width: usize) -> String {
    format!("rows_of_{width}")
}

/// Names of the bodies as parts of identifiers.
fn identifiers(model: &Model) -> Vec<String> {
    let bodies = model.bodies.iter();
    bodies.map(|body| identifier(&body.name, "body")).collect()
}

/// A name as the first part of an identifier, ASCII and in lower case; `kind` stands before it where it does not begin with a letter.
fn identifier(name: &str, kind: &str) -> String {
    let plain = name.chars().map(|c| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            '_'
        }
    });
    let plain: String = plain.collect();
    match plain.starts_with(|c: char| c.is_ascii_alphabetic()) {
        true => plain,
        false => format!("{kind}_{plain}"),
    }
}

/// Names in a comment: long lists by their ends.
fn list(names: &[String]) -> String {
    match names {
        [first, second, .., last] if names.len() > 4 => {
            format!("{first}, {second}, … {last} ({} bodies)", names.len())
        }
        names => names.join(", "),
    }
}

/// That of three things which belongs to the argument: of Q, of τ, and of v̄, p̄ and v̄̇.
pub fn argument_size<T>(argument: Argument, [configuration, freedoms, speeds]: [T; 3]) -> T {
    match argument {
        Argument::Configuration => configuration,
        Argument::Efforts => freedoms,
        Argument::Speeds
        | Argument::Momenta
        | Argument::Accelerations
        | Argument::Weights
        | Argument::Given => speeds,
    }
}

impl Argument {
    /// Its name in emitted code.
    pub fn name(self) -> &'static str {
        match self {
            Self::Configuration => "q",
            Self::Speeds => "v",
            Self::Momenta => "p",
            Self::Efforts => "tau",
            Self::Accelerations => "a",
            Self::Weights => "lambda",
            Self::Given => "given",
        }
    }
}
