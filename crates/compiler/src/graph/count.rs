//! Operations that a graph takes.

use super::{Graph, Operation, Value};
use hamel_codegen::expr::Function;
use std::fmt::{Display, Formatter};
use std::ops::AddAssign;

/// Numbers of operations. Changes of sign are free; a sine and the cosine of the same angle are two calls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Additions and subtractions.
    pub additions: usize,
    /// Multiplications.
    pub multiplications: usize,
    /// Divisions.
    pub divisions: usize,
    /// Square roots.
    pub roots: usize,
    /// Calls of other functions.
    pub calls: usize,
}

impl Operations {
    /// What it takes to compute `outputs`.
    pub fn of(graph: &Graph, outputs: &[Value]) -> Self {
        let uses = graph.uses(outputs);
        let mut operations = Self::default();
        for (node, uses) in graph.nodes.iter().zip(uses) {
            if uses > 0 {
                operations.add(&node.operation);
            }
        }
        operations
    }

    /// Counts one operation.
    pub fn add(&mut self, operation: &Operation) {
        match operation {
            Operation::Sum(..) | Operation::Difference(..) => self.additions += 1,
            Operation::Product(..) => self.multiplications += 1,
            Operation::Quotient(..) => self.divisions += 1,
            Operation::Call(Function::Sqrt, ..) => self.roots += 1,
            Operation::Call(..) | Operation::Several(..) => self.calls += 1,
            Operation::Input(..)
            | Operation::Constant(_)
            | Operation::Opposite(_)
            | Operation::Part(..) => {}
        }
    }

    /// Additions, multiplications, divisions and roots together.
    pub fn flops(&self) -> usize {
        self.additions + self.multiplications + self.divisions + self.roots
    }
}

impl AddAssign for Operations {
    fn add_assign(&mut self, other: Self) {
        self.additions += other.additions;
        self.multiplications += other.multiplications;
        self.divisions += other.divisions;
        self.roots += other.roots;
        self.calls += other.calls;
    }
}

impl Display for Operations {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let parts = [
            (self.additions, "addition"),
            (self.multiplications, "multiplication"),
            (self.divisions, "division"),
            (self.roots, "root"),
            (self.calls, "function call"),
        ];
        let plural = |count: usize| if count == 1 { "" } else { "s" };
        let shown = parts.iter().filter(|(count, _)| *count > 0);
        let shown: Vec<String> = shown
            .map(|(count, name)| format!("{count} {name}{}", plural(*count)))
            .collect();
        match shown.is_empty() {
            true => f.write_str("no operations"),
            false => f.write_str(&shown.join(", ")),
        }
    }
}
