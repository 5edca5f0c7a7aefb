//! A graph in double precision: what the written code computes, without writing it.

use super::{Argument, Graph, Operation, Value};
use crate::derived::Primitive;
use crate::expr::Function;
use hamel::scalar::Scalar;
use hamel::spatial::nearest_rotation;
use nalgebra::Matrix3;

impl Graph {
    /// The values of `outputs`; `argument` holds the scalars of each argument. What is missing there is NaN.
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
                Operation::Several(..) => f64::NAN,
                Operation::Part(of, result) => {
                    let results = match &self.nodes[*of as usize].operation {
                        Operation::Several(function, arguments) => {
                            let arguments: Vec<f64> =
                                arguments.iter().copied().map(signed).collect();
                            primitive(*function, &arguments)
                        }
                        _ => vec![],
                    };
                    results.get(*result as usize).copied().unwrap_or(f64::NAN)
                }
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

/// A function of one or two numbers.
pub(super) fn call(function: Function, a: f64, b: Option<f64>) -> f64 {
    match (function, b) {
        (Function::Sin, None) => a.sin(),
        (Function::Cos, None) => a.cos(),
        (Function::Exp, None) => a.exp(),
        (Function::Ln, None) => a.ln(),
        (Function::Sqrt, None) => a.sqrt(),
        (Function::Stumpff(order), None) => a.stumpff(order.into()),
        (Function::DexpInverse(order), None) => a.dexp_inverse(order.into()),
        (Function::Atan2, Some(x)) => a.atan2(x),
        _ => f64::NAN,
    }
}

/// The results of a function of the runtime; none where the number of arguments is another.
pub(super) fn primitive(function: Primitive, arguments: &[f64]) -> Vec<f64> {
    let rotation = || (arguments.len() == 9).then(|| Matrix3::from_row_slice(arguments));
    match function {
        Primitive::RotationVector => rotation().map_or(vec![], |rotation| {
            f64::rotation_vector(&rotation).as_slice().to_vec()
        }),
        Primitive::QuaternionVector => arguments.first_chunk().map_or(vec![], |quaternion| {
            f64::quaternion_vector(*quaternion).as_slice().to_vec()
        }),
        Primitive::NearestRotation => rotation().map_or(vec![], |matrix| {
            let nearest = nearest_rotation(&matrix);
            nearest.transpose().as_slice().to_vec()
        }),
    }
}
