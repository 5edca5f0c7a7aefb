//! Values with their derivative in time, in doubles or in intervals.

use super::interval::Interval;
use core::ops::{Add, Div, Mul, Neg, Sub};
use num_traits::Float;

/// Numbers that expressions are evaluated in.
pub(super) trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    fn number(number: f64) -> Self;
    fn sin(self) -> Self;
    fn cos(self) -> Self;
    fn exp(self) -> Self;
    fn ln(self) -> Self;
    fn sqrt(self) -> Self;
    fn powi(self, exponent: i32) -> Self;
    fn powf(self, exponent: f64) -> Self;
    /// Whether it is negative; `None` where that cannot be determined.
    fn is_negative(self) -> Option<bool>;
    /// The larger one of two; not a number where one is not.
    fn larger(self, other: Self) -> Self;
    /// Both, where it cannot be determined which is meant.
    fn hull(self, other: Self) -> Self;
    /// The slope of what jumps somewhere.
    fn unbounded() -> Self;
}

impl Real for f64 {
    fn number(number: f64) -> Self {
        number
    }
    fn sin(self) -> Self {
        Float::sin(self)
    }
    fn cos(self) -> Self {
        Float::cos(self)
    }
    fn exp(self) -> Self {
        Float::exp(self)
    }
    fn ln(self) -> Self {
        Float::ln(self)
    }
    fn sqrt(self) -> Self {
        Float::sqrt(self)
    }
    fn powi(self, exponent: i32) -> Self {
        Float::powi(self, exponent)
    }
    fn powf(self, exponent: f64) -> Self {
        Float::powf(self, exponent)
    }
    fn is_negative(self) -> Option<bool> {
        Some(self < 0.0)
    }
    fn larger(self, other: Self) -> Self {
        match self.partial_cmp(&other) {
            Some(core::cmp::Ordering::Less) => other,
            Some(_) => self,
            None => Self::NAN,
        }
    }
    fn hull(self, _other: Self) -> Self {
        self
    }
    fn unbounded() -> Self {
        Self::NAN
    }
}

impl Real for Interval {
    fn number(number: f64) -> Self {
        Self::number(number)
    }
    fn sin(self) -> Self {
        self.sin()
    }
    fn cos(self) -> Self {
        // The quarter turn is a double like any other: what it lacks is within what the sine is widened by.
        (self + Self::number(core::f64::consts::FRAC_PI_2)).sin()
    }
    fn exp(self) -> Self {
        self.exp()
    }
    fn ln(self) -> Self {
        self.ln()
    }
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    fn powi(self, exponent: i32) -> Self {
        self.powi(exponent)
    }
    fn powf(self, exponent: f64) -> Self {
        self.powf(exponent)
    }
    fn is_negative(self) -> Option<bool> {
        self.is_negative()
    }
    fn larger(self, other: Self) -> Self {
        Self::new(self.low.max(other.low), self.high.max(other.high))
    }
    fn hull(self, other: Self) -> Self {
        self.hull(other)
    }
    fn unbounded() -> Self {
        Self::everything()
    }
}

/// A value, its derivative in time, and the value at the time that tells which piece is meant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jet<T> {
    pub(super) value: T,
    pub(super) slope: T,
    pub(super) side: T,
}

impl<T: Real> Jet<T> {
    pub(super) fn number(number: f64) -> Self {
        let value = T::number(number);
        Self {
            value,
            slope: T::number(0.0),
            side: value,
        }
    }

    fn map(self, function: impl Fn(T) -> T, derivative: T) -> Self {
        Self {
            value: function(self.value),
            slope: self.slope * derivative,
            side: function(self.side),
        }
    }

    fn zip(self, other: Self, function: impl Fn(T, T) -> T, slope: T) -> Self {
        Self {
            value: function(self.value, other.value),
            slope,
            side: function(self.side, other.side),
        }
    }

    pub(super) fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b, self.slope + other.slope)
    }

    pub(super) fn subtract(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b, self.slope - other.slope)
    }

    pub(super) fn multiply(self, other: Self) -> Self {
        let slope = self.slope * other.value + self.value * other.slope;
        self.zip(other, |a, b| a * b, slope)
    }

    pub(super) fn divide(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        let slope = (self.slope - quotient * other.slope) / other.value;
        self.zip(other, |a, b| a / b, slope)
    }

    pub(super) fn negate(self) -> Self {
        self.map(|x| -x, T::number(-1.0))
    }

    pub(super) fn sin(self) -> Self {
        self.map(T::sin, self.value.cos())
    }

    pub(super) fn cos(self) -> Self {
        self.map(T::cos, -self.value.sin())
    }

    pub(super) fn exp(self) -> Self {
        self.map(T::exp, self.value.exp())
    }

    pub(super) fn ln(self) -> Self {
        self.map(T::ln, T::number(1.0) / self.value)
    }

    pub(super) fn sqrt(self) -> Self {
        self.map(T::sqrt, T::number(0.5) / self.value.sqrt())
    }

    /// A power that is a whole number.
    pub(super) fn powi(self, exponent: i32) -> Self {
        match exponent {
            0 => Self::number(1.0),
            _ => {
                let slope = T::number(f64::from(exponent)) * self.value.powi(exponent - 1);
                self.map(|x| x.powi(exponent), slope)
            }
        }
    }

    /// Any other power that does not change.
    pub(super) fn powf(self, exponent: f64) -> Self {
        let slope = T::number(exponent) * self.value.powf(exponent - 1.0);
        self.map(|x| x.powf(exponent), slope)
    }

    /// `|x|`.
    pub(super) fn abs(self) -> Self {
        self.larger(self.negate())
    }

    /// 0 before its argument is 0, and 1 from then on.
    pub(super) fn step(self) -> Self {
        let mut chosen = self.choose(Self::number(1.0), Self::number(0.0));
        if self.side.is_negative().is_none() {
            chosen.slope = T::unbounded();
        }
        chosen
    }

    /// The slope is that of the piece that is meant. The value is that of the larger one at the time itself: roundings beyond the piece do not make it the smaller one, of
    /// which there may be no root.
    pub(super) fn larger(self, other: Self) -> Self {
        let chosen = self.subtract(other).choose(self, other);
        let value = self.value.larger(other.value);
        Self { value, ..chosen }
    }

    pub(super) fn smaller(self, other: Self) -> Self {
        self.negate().larger(other.negate()).negate()
    }

    /// One of two, by the sign of this.
    fn choose(self, positive: Self, negative: Self) -> Self {
        match self.side.is_negative() {
            Some(false) => positive,
            Some(true) => negative,
            None => Self {
                value: positive.value.hull(negative.value),
                slope: positive.slope.hull(negative.slope),
                side: positive.side.hull(negative.side),
            },
        }
    }
}
