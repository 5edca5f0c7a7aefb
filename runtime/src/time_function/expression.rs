//! A formula in the time.

use super::interval::Interval;
use super::jet::{Jet, Real};
use super::parse::{SyntaxError, parse};
use super::{KinkError, Moment, pulses, switches};
use alloc::boxed::Box;
use alloc::string::String;

/// The largest power that is taken as a product.
const LARGEST_WHOLE: f64 = 1024.0;

/// A function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Sin,
    Cos,
    Tan,
    Exp,
    Log,
    Sqrt,
    Abs,
    Step,
}

/// An operation on two arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Smaller,
    Larger,
}

/// A formula, as a tree.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    Number(f64),
    Time,
    Negative(Box<Node>),
    Call(Function, Box<Node>),
    Pair(Operator, Box<Node>, Box<Node>),
}

/// A formula in the time `t`: numbers, `pi`, `+ - * / ^`, parentheses, `sin`, `cos`, `tan`, `exp`, `log` (to the base e), `sqrt`, `abs`, `min`,
/// `max`, and `step`, which is 0 while its argument is negative and 1 from then on.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    text: String,
    root: Node,
}

impl Expression {
    /// Reads a formula.
    ///
    /// # Errors
    /// What cannot be read, and where it is.
    pub fn new(text: &str) -> Result<Self, SyntaxError> {
        Ok(Self {
            root: parse(text)?,
            text: text.into(),
        })
    }

    /// The formula as it was given.
    pub fn text(&self) -> &str {
        &self.text
    }

    pub(super) fn value(&self, at: Moment) -> f64 {
        self.root.at(at).value
    }

    pub(super) fn slope(&self, at: Moment) -> f64 {
        self.root.at(at).slope
    }

    pub(super) fn constant(&self) -> Option<f64> {
        let is_constant = !self.root.contains(&|node| matches!(node, Node::Time));
        is_constant.then(|| self.value(Moment::default()))
    }

    pub(super) fn jump(&self) -> Option<&'static str> {
        let is_step = |node: &Node| matches!(node, Node::Call(Function::Step, _));
        self.root.contains(&is_step).then_some("`step`")
    }

    pub(super) fn end_before_pulse(&self, step: [f64; 2], motion: [f64; 2]) -> f64 {
        pulses::end_before(&self.root, step, motion)
    }

    pub(super) fn next_kink(&self, after: f64, until: f64) -> Result<Option<f64>, KinkError> {
        switches::first(&self.root, after, until).map_err(|switch| KinkError {
            function: self.text.clone(),
            switch,
            from: after,
            until,
        })
    }
}

impl Node {
    pub(super) fn at(&self, at: Moment) -> Jet<f64> {
        self.evaluate(Jet {
            value: at.time,
            slope: 1.0,
            side: at.within,
        })
    }

    /// All values and slopes from one time to another, each by the pieces that hold there.
    pub(super) fn over(&self, from: f64, to: f64) -> Jet<Interval> {
        let time = Interval::new(from, to);
        self.evaluate(Jet {
            value: time,
            slope: Interval::number(1.0),
            side: time,
        })
    }

    pub(super) fn evaluate<T: Real>(&self, time: Jet<T>) -> Jet<T> {
        match self {
            Self::Number(number) => Jet::number(*number),
            Self::Time => time,
            Self::Negative(of) => of.evaluate(time).negate(),
            Self::Call(function, of) => {
                let x = of.evaluate(time);
                match function {
                    Function::Sin => x.sin(),
                    Function::Cos => x.cos(),
                    Function::Tan => x.sin().divide(x.cos()),
                    Function::Exp => x.exp(),
                    Function::Log => x.ln(),
                    Function::Sqrt => x.sqrt(),
                    Function::Abs => x.abs(),
                    Function::Step => x.step(),
                }
            }
            Self::Pair(Operator::Power, base, exponent) => power(base, exponent, time),
            Self::Pair(operator, a, b) => {
                let (a, b) = (a.evaluate(time), b.evaluate(time));
                match operator {
                    Operator::Add => a.add(b),
                    Operator::Subtract => a.subtract(b),
                    Operator::Multiply => a.multiply(b),
                    Operator::Divide => a.divide(b),
                    Operator::Larger => a.larger(b),
                    Operator::Smaller => a.smaller(b),
                    Operator::Power => b.multiply(a.ln()).exp(),
                }
            }
        }
    }

    /// Whether any part of it is such.
    fn contains(&self, is_such: &impl Fn(&Self) -> bool) -> bool {
        is_such(self)
            || match self {
                Self::Number(_) | Self::Time => false,
                Self::Negative(of) | Self::Call(_, of) => of.contains(is_such),
                Self::Pair(_, a, b) => a.contains(is_such) || b.contains(is_such),
            }
    }

    /// The number that it is, if it is one.
    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Negative(of) => of.number().map(|number| -number),
            _ => None,
        }
    }
}

/// A power: of any base where the exponent is a whole number, else of one that is positive.
fn power<T: Real>(base: &Node, exponent: &Node, time: Jet<T>) -> Jet<T> {
    let base = base.evaluate(time);
    let Some(number) = exponent.number() else {
        return exponent.evaluate(time).multiply(base.ln()).exp();
    };
    match number as i32 {
        whole if f64::from(whole) == number && number.abs() <= LARGEST_WHOLE => base.powi(whole),
        _ => base.powf(number),
    }
}
