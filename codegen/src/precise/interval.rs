//! Interval arithmetic with outward rounding: an enclosure of every value that an expression takes.
//!
//! The ends are binary floating-point numbers with exponents of 32 bits, so that products of very small or very large numbers
//! neither vanish nor overflow. Sums, products and quotients are rounded outwards. Functions round to nearest; their ends are moved outwards
//! by more than that error.
//! Where a function has no value, or an end overflows, the enclosure is unbounded and says nothing.

pub mod curve;

use super::Precise;
use super::number::End;
use crate::expr::{Function, Number, Rational};

/// An end of a function is moved outwards by 2² units in the last place: functions err by one, and a rational with long numerator and
/// denominator by two and a half.
const OUTWARD_BITS: i32 = 2;

/// The denominator of a rational bound, and the largest numerator, which a double holds exactly.
const BOUND_SCALE: i64 = 1 << 32;
const LARGEST_SCALED: f64 = 9_007_199_254_740_992.0;

/// Where an interval lies beside 0, which may be an end of it.
#[derive(Clone, Copy, Eq, PartialEq)]
enum Side {
    Below,
    Both,
    Above,
}

/// A closed interval of real numbers; an end may be infinite.
#[derive(Clone, Debug)]
pub struct Interval {
    low: Precise,
    high: Precise,
}

impl Interval {
    /// The interval of one number.
    pub fn point(value: Precise) -> Self {
        match value.is_finite() {
            true => Self {
                low: value.clone(),
                high: value,
            },
            false => Self::whole(value.bits()),
        }
    }

    /// The interval between two numbers, in either order.
    pub fn between(a: Precise, b: Precise) -> Self {
        match a.compare(&b) {
            Some(std::cmp::Ordering::Greater) => Self { low: b, high: a },
            Some(_) => Self { low: a, high: b },
            None => Self::whole(a.bits()),
        }
    }

    /// All real numbers: nothing is known.
    pub fn whole(bits: usize) -> Self {
        let infinity = Precise::infinity(bits);
        Self {
            low: -&infinity,
            high: infinity,
        }
    }

    /// The lower end.
    pub fn low(&self) -> &Precise {
        &self.low
    }

    /// The upper end.
    pub fn high(&self) -> &Precise {
        &self.high
    }

    /// Precision of the ends in bits.
    pub fn bits(&self) -> usize {
        self.low.bits()
    }

    /// Whether every number in it is above 0.
    pub fn is_positive(&self) -> bool {
        !self.low.is_negative() && !self.low.is_zero()
    }

    /// Whether every number in it is below 0.
    pub fn is_negative(&self) -> bool {
        self.high.is_negative()
    }

    /// Whether 0 is not in it.
    pub fn excludes_zero(&self) -> bool {
        self.is_positive() || self.is_negative()
    }

    /// Whether both ends are numbers.
    pub fn is_bounded(&self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// A number near the middle; NaN where the interval is unbounded.
    pub fn middle(&self) -> Precise {
        (&self.low + &self.high).halved(1)
    }

    /// The largest absolute value in it.
    pub fn largest_size(&self) -> Precise {
        larger(self.low.abs(), self.high.abs())
    }

    /// A rational number of few digits that no absolute value in it exceeds; `None` where it is unbounded or large.
    pub fn rational_bound(&self) -> Option<Rational> {
        let scale = BOUND_SCALE as f64;
        let scaled = (self.largest_size().to_f64().next_up() * scale).ceil();
        let known = self.is_bounded() && scaled < LARGEST_SCALED;
        known.then(|| Rational::new((scaled as i64).into(), BOUND_SCALE.into()))
    }

    /// The smallest absolute value in it.
    pub fn least_size(&self) -> Precise {
        match self.excludes_zero() {
            true => smaller(self.low.abs(), self.high.abs()),
            false => self.low.same(0),
        }
    }

    /// The number in it that is closest to 0.
    pub fn nearest_to_zero(&self) -> Precise {
        match self.is_negative() {
            true => -self.least_size(),
            false => self.least_size(),
        }
    }

    /// The absolute values of its numbers.
    pub fn abs(&self) -> Self {
        Self {
            low: self.least_size(),
            high: self.largest_size(),
        }
    }

    /// From ends that were rounded to nearest.
    fn outward(low: Precise, high: Precise) -> Self {
        Self {
            low: down(&low),
            high: up(&high),
        }
    }

    /// By a function that grows.
    fn growing(&self, function: impl Fn(&Precise) -> Precise) -> Self {
        match self.is_bounded() {
            true => {
                let low = around(&self.low, &function);
                match self.is_point() {
                    true => low,
                    false => Self {
                        low: low.low,
                        high: around(&self.high, &function).high,
                    },
                }
            }
            false => Self::whole(self.bits()),
        }
    }

    fn is_point(&self) -> bool {
        self.low.compare(&self.high) == Some(std::cmp::Ordering::Equal)
    }

    /// Cut to what a function is known to take.
    fn within(self, low: i64, high: i64) -> Self {
        let (low, high) = (self.low.same(low), self.low.same(high));
        Self {
            low: larger(self.low, low),
            high: smaller(self.high, high),
        }
    }

    fn sqrt(&self) -> Self {
        match self.low.is_negative() {
            true => Self::whole(self.bits()),
            false => {
                let root = self.growing(Precise::sqrt);
                let zero = self.low.same(0);
                Self {
                    low: larger(root.low, zero),
                    high: root.high,
                }
            }
        }
    }

    fn exp(&self) -> Self {
        let value = self.growing(Precise::exp);
        let zero = self.low.same(0);
        Self {
            low: larger(value.low, zero),
            high: value.high,
        }
    }

    fn ln(&self) -> Self {
        match self.is_positive() {
            true => self.growing(Precise::ln),
            false => Self::whole(self.bits()),
        }
    }

    /// By an even function that grows with the size of its argument.
    fn growing_with_size(&self, function: impl Fn(&Precise) -> Precise) -> Self {
        match self.is_bounded() {
            true => self.abs().growing(function),
            false => Self::whole(self.bits()),
        }
    }

    /// Logarithm of the hyperbolic cosine: where 1 + x is 1 to all digits, between x²/2 (1 − x²/6) and x²/2.
    fn ln_cosh(&self) -> Self {
        let half = Self::point(self.low.same(1).halved(1));
        match self.is_bounded() && self.largest_size().is_negligible() {
            true => {
                let first = self.square().times(&half);
                let low = down(&first.low);
                Self {
                    low: larger(low, self.low.same(0)),
                    high: first.high,
                }
            }
            false => self.growing_with_size(Precise::ln_cosh),
        }
    }

    /// 1/cosh: of what cosh overflows to, a number between 0 and the smallest ones.
    fn sech(&self) -> Self {
        let cosh = self.growing_with_size(Precise::cosh);
        let zero = self.low.same(0);
        let one = Self::point(zero.same(1));
        match cosh.high.is_finite() {
            true => one.over(&cosh),
            false => Self {
                low: zero,
                high: one
                    .over(&Self::point(larger(cosh.low, one.low.clone())))
                    .high,
            },
        }
    }

    /// Cosine: its extremes are at whole multiples of π.
    pub fn cos(&self) -> Self {
        self.wave(&self.low.same(0), Precise::cos)
    }

    /// Sine: its extremes are half a turn further.
    pub fn sin(&self) -> Self {
        self.wave(&self.low.same(1).halved(1), Precise::sin)
    }

    /// Sine or cosine, with maxima at `(offset + 2 n) π` and minima at `(offset + 2 n + 1) π`.
    fn wave(&self, offset: &Precise, function: impl Fn(&Precise) -> Precise) -> Self {
        let all = || {
            let zero = self.low.same(0);
            Self::point(zero.clone()).plus(&Self::between(zero.same(-1), zero.same(1)))
        };
        if !self.is_bounded() {
            return all();
        }
        let half_turns = self.over(&Self::pi(self.bits()));
        let half_turns = half_turns.plus(&Self::point(-offset));
        let (first, last) = (half_turns.low.to_f64(), half_turns.high.to_f64());
        if !(first.abs() < LARGEST_TURNS && last.abs() < LARGEST_TURNS) || last - first > 2.0 {
            return all();
        }
        let a = around(&self.low, &function);
        let b = match self.is_point() {
            true => a.clone(),
            false => around(&self.high, &function),
        };
        let mut value = Self {
            low: smaller(a.low, b.low),
            high: larger(a.high, b.high),
        };
        // Doubles this far from their limit move by less than 1: one more extreme on either side only widens the enclosure.
        let (first, last) = (
            (first - TURNS_ROUNDING).ceil(),
            (last + TURNS_ROUNDING).floor(),
        );
        let mut extreme = first;
        while extreme <= last {
            match extreme.rem_euclid(2.0) == 0.0 {
                true => value.high = value.high.same(1),
                false => value.low = value.low.same(-1),
            }
            extreme += 1.0;
        }
        value.within(-1, 1)
    }

    fn pi(bits: usize) -> Self {
        let pi = Precise::pi(bits);
        Self::outward(pi.clone(), pi)
    }

    fn atan(&self) -> Self {
        self.growing(Precise::atan)
    }

    /// The angle of the points (`x`, `self`).
    fn atan2(&self, x: &Self) -> Self {
        let half = |interval: Self| interval.times(&Self::point(self.low.same(1).halved(1)));
        let right_angle = half(Self::pi(self.bits()));
        if x.is_positive() {
            return self.over(x).atan();
        }
        match (self.is_positive(), self.is_negative()) {
            (true, _) => right_angle.plus(&x.over(self).atan().negative()),
            (_, true) => right_angle.plus(&x.over(self).atan()).negative(),
            _ => {
                let pi = Self::pi(self.bits());
                Self::between(-&pi.high, pi.high)
            }
        }
    }

    /// Stumpff functions: |c_k(s)| ≤ exp √|s| / k!, and c_k′ = (k c_{k+2} − c_{k+1}) / 2 is smaller than that.
    fn stumpff(&self, order: u32) -> Self {
        if !self.is_bounded() {
            return Self::whole(self.bits());
        }
        let radius = up(&(&self.high - &self.low));
        let bound = up(&up(&self.largest_size().sqrt()).exp());
        let middle = self.middle();
        // The value is within units of the last place of the bound; the bits beyond make up for the sizes of √|s| that occur.
        let rounding = bound.halved(self.bits() as i32 - 8);
        let error = up(&(up(&(&radius * &bound)) + rounding));
        let value = middle.stumpff(order);
        Self::outward(&value - &error, &value + &error)
    }

    fn negative(&self) -> Self {
        Self {
            low: -&self.high,
            high: -&self.low,
        }
    }

    fn square(&self) -> Self {
        let size = self.abs();
        Self {
            low: product(&size.low, &size.low, End::Low),
            high: product(&size.high, &size.high, End::High),
        }
    }

    fn side(&self) -> Side {
        match (self.low.is_negative(), self.high.is_negative()) {
            (false, _) => Side::Above,
            (_, true) => Side::Below,
            _ if self.high.is_zero() => Side::Below,
            _ => Side::Both,
        }
    }

    /// The product by an interval on one side of 0, which is `self`.
    fn sided_product(&self, other: &Self) -> Self {
        if self.side() == Side::Below {
            return self.negative().sided_product(other).negative();
        }
        let (near, far) = (&self.low, &self.high);
        let of_low = if other.low.is_negative() { far } else { near };
        let of_high = if other.high.is_negative() { near } else { far };
        Self {
            low: product(of_low, &other.low, End::Low),
            high: product(of_high, &other.high, End::High),
        }
    }

    /// The product of two intervals with 0 inside.
    fn mixed_product(&self, other: &Self) -> Self {
        let low = |a, b| product(a, b, End::Low);
        let high = |a, b| product(a, b, End::High);
        Self {
            low: smaller(low(&self.low, &other.high), low(&self.high, &other.low)),
            high: larger(high(&self.low, &other.low), high(&self.high, &other.high)),
        }
    }
}

/// Half turns beyond which the parity of a multiple is not sure.
const LARGEST_TURNS: f64 = 1e12;
/// More than the error of a number of half turns below that, as a double.
const TURNS_ROUNDING: f64 = 1e-3;

fn larger(a: Precise, b: Precise) -> Precise {
    match a.compare(&b) {
        Some(std::cmp::Ordering::Less) => b,
        _ => a,
    }
}

fn smaller(a: Precise, b: Precise) -> Precise {
    match a.compare(&b) {
        Some(std::cmp::Ordering::Greater) => b,
        _ => a,
    }
}

/// A number above every number that rounds to this; unbounded for what is no number.
fn up(value: &Precise) -> Precise {
    let infinity = Precise::infinity(value.bits());
    if !value.is_finite() {
        // −∞ is what the largest numbers below 0 overflow to.
        return match value.is_negative() {
            true => -Precise::largest(value.bits()),
            false => infinity,
        };
    }
    match value.unit_in_last_place() {
        // What is exactly 0 is left: what only underflows does not come here.
        None => value.clone(),
        Some(unit) => value + &unit.halved(-OUTWARD_BITS),
    }
}

/// A number below every number that rounds to this.
fn down(value: &Precise) -> Precise {
    match value.is_nan() {
        true => -Precise::infinity(value.bits()),
        false => -&up(&-value),
    }
}

/// An end of the product of two ends.
fn product(a: &Precise, b: &Precise, end: End) -> Precise {
    match a.is_zero() || b.is_zero() {
        // Also beside an infinite end: 0 times every number is 0.
        true => a.same(0),
        false => a.product_toward(b, end),
    }
}

/// Numbers below and above the value of a function at x, which it rounds to nearest; what it gives as 0 may be a number that is too small
/// for it.
fn around(x: &Precise, function: impl Fn(&Precise) -> Precise) -> Interval {
    let value = function(x);
    match value.is_zero() && !x.is_zero() {
        true => {
            let smallest = Precise::above_underflow(value.bits());
            Interval::between(-&smallest, smallest)
        }
        false => Interval::outward(value.clone(), value),
    }
}

impl Number for Interval {
    fn rational(&self, value: &Rational) -> Self {
        let number = self.low.rational(value);
        // Short integers are exact.
        let exact = value.is_integer() && (value.bits() as usize) < self.bits();
        match exact {
            true => Self::point(number),
            false => Self::outward(number.clone(), number),
        }
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            low: self.low.sum_toward(&other.low, End::Low),
            high: self.high.sum_toward(&other.high, End::High),
        }
    }

    fn times(&self, other: &Self) -> Self {
        match (self.side(), other.side()) {
            (Side::Both, Side::Both) => self.mixed_product(other),
            (Side::Both, _) => other.sided_product(self),
            _ => self.sided_product(other),
        }
    }

    fn over(&self, other: &Self) -> Self {
        if !other.excludes_zero() || !self.is_bounded() || !other.is_bounded() {
            return Self::whole(self.bits());
        }
        let inverse = |x: &Precise, end| x.same(1).quotient_toward(x, end);
        self.times(&Self {
            low: inverse(&other.high, End::Low),
            high: inverse(&other.low, End::High),
        })
    }

    fn function(&self, function: Function, arguments: &[Self]) -> Self {
        match (function, arguments) {
            (Function::Pi, []) => Self::pi(self.bits()),
            (Function::Cos, [x]) => x.cos(),
            (Function::Sin, [x]) => x.sin(),
            (Function::Exp, [x]) => x.exp(),
            (Function::Ln, [x]) => x.ln(),
            (Function::Sqrt, [x]) => x.sqrt(),
            (Function::Recip, [x]) => Self::point(self.low.same(1)).over(x),
            (Function::Group, [x]) => x.clone(),
            (Function::Atan2, [y, x]) => y.atan2(x),
            (Function::Sinh, [x]) => x.growing(Precise::sinh),
            (Function::Cosh, [x]) => x.growing_with_size(Precise::cosh),
            (Function::Tanh, [x]) => x.growing(Precise::tanh).within(-1, 1),
            (Function::Sech, [x]) => x.sech(),
            (Function::LnCosh, [x]) => x.ln_cosh(),
            (Function::Stumpff(order), [s]) => s.stumpff(order.into()),
            (Function::Curve(curve, order), [x]) => curve::enclosed(curve, x, order),
            _ => Self::whole(self.bits()),
        }
    }

    fn power(&self, exponent: i32) -> Self {
        let size = exponent.unsigned_abs();
        let one = || Self::point(self.low.same(1));
        let squares =
            |square: Self| (1..size / 2).fold(square.clone(), |product, _| product.times(&square));
        let power = match size {
            0 => one(),
            1 => self.clone(),
            _ if size.is_multiple_of(2) => squares(self.square()),
            _ => squares(self.square()).times(self),
        };
        match exponent < 0 {
            true => one().over(&power),
            false => power,
        }
    }
}

#[cfg(test)]
mod tests;
