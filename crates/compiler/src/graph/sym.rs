//! Arithmetic on the graph under construction: an operation is folded or becomes a node.

use super::fault::{divisor, folded, sound};
use super::known;
use super::{Argument, CURRENT, Graph, Operation, Value};
use hamel_codegen::derived::Primitive;
use hamel_codegen::expr::Function;
use num_traits::{One, Zero};
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A scalar: a number that is known, or a node of the graph with a sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sym {
    /// A number.
    Number(f64),
    /// A node, or its opposite.
    Node(Value),
}

impl Sym {
    /// A scalar of an argument.
    pub fn input(argument: Argument, index: usize) -> Self {
        let index = u32::try_from(index).unwrap_or(u32::MAX);
        let bound = CURRENT.with_borrow(|graph| graph.bound.get(&(argument, index)).copied());
        bound.unwrap_or_else(|| make(Operation::Input(argument, index)))
    }

    /// The number, if it is one.
    pub fn number(self) -> Option<f64> {
        match self {
            Self::Number(value) => Some(value),
            Self::Node(_) => None,
        }
    }

    /// Whether it is known to be ±1.
    pub fn is_unit(self) -> bool {
        self.number().is_some_and(|value| value.abs() == 1.0)
    }

    /// The same, called `label` where it is written.
    #[must_use]
    pub fn named(self, label: &str) -> Self {
        if let Self::Node(value) = self {
            CURRENT.with_borrow_mut(|graph| {
                let section = graph.section;
                let node = &mut graph.nodes[value.node as usize];
                if node.section == section && !matches!(node.operation, Operation::Input(..)) {
                    label.clone_into(&mut node.label);
                }
            });
        }
        self
    }

    /// The same without a sign beside it, where bodies are to be alike: whether one arises alternates from body to body.
    #[must_use]
    pub fn settled(self) -> Self {
        match self {
            Self::Node(value) if value.negative => CURRENT.with_borrow_mut(|graph| {
                if !graph.signed {
                    return self;
                }
                Self::Node(graph.node(Operation::Opposite(value.node)).into())
            }),
            _ => self,
        }
    }

    /// The handle on the graph: numbers become nodes of it.
    pub fn value(self) -> Value {
        CURRENT.with_borrow_mut(|graph| value(graph, self))
    }
}

/// A number as a node with a sign.
fn value(graph: &mut Graph, sym: Sym) -> Value {
    match sym {
        Sym::Node(value) => value,
        Sym::Number(number) if graph.signed => Value {
            node: graph.node(Operation::Constant(number.to_bits())),
            negative: false,
        },
        Sym::Number(number) => Value {
            node: graph.node(Operation::Constant(number.abs().to_bits())),
            negative: number.is_sign_negative() && number != 0.0,
        },
    }
}

pub(super) fn make(operation: Operation) -> Sym {
    CURRENT.with_borrow_mut(|graph| {
        Sym::Node(Value {
            node: graph.node(operation),
            negative: false,
        })
    })
}

/// A function of one argument. Odd and even functions are those of the argument without its sign.
pub fn call(function: Function, argument: Sym) -> Sym {
    if let Some(number) = argument.number() {
        let value = |number: f64, _| known::call(function, number, None);
        return Sym::Number(folded(number, 0.0, value));
    }
    let inner = argument.value();
    let (of, flips) = match function {
        Function::Sin | Function::Sinh | Function::Tanh => (
            Value {
                negative: false,
                ..inner
            },
            inner.negative,
        ),
        Function::Cos | Function::Cosh | Function::Sech | Function::LnCosh => (
            Value {
                negative: false,
                ..inner
            },
            false,
        ),
        _ => (inner, false),
    };
    let result = make(Operation::Call(function, of, None));
    if flips { -result } else { result }
}

/// Sine and cosine.
pub fn sin_cos(angle: Sym) -> (Sym, Sym) {
    (call(Function::Sin, angle), call(Function::Cos, angle))
}

/// A function of two arguments.
pub fn call_two(function: Function, first: Sym, second: Sym) -> Sym {
    if let (Sym::Number(first), Sym::Number(second)) = (first, second) {
        let value = |first: f64, second| known::call(function, first, Some(second));
        return Sym::Number(folded(first, second, value));
    }
    let (first, second) = (first.value(), second.value());
    make(Operation::Call(function, first, Some(second)))
}

/// `atan2(y, x)`.
pub fn atan2(y: Sym, x: Sym) -> Sym {
    call_two(Function::Atan2, y, x)
}

/// The results of a function of the runtime, in the order of [`Primitive`].
pub fn primitive(function: Primitive, arguments: &[Sym]) -> Vec<Sym> {
    let numbers: Option<Vec<f64>> = arguments.iter().map(|argument| argument.number()).collect();
    if let Some(numbers) = numbers {
        if let Some(&broken) = numbers.iter().find(|number| number.is_nan()) {
            return (0..results(function))
                .map(|_| Sym::Number(broken))
                .collect();
        }
        let results = known::primitive(function, &numbers).into_iter();
        return results.map(Sym::from).collect();
    }
    let arguments = arguments.iter().map(|argument| argument.value()).collect();
    let all = CURRENT.with_borrow_mut(|graph| graph.node(Operation::Several(function, arguments)));
    (0..results(function))
        .map(|result| make(Operation::Part(all, result)))
        .collect()
}

/// How many results a function of the runtime has.
fn results(function: Primitive) -> u32 {
    match function {
        Primitive::RotationVector | Primitive::QuaternionVector => 3,
        Primitive::NearestRotation => 9,
    }
}

/// Whether `a` stands before `b` in a sum or product.
fn precedes(graph: &Graph, a: u32, b: u32) -> bool {
    let is_number =
        |node: u32| matches!(graph.nodes[node as usize].operation, Operation::Constant(_));
    (is_number(a), a) <= (is_number(b), b)
}

fn add(a: Sym, b: Sym) -> Sym {
    match (a, b) {
        (Sym::Number(a), Sym::Number(b)) => Sym::Number(folded(a, b, |a, b| a + b)),
        (Sym::Number(zero), other) | (other, Sym::Number(zero)) if zero == 0.0 => other,
        _ => CURRENT.with_borrow_mut(|graph| {
            let (a, b) = (value(graph, a), value(graph, b));
            add_nodes(graph, a, b)
        }),
    }
}

fn add_nodes(graph: &mut Graph, a: Value, b: Value) -> Sym {
    if a.node == b.node {
        if a.negative != b.negative {
            return Sym::Number(0.0);
        }
        return Sym::Node(Value {
            node: doubled(graph, a.node),
            negative: a.negative,
        });
    }
    let (first, second) = match precedes(graph, a.node, b.node) {
        true => (a, b),
        false => (b, a),
    };
    let operation = if first.negative == second.negative {
        Operation::Sum(first.node, second.node)
    } else {
        Operation::Difference(first.node, second.node)
    };
    Sym::Node(Value {
        node: graph.node(operation),
        negative: first.negative,
    })
}

/// Twice a node: a sum, which costs less than a product where products set the pace, unless it is multiplied by a number already.
fn doubled(graph: &mut Graph, node: u32) -> u32 {
    match scaled(graph, node, 2.0) {
        Some((of, 1.0)) => of,
        Some((of, factor)) => {
            let factor = graph.node(Operation::Constant(factor.to_bits()));
            graph.node(Operation::Product(of, factor))
        }
        None => graph.node(Operation::Sum(node, node)),
    }
}

fn multiply(a: Sym, b: Sym) -> Sym {
    match (a, b) {
        (Sym::Number(a), Sym::Number(b)) => Sym::Number(folded(a, b, |a, b| a * b)),
        (Sym::Number(number), other) | (other, Sym::Number(number)) if number == 0.0 => {
            let _ = other;
            Sym::Number(0.0)
        }
        (Sym::Number(number), other) | (other, Sym::Number(number)) if number == 1.0 => other,
        (Sym::Number(number), other) | (other, Sym::Number(number)) if number == -1.0 => -other,
        (Sym::Number(number), other) | (other, Sym::Number(number)) if number == 2.0 => {
            other + other
        }
        _ => CURRENT.with_borrow_mut(|graph| {
            let (a, b) = (value(graph, a), value(graph, b));
            multiply_nodes(graph, a, b)
        }),
    }
}

fn multiply_nodes(graph: &mut Graph, a: Value, b: Value) -> Sym {
    let (first, second) = match precedes(graph, a.node, b.node) {
        true => (a.node, b.node),
        false => (b.node, a.node),
    };
    let negative = a.negative != b.negative;
    let factor = constant(graph, second).and_then(|factor| scaled(graph, first, factor));
    let (first, second) = match factor {
        Some((node, 1.0)) => return Sym::Node(Value { node, negative }),
        Some((node, 2.0)) => {
            let node = graph.node(Operation::Sum(node, node));
            return Sym::Node(Value { node, negative });
        }
        Some((node, factor)) => {
            let factor = graph.node(Operation::Constant(factor.to_bits()));
            (node, factor)
        }
        None => (first, second),
    };
    Sym::Node(Value {
        node: graph.node(Operation::Product(first, second)),
        negative,
    })
}

/// The number that a node is.
fn constant(graph: &Graph, node: u32) -> Option<f64> {
    match graph.nodes[node as usize].operation {
        Operation::Constant(bits) => Some(f64::from_bits(bits)),
        _ => None,
    }
}

/// A node and the number that it is multiplied by, where `product` is such a product already: one instead of two.
fn scaled(graph: &Graph, product: u32, by: f64) -> Option<(u32, f64)> {
    let (node, factor) = match graph.nodes[product as usize].operation {
        Operation::Product(node, factor) => (node, constant(graph, factor)?),
        Operation::Sum(node, same) if node == same => (node, 2.0),
        _ => return None,
    };
    let factor = by * factor;
    // Beyond the range of doubles the two factors are not one.
    factor.is_normal().then_some((node, factor))
}

fn divide(a: Sym, b: Sym) -> Sym {
    match (a, b) {
        (Sym::Number(a), Sym::Number(b)) => Sym::Number(folded(a, divisor(b), |a, b| a / b)),
        (Sym::Number(0.0), _) => a,
        (_, Sym::Number(1.0)) => a,
        (_, Sym::Number(-1.0)) => -a,
        (above, Sym::Number(below)) => quotient(above, Sym::Number(divisor(below))),
        (above, below) => quotient(above, below),
    }
}

fn quotient(above: Sym, below: Sym) -> Sym {
    CURRENT.with_borrow_mut(|graph| {
        let (a, b) = (value(graph, above), value(graph, below));
        Sym::Node(Value {
            node: graph.node(Operation::Quotient(a.node, b.node)),
            negative: a.negative != b.negative,
        })
    })
}

impl Neg for Sym {
    type Output = Self;
    fn neg(self) -> Self {
        match self {
            // Not −0: zero has no sign here.
            Self::Number(0.0) => self,
            // What is no number keeps what it says.
            Self::Number(number) if number.is_nan() => self,
            Self::Number(number) => Self::Number(-number),
            Self::Node(value) => Self::Node(value.opposite()),
        }
    }
}

macro_rules! operators {
    ($($operator:ident $method:ident $assign:ident $assign_method:ident $function:expr),*) => {$(
        impl $operator for Sym {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                $function(self, other)
            }
        }
        impl $assign for Sym {
            fn $assign_method(&mut self, other: Self) {
                *self = $function(*self, other);
            }
        }
    )*};
}
operators!(
    Add add AddAssign add_assign add,
    Sub sub SubAssign sub_assign |a, b: Sym| add(a, -b),
    Mul mul MulAssign mul_assign multiply,
    Div div DivAssign div_assign divide
);

impl Zero for Sym {
    fn zero() -> Self {
        Self::Number(0.0)
    }
    fn is_zero(&self) -> bool {
        self.number() == Some(0.0)
    }
}

impl One for Sym {
    fn one() -> Self {
        Self::Number(1.0)
    }
}

impl From<f64> for Sym {
    /// A number from outside of the graph.
    fn from(number: f64) -> Self {
        let marked = CURRENT.with_borrow(|graph| graph.marks.get(&number.abs().to_bits()).copied());
        match marked {
            None => Self::Number(sound(number)),
            Some(place) => {
                let given = make(Operation::Input(Argument::Given, place));
                if number < 0.0 { -given } else { given }
            }
        }
    }
}

impl std::iter::Sum for Sym {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::zero(), Add::add)
    }
}
