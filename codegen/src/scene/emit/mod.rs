//! The graph as source text.
//!
//! [`Lowered`] is what every target language writes: lines in order, each a name for a value, under a heading for each part of a body's
//! equations. It holds no decision of a language: names are ASCII identifiers, sums and products are as they are computed.

mod lower;
mod rust;

pub use lower::{Formula, Heading, Line, Lowered};
pub use rust::module;

use super::graph::{Argument, Graph, Operations, Value};

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
    /// Columns of the result: 1 for a vector.
    pub columns: usize,
}

impl Function {
    /// Its operations.
    pub fn operations(&self) -> Operations {
        Operations::of(&self.graph, &self.outputs)
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
        }
    }
}
