//! Upper bounds of sizes: doubles with an exponent of their own, rounded up.

/// Relative amount by which every result is raised: four times what its roundings can take away.
const UP: f64 = 1.0 + 4.0 * f64::EPSILON;

/// A number that is not negative, `mantissa · 2^exponent` with the mantissa in [½, 1], 0 or infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Magnitude {
    mantissa: f64,
    exponent: i64,
}

impl Magnitude {
    pub const ZERO: Self = Self {
        mantissa: 0.0,
        exponent: 0,
    };
    pub const INFINITE: Self = Self {
        mantissa: f64::INFINITY,
        exponent: 0,
    };

    /// `mantissa · 2^exponent`, or more.
    pub fn new(mantissa: f64, exponent: i64) -> Self {
        if mantissa == 0.0 || !mantissa.is_finite() {
            let mantissa = if mantissa == 0.0 { 0.0 } else { f64::INFINITY };
            return Self {
                mantissa,
                exponent: 0,
            };
        }
        let shift = (mantissa.to_bits() >> 52 & 0x7ff) as i64 - 1022;
        // Arguments are products and sums of two mantissas: never subnormal.
        let mantissa = f64::from_bits(mantissa.to_bits() & !(0x7ff << 52) | 1022 << 52);
        Self {
            mantissa: mantissa * UP,
            exponent: exponent + shift,
        }
    }

    pub fn is_zero(self) -> bool {
        self.mantissa == 0.0
    }

    pub fn is_finite(self) -> bool {
        self.mantissa.is_finite()
    }

    pub fn times(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self::ZERO;
        }
        Self::new(
            self.mantissa * other.mantissa,
            self.exponent + other.exponent,
        )
    }

    pub fn plus(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() || !self.is_finite() || !other.is_finite() {
            return if self.is_zero() || !other.is_finite() {
                other
            } else {
                self
            };
        }
        let (large, small) = if self.exponent >= other.exponent {
            (self, other)
        } else {
            (other, self)
        };
        let shift = (small.exponent - large.exponent).max(-60);
        Self::new(
            large.mantissa + small.mantissa * f64::powi(2.0, shift as i32),
            large.exponent,
        )
    }

    /// `self · 2^n`.
    pub fn scaled(self, n: i64) -> Self {
        match self.is_zero() || !self.is_finite() {
            true => self,
            false => Self {
                exponent: self.exponent + n,
                ..self
            },
        }
    }

    /// `self / lower`, where `lower` is a lower bound of the divisor.
    pub fn over(self, lower: Self) -> Self {
        if self.is_zero() || lower.is_zero() {
            return if lower.is_zero() {
                Self::INFINITE
            } else {
                self
            };
        }
        Self::new(
            self.mantissa / lower.mantissa * UP,
            self.exponent - lower.exponent,
        )
    }

    /// Whether this is less than the other for certain, both being exact.
    pub fn less(self, other: Self) -> bool {
        if self.is_zero() || other.is_zero() || !self.is_finite() || !other.is_finite() {
            return self.mantissa < other.mantissa && (self.is_zero() || !other.is_finite());
        }
        // Mantissas may be 1, which the next exponent calls ½.
        let size = |x: Self| {
            if x.mantissa >= 1.0 {
                (x.exponent + 1, 0.5 * x.mantissa)
            } else {
                (x.exponent, x.mantissa)
            }
        };
        size(self) < size(other)
    }

    /// Binary exponent; nothing for 0 and for infinity.
    pub fn exponent(self) -> Option<i64> {
        (!self.is_zero() && self.is_finite()).then_some(self.exponent)
    }
}
