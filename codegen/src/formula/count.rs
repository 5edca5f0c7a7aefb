//! Operations of a formula, counted on the formula as it is written.

use super::{Binding, Chain, Node, Program};
use std::ops::AddAssign;

/// Numbers of operations. Changes of sign are not counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Additions and subtractions.
    pub additions: usize,
    /// Multiplications.
    pub multiplications: usize,
    /// Multiply–adds: as many of the additions and of the multiplications are one operation.
    pub fused: usize,
    /// Divisions.
    pub divisions: usize,
    /// Calls of functions; sine and cosine of one angle are one call.
    pub calls: usize,
}

impl Counts {
    /// The operations to evaluate a formula.
    pub fn of(node: &Node) -> Self {
        let mut counts = Self::default();
        node.visit(&mut |part| counts.add_operation(part));
        counts
    }

    /// The operations to run a program.
    pub fn of_program(program: &Program) -> Self {
        let mut counts = Self::default();
        for binding in &program.bindings {
            counts += match binding {
                Binding::Value { value, .. } => Self::of(value),
                Binding::SinCos { angle, .. } => Self::of(angle).plus_call(),
                Binding::Call { argument, .. } => {
                    let mut inner = Self {
                        calls: 1,
                        ..Self::default()
                    };
                    argument.iter().for_each(|entry| inner += Self::of(entry));
                    inner
                }
            };
        }
        program
            .outputs
            .iter()
            .for_each(|output| counts += Self::of(output));
        counts
    }

    fn plus_call(mut self) -> Self {
        self.calls += 1;
        self
    }

    fn add_operation(&mut self, node: &Node) {
        match node {
            Node::Sum(terms) => {
                self.additions += terms.len().saturating_sub(1);
                self.fused += Chain::new(terms).map_or(0, |chain| chain.products.len());
            }
            Node::Product(factors) => self.multiplications += factors.len().saturating_sub(1),
            Node::Quotient(..) => self.divisions += 1,
            Node::Call(..) => self.calls += 1,
            Node::Number(_) | Node::Symbol(_) | Node::Pi | Node::Negative(_) => {}
        }
    }

    /// Work to choose between two ways to write a value, in multiplications: the throughput of common processors, roughly.
    pub fn work(&self) -> usize {
        self.additions + self.multiplications - self.fused + 4 * self.divisions + 16 * self.calls
    }

    /// All operations together.
    pub fn total(&self) -> usize {
        self.additions + self.multiplications + self.divisions + self.calls
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.additions += other.additions;
        self.multiplications += other.multiplications;
        self.fused += other.fused;
        self.divisions += other.divisions;
        self.calls += other.calls;
    }
}

impl std::fmt::Display for Counts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let fused = match self.fused {
            0 => String::new(),
            count => format!(" ({count} of each fused)"),
        };
        let parts = [
            (self.additions, "addition"),
            (self.multiplications, "multiplication"),
            (self.divisions, "division"),
            (self.calls, "function call"),
        ];
        let plural = |count: usize| if count == 1 { "" } else { "s" };
        let shown = parts.iter().filter(|(count, _)| *count > 0);
        let shown: Vec<String> = shown
            .map(|(count, name)| {
                let fused = if *name == "multiplication" {
                    &fused
                } else {
                    ""
                };
                format!("{count} {name}{}{fused}", plural(*count))
            })
            .collect();
        match shown.is_empty() {
            true => f.write_str("none"),
            false => f.write_str(&shown.join(", ")),
        }
    }
}
