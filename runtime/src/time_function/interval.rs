//! Intervals that hold all values of an expression over a span of time: they tell where its switches cannot change.

use core::ops::{Add, Div, Mul, Neg, Sub};
use num_traits::Float;

/// All numbers from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    pub(super) low: f64,
    pub(super) high: f64,
}

/// What functions of the library may be off by, relative to the largest of their values.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Interval {
    const ALL: Self = Self {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
    };

    /// One that is not known where its ends are not.
    pub(super) fn new(low: f64, high: f64) -> Self {
        match low.is_nan() || high.is_nan() {
            true => Self::ALL,
            false => Self { low, high },
        }
    }

    pub(super) const fn number(number: f64) -> Self {
        Self {
            low: number,
            high: number,
        }
    }

    pub(super) const fn everything() -> Self {
        Self::ALL
    }

    /// Both.
    pub(super) const fn hull(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    fn widened(self) -> Self {
        let by = ROUNDING * self.low.abs().max(self.high.abs());
        Self::new(self.low - by, self.high + by)
    }

    /// The image under a function that never falls.
    fn rising(self, function: impl Fn(f64) -> f64) -> Self {
        Self::new(function(self.low), function(self.high)).widened()
    }

    pub(super) fn exp(self) -> Self {
        self.rising(Float::exp)
    }

    pub(super) fn ln(self) -> Self {
        Self::new(self.low.max(0.0), self.high).rising(Float::ln)
    }

    pub(super) fn sqrt(self) -> Self {
        Self::new(self.low.max(0.0), self.high).rising(Float::sqrt)
    }

    /// The sine, by its values at the ends and the quarter turns between them.
    pub(super) fn sin(self) -> Self {
        let quarter = core::f64::consts::FRAC_PI_2;
        let (first, last) = (
            Float::ceil(self.low / quarter),
            Float::floor(self.high / quarter),
        );
        if !(last - first).is_finite() || last - first >= 4.0 {
            return Self::new(-1.0, 1.0);
        }
        let ends = Self::number(Float::sin(self.low)).hull(Self::number(Float::sin(self.high)));
        let turn = |quarters: f64| match quarters - 4.0 * Float::floor(quarters / 4.0) {
            1.0 => ends.hull(Self::number(1.0)),
            3.0 => ends.hull(Self::number(-1.0)),
            _ => ends,
        };
        let mut all = ends;
        let mut quarters = first;
        while quarters <= last {
            all = all.hull(turn(quarters));
            quarters += 1.0;
        }
        // Large angles lose digits before their sine is taken.
        let angle = self.low.abs().max(self.high.abs()) * f64::EPSILON;
        let by = ROUNDING + angle;
        Self::new(all.low - by, all.high + by)
    }

    pub(super) fn powi(self, exponent: i32) -> Self {
        if exponent < 0 {
            return Self::number(1.0) / self.powi(-exponent);
        }
        let ends = [
            Float::powi(self.low, exponent),
            Float::powi(self.high, exponent),
        ];
        let mut all = Self::number(ends[0]).hull(Self::number(ends[1]));
        if exponent % 2 == 0 && self.low < 0.0 && self.high > 0.0 {
            all = all.hull(Self::number(0.0));
        }
        Self::new(all.low, all.high).widened()
    }

    pub(super) fn powf(self, exponent: f64) -> Self {
        let base = Self::new(self.low.max(0.0), self.high);
        match exponent >= 0.0 {
            true => base.rising(|x| Float::powf(x, exponent)),
            false => Self::number(1.0) / base.rising(|x| Float::powf(x, -exponent)),
        }
    }

    /// Whether all of it is negative, or none; `None` where it has both.
    pub(super) fn is_negative(self) -> Option<bool> {
        match (self.low >= 0.0, self.high < 0.0) {
            (true, _) => Some(false),
            (_, true) => Some(true),
            _ => None,
        }
    }

    /// Whether 0 is among its numbers.
    pub(super) fn has_zero(self) -> bool {
        self.low <= 0.0 && self.high >= 0.0
    }
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.low + other.low, self.high + other.high)
    }
}

impl Sub for Interval {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            low: -self.high,
            high: -self.low,
        }
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        // 0 times what has no bound is 0 here: the unbounded end is never reached.
        let product = |a: f64, b: f64| match a == 0.0 || b == 0.0 {
            true => 0.0,
            false => a * b,
        };
        let [a, b] = [product(self.low, other.low), product(self.low, other.high)];
        let [c, d] = [
            product(self.high, other.low),
            product(self.high, other.high),
        ];
        Self::new(a.min(b).min(c).min(d), a.max(b).max(c).max(d))
    }
}

impl Div for Interval {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        if other.has_zero() {
            return Self::ALL;
        }
        self * Self::new(1.0 / other.high, 1.0 / other.low)
    }
}
