//! Functions of time: efforts, forces and prescribed speeds as a scene gives them.
//!
//! Between two of its kinks a function is smooth, and a step that ends on each kink keeps its order. Which of two pieces is meant at a kink itself,
//! the time alone does not tell: a [`Moment`] names a time within the piece as well.

mod expression;
mod interval;
mod jet;
mod law;
mod parse;
mod pulses;
mod spline;
mod switches;
mod table;

pub use expression::Expression;
pub use law::Law;
pub use parse::SyntaxError;
pub use table::{Outside, Table, TableError, TableKind};

use alloc::string::String;
use alloc::sync::Arc;

/// A time, and the piece of piecewise functions that is meant there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// The time, s.
    pub time: f64,
    /// A time within the piece, s. At a kink, the piece before it and the one after it have values of their own.
    pub within: f64,
}

impl From<f64> for Moment {
    /// At a kink, the piece that begins there.
    fn from(time: f64) -> Self {
        Self { time, within: time }
    }
}

/// Why the kinks of a function cannot be followed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "`{function}`: between {from} s and {until} s the argument of `{switch}` changes its sign too often to be followed, or is 0 up to rounding: \
     give a table, or an argument whose sign changes can be distinguished"
)]
pub struct KinkError {
    /// The function.
    pub function: String,
    /// The function in it that switches.
    pub switch: &'static str,
    /// Where the search began, s.
    pub from: f64,
    /// Where it would have ended, s.
    pub until: f64,
}

/// A number that may change with time.
#[derive(Clone, Debug, PartialEq)]
pub enum TimeFunction {
    /// It does not.
    Constant(f64),
    /// A mean value and a sine.
    Sine(Law),
    /// A formula.
    Expression(Arc<Expression>),
    /// Values at given times.
    Table(Arc<Table>),
}

impl TimeFunction {
    /// The value.
    pub fn value(&self, at: Moment) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Sine(law) => law.velocity(at.time),
            Self::Expression(expression) => expression.value(at),
            Self::Table(table) => table.value(at),
        }
    }

    /// The derivative, 1/s.
    pub fn slope(&self, at: Moment) -> f64 {
        match self {
            Self::Constant(_) => 0.0,
            Self::Sine(law) => law.acceleration(at.time),
            Self::Expression(expression) => expression.slope(at),
            Self::Table(table) => table.slope(at),
        }
    }

    /// The first time after `after`, up to `until`, at which the function or its derivative may jump.
    ///
    /// # Errors
    /// A switch in an expression whose argument changes its sign too often.
    pub fn next_kink(&self, after: f64, until: f64) -> Result<Option<f64>, KinkError> {
        match self {
            Self::Constant(_) | Self::Sine(_) => Ok(None),
            Self::Expression(expression) => expression.next_kink(after, until),
            Self::Table(table) => Ok(table.next_kink(after).filter(|kink| *kink <= until)),
        }
    }

    /// The end of a step of a motion in which no pulse of the function lies unseen, and no more than about a period: that of the step, or an earlier time. Both are told by
    /// their ends, s.
    ///
    /// A pulse is a value far from the cubic polynomials through the values and slopes at both ends of each quarter of the step. `exp(-((t - 5) / 0.01)^2)` has one within a step of
    /// ten seconds, and a cubic table may; `sin(1000 * t)` has many. Steps end at all times of other tables.
    pub fn end_before_pulse(&self, step: [f64; 2], motion: [f64; 2]) -> f64 {
        match self {
            Self::Expression(expression) => expression.end_before_pulse(step, motion),
            Self::Table(table) => table.end_before_pulse(step),
            Self::Constant(_) => step[1],
            Self::Sine(law) => law.end_within_period(step),
        }
    }

    /// The value, where it never changes.
    pub fn constant(&self) -> Option<f64> {
        match self {
            Self::Constant(value) => Some(*value),
            Self::Sine(law) if law.amplitude == 0.0 || law.frequency == 0.0 => {
                Some(law.velocity(0.0))
            }
            Self::Sine(_) => None,
            Self::Expression(expression) => expression.constant(),
            Self::Table(_) => None,
        }
    }

    /// What of it jumps, if anything does: there is no derivative where it does.
    pub fn jump(&self) -> Option<&'static str> {
        match self {
            Self::Constant(_) | Self::Sine(_) => None,
            Self::Expression(expression) => expression.jump(),
            Self::Table(table) => table.jump(),
        }
    }

    /// The first of its numbers that is not finite.
    pub fn infinite_number(&self) -> Option<f64> {
        let numbers = match self {
            Self::Constant(value) => [*value, 0.0, 0.0, 0.0],
            Self::Sine(law) => [law.rate, law.amplitude, law.frequency, law.phase],
            // These cannot be made with such numbers.
            Self::Expression(_) | Self::Table(_) => return None,
        };
        numbers.into_iter().find(|number| !number.is_finite())
    }
}

impl From<f64> for TimeFunction {
    fn from(value: f64) -> Self {
        Self::Constant(value)
    }
}

impl From<Law> for TimeFunction {
    fn from(law: Law) -> Self {
        Self::Sine(law)
    }
}

/// The first of several kinks.
pub(crate) fn first_kink<'a>(
    functions: impl Iterator<Item = &'a TimeFunction>,
    after: f64,
    until: f64,
) -> Result<Option<f64>, KinkError> {
    let mut first = None;
    for function in functions {
        let kink = function.next_kink(after, first.unwrap_or(until))?;
        first = kink.or(first);
    }
    Ok(first)
}
