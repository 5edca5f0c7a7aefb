//! A graph in double precision: what the written code computes, without writing it.

use super::{Argument, Graph, Operation, Value};
use crate::expr::Function;

impl Graph {
    /// The values of `outputs`; `argument` holds the scalars of each argument. What is missing there is NaN, and so is a function that
    /// the standard library does not have.
    pub fn evaluate(&self, outputs: &[Value], argument: impl Fn(Argument) -> Vec<f64>) -> Vec<f64> {
        let all = [
            Argument::Configuration,
            Argument::Speeds,
            Argument::Momenta,
            Argument::Efforts,
            Argument::Accelerations,
        ];
        let inputs: Vec<(Argument, Vec<f64>)> = all.map(|one| (one, argument(one))).into();
        let input = |of: Argument, index: u32| {
            let found = inputs.iter().find(|(one, _)| *one == of);
            found
                .and_then(|(_, scalars)| scalars.get(index as usize))
                .copied()
                .unwrap_or(f64::NAN)
        };
        let mut values: Vec<f64> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let at = |node: u32| values[node as usize];
            let signed = |value: Value| {
                if value.negative {
                    -at(value.node)
                } else {
                    at(value.node)
                }
            };
            values.push(match &node.operation {
                Operation::Input(of, index) => input(*of, *index),
                Operation::Constant(bits) => f64::from_bits(*bits),
                Operation::Sum(a, b) => at(*a) + at(*b),
                Operation::Difference(a, b) => at(*a) - at(*b),
                Operation::Product(a, b) => at(*a) * at(*b),
                Operation::Quotient(a, b) => at(*a) / at(*b),
                Operation::Call(function, a, b) => call(*function, signed(*a), b.map(signed)),
            });
        }
        outputs
            .iter()
            .map(|output| {
                let value = values[output.node as usize];
                if output.negative { -value } else { value }
            })
            .collect()
    }
}

fn call(function: Function, a: f64, b: Option<f64>) -> f64 {
    match (function, b) {
        (Function::Sin, None) => a.sin(),
        (Function::Cos, None) => a.cos(),
        (Function::Exp, None) => a.exp(),
        (Function::Ln, None) => a.ln(),
        (Function::Sqrt, None) => a.sqrt(),
        (Function::Atan2, Some(x)) => a.atan2(x),
        _ => f64::NAN,
    }
}
