//! Numbers that are none: what makes one on the graph is kept with it, so that an error can name it.
//!
//! Arithmetic on the graph is in doubles, whose range ends: masses of 1e300 at arms of 1e10, moments of inertia that are 0 where they are divided
//! by. What first leaves the numbers becomes a NaN that carries the number of a [`Fault`]; what is made of it keeps that NaN. So whoever finds it in
//! what is to be written knows where it came from, and what nothing needs disturbs nobody.

use super::{CURRENT, Graph, Operation, Sym, Value};
use std::fmt::{Display, Formatter};

/// The bits of a NaN that hold the number of a fault.
const NUMBER: u64 = (1 << 50) - 1;

/// Divisors below this have no inverse: 1 over the largest double, and a rounding more.
const LEAST_DIVISOR: f64 = 5.6e-309;

/// What left the numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// What was being computed, where it is no part of a body: a spring, a constraint.
    pub element: Option<String>,
    /// The section of the code, otherwise: the number of its body.
    pub section: u32,
    /// What of that body.
    pub topic: &'static str,
    /// What happened.
    pub cause: Cause,
}

/// How numbers are left.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cause {
    /// A result beyond the range of doubles, or a function where it has no value.
    Range,
    /// Division by 0, or by what has no inverse.
    Division,
    /// Of the inertia that moves with a speed of the body's joint, in words.
    Inertia(String),
}

impl Display for Cause {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Range => f.write_str("comes to a number that is not finite"),
            Self::Division => {
                f.write_str("divides by a number that is 0, or too small to have an inverse")
            }
            Self::Inertia(words) => f.write_str(words),
        }
    }
}

/// What follows in `build` is about an element that is no body, whatever section it is in.
pub fn about<R>(element: &str, build: impl FnOnce() -> R) -> R {
    let name = Some(element.to_owned());
    let before = CURRENT.with_borrow_mut(|graph| std::mem::replace(&mut graph.element, name));
    let result = build();
    CURRENT.with_borrow_mut(|graph| graph.element = before);
    result
}

/// The inverse of a pivot of the mass matrix; `words` say what is wrong with one that is not positive.
pub fn inverse_of_inertia(pivot: Sym, words: impl FnOnce(f64) -> String) -> Sym {
    match pivot {
        Sym::Number(pivot) if pivot.is_finite() && pivot <= 0.0 => {
            Sym::Number(broken(Cause::Inertia(words(pivot))))
        }
        pivot => Sym::Number(1.0) / pivot,
    }
}

/// A NaN that says why.
fn broken(cause: Cause) -> f64 {
    CURRENT.with_borrow_mut(|graph| {
        graph.faults.push(Fault {
            element: graph.element.clone(),
            section: graph.section,
            topic: graph.topic,
            cause,
        });
        let number = u64::try_from(graph.faults.len()).unwrap_or(NUMBER);
        f64::from_bits(f64::NAN.to_bits() | number.min(NUMBER))
    })
}

/// The number; a NaN that says why where it is none. For what comes from outside of the graph.
pub(super) fn sound(number: f64) -> f64 {
    match number.is_finite() {
        true => number,
        false => broken(Cause::Range),
    }
}

/// The result of an operation on two numbers; the first of them that is none where one is.
pub(super) fn folded(a: f64, b: f64, operation: impl FnOnce(f64, f64) -> f64) -> f64 {
    match (a.is_nan(), b.is_nan()) {
        (true, _) => a,
        (_, true) => b,
        _ => sound(operation(a, b)),
    }
}

/// The divisor; a NaN that says why where it has no inverse.
pub(super) fn divisor(number: f64) -> f64 {
    match number.is_nan() || number.abs() >= LEAST_DIVISOR {
        true => number,
        false => broken(Cause::Division),
    }
}

impl Graph {
    /// What left the numbers on the way to what `outputs` need, each once.
    pub fn faults(&self, outputs: &[Value]) -> Vec<Fault> {
        let uses = self.uses(outputs);
        let needed = self.nodes.iter().zip(&uses).filter(|(_, uses)| **uses > 0);
        let mut found: Vec<Fault> = vec![];
        for (node, _) in needed {
            let Operation::Constant(bits) = node.operation else {
                continue;
            };
            if f64::from_bits(bits).is_finite() {
                continue;
            }
            let known = usize::try_from(bits & NUMBER).ok();
            let known = known.and_then(|number| self.faults.get(number.checked_sub(1)?));
            let fault = known.cloned().unwrap_or(Fault {
                element: None,
                section: node.section,
                topic: node.topic,
                cause: Cause::Range,
            });
            if !found.contains(&fault) {
                found.push(fault);
            }
        }
        found
    }
}
