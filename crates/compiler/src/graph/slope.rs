//! How values of the graph change with their inputs: forward differentiation, node by node, on the same graph.

use super::put::scalar;
use super::sym::make;
use super::{Argument, CURRENT, Operation, Sym, Value, call, sin_cos};
use hamel_codegen::derived::Primitive;
use hamel_codegen::expr::Function;
use num_traits::{One, Zero};
use rustc_hash::FxHashMap;

/// Values whose derivatives are asked for, with all that they are made of.
pub struct Slopes {
    values: Vec<Sym>,
    /// The nodes that they need, in order.
    needed: Vec<(u32, Operation)>,
}

/// What is known of one direction.
#[derive(Default)]
struct Found {
    /// Derivatives that are not 0.
    of: FxHashMap<u32, Sym>,
    /// Those of functions with several results.
    several: FxHashMap<u32, Vec<Sym>>,
}

impl Slopes {
    /// Of the values.
    pub fn new(values: Vec<Sym>) -> Self {
        let outputs: Vec<Value> = values.iter().map(|value| value.value()).collect();
        let needed = CURRENT.with_borrow(|graph| {
            let uses = graph.uses(&outputs);
            let nodes = (0..).zip(&graph.nodes).zip(uses);
            let needed = nodes.filter(|(_, uses)| *uses > 0);
            needed
                .map(|((number, node), _)| (number, node.operation.clone()))
                .collect()
        });
        Self { values, needed }
    }

    /// Their derivatives in the direction in which inputs change as `direction` says.
    pub fn along(&self, direction: impl Fn(Argument, usize) -> Sym) -> Vec<Sym> {
        let mut found = Found::default();
        for (number, operation) in &self.needed {
            let slope = match operation {
                Operation::Input(argument, index) => direction(*argument, *index as usize),
                Operation::Several(function, arguments) => {
                    let slopes = found.several(*function, arguments, *number);
                    if let Some(slopes) = slopes {
                        found.several.insert(*number, slopes);
                    }
                    continue;
                }
                operation => found.one(operation, *number),
            };
            if !slope.is_zero() {
                found.of.insert(*number, slope);
            }
        }
        let value = |value: &Sym| match value {
            Sym::Number(_) => Sym::zero(),
            Sym::Node(value) => found.value(*value),
        };
        self.values.iter().map(value).collect()
    }
}

impl Found {
    fn node(&self, number: u32) -> Sym {
        self.of.get(&number).copied().unwrap_or_else(Sym::zero)
    }

    fn value(&self, value: Value) -> Sym {
        let slope = self.node(value.node);
        if value.negative { -slope } else { slope }
    }

    /// Of an operation with one result.
    fn one(&self, operation: &Operation, number: u32) -> Sym {
        let own = Sym::Node(number.into());
        match *operation {
            Operation::Sum(a, b) => self.node(a) + self.node(b),
            Operation::Difference(a, b) => self.node(a) - self.node(b),
            Operation::Product(a, b) => self.node(a) * scalar(b) + self.node(b) * scalar(a),
            Operation::Quotient(a, b) => {
                let (above, below) = (self.node(a), self.node(b));
                if above.is_zero() && below.is_zero() {
                    return above;
                }
                (above - own * below) * (Sym::one() / scalar(b))
            }
            Operation::Opposite(a) => -self.node(a),
            Operation::Call(function, a, b) => self.call(function, (a, b), own),
            Operation::Part(all, place) => {
                let slopes = self.several.get(&all);
                slopes.map_or_else(Sym::zero, |slopes| slopes[place as usize])
            }
            Operation::Input(..) | Operation::Constant(_) | Operation::Several(..) => Sym::zero(),
        }
    }

    fn call(&self, function: Function, (a, b): (Value, Option<Value>), own: Sym) -> Sym {
        let (x, dx) = (Sym::Node(a), self.value(a));
        let dy = b.map_or_else(Sym::zero, |b| self.value(b));
        if dx.is_zero() && dy.is_zero() {
            return dx;
        }
        match (function, b) {
            (Function::Sin, None) => sin_cos(x).1 * dx,
            (Function::Cos, None) => -sin_cos(x).0 * dx,
            (Function::Exp, None) => own * dx,
            (Function::Sinh, None) => call(Function::Cosh, x) * dx,
            (Function::Cosh, None) => call(Function::Sinh, x) * dx,
            (Function::Sech, None) => -(call(Function::Tanh, x) * own * dx),
            (Function::Tanh, None) => {
                let sech = call(Function::Sech, x);
                sech * sech * dx
            }
            (Function::LnCosh, None) => call(Function::Tanh, x) * dx,
            (Function::Ln, None) => dx / x,
            // No value depends on scales.
            (Function::Ln1p, Some(scale)) => dx / (x + call(Function::Exp, -Sym::Node(scale))),
            (Function::Larger, _) => Sym::zero(),
            (Function::Sqrt, None) => dx * (Sym::from(0.5) / own),
            (Function::Stumpff(order), None) => {
                let next = call(Function::Stumpff(order + 1), x);
                let after = call(Function::Stumpff(order + 2), x) * Sym::from(f64::from(order));
                (after - next) * Sym::from(0.5) * dx
            }
            (Function::DexpInverse(order), None) => call(Function::DexpInverse(order + 1), x) * dx,
            (Function::Curve(curve, order), None) => {
                match order < curve.definition().kind.degree() {
                    true => call(Function::Curve(curve, order + 1), x) * dx,
                    false => Sym::zero(),
                }
            }
            // The first argument is the ordinate.
            (Function::Atan2, Some(b)) => {
                let abscissa = Sym::Node(b);
                (abscissa * dx - x * dy) / (abscissa * abscissa + x * x)
            }
            _ => Sym::Number(f64::NAN),
        }
    }

    /// Of all results of a function of the runtime; `None` where its arguments do not change.
    fn several(&self, function: Primitive, arguments: &[Value], number: u32) -> Option<Vec<Sym>> {
        let slopes: Vec<Sym> = arguments.iter().map(|&value| self.value(value)).collect();
        if slopes.iter().all(Zero::is_zero) {
            return None;
        }
        let at = |i: usize| Sym::Node(arguments[i]);
        let turn = match function {
            // What is a rotation, and stays one, is its own nearest.
            Primitive::NearestRotation => return Some(slopes),
            Primitive::RotationVector => {
                let entry = |i: usize, j: usize| -> Sym {
                    (0..3).map(|k| at(3 * k + i) * slopes[3 * k + j]).sum()
                };
                let half = Sym::from(0.5);
                [(2, 1), (0, 2), (1, 0)].map(|(i, j)| (entry(i, j) - entry(j, i)) * half)
            }
            Primitive::QuaternionVector => [(1, 2, 3), (2, 3, 1), (3, 1, 2)].map(|(i, j, k)| {
                let along = at(0) * slopes[i] - slopes[0] * at(i);
                (along - (at(j) * slopes[k] - at(k) * slopes[j])) * Sym::from(2.0)
            }),
        };
        Some(vector_rate(number, turn).to_vec())
    }
}

/// The rate of a rotation vector, which is in the parts of a node, from the angular velocity in child axes: the inverse of dexp.
fn vector_rate(number: u32, turn: [Sym; 3]) -> [Sym; 3] {
    let vector = [0, 1, 2].map(|place| make(Operation::Part(number, place)));
    let cross = |a: [Sym; 3], b: [Sym; 3]| {
        [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            a[j] * b[k] - a[k] * b[j]
        })
    };
    let once = cross(vector, turn);
    let twice = cross(vector, once);
    let square: Sym = vector.iter().map(|&entry| entry * entry).sum();
    let weight = call(Function::DexpInverse(0), square);
    [0, 1, 2].map(|i| turn[i] + once[i] * Sym::from(0.5) + twice[i] * weight)
}
