//! Quotients and square roots, by Newton's method from doubles.

use super::Wide;
use std::ops::Div;

/// Steps from 2⁻⁵² to 2⁻²⁵⁶: each doubles the digits.
const STEPS: usize = 3;

impl Wide {
    /// The mantissa alone, with the sign.
    fn unscaled(self) -> Self {
        Self {
            exponent: 0,
            ..self
        }
    }

    /// 1 / self; NaN for 0.
    pub fn recip(self) -> Self {
        if self.nan || self.is_zero() {
            return Self::NAN;
        }
        let one = Self::from_integer(1);
        let mantissa = self.unscaled();
        let mut x = Self::from_f64(mantissa.to_f64().recip());
        for _ in 0..STEPS {
            x = x + x * (one - mantissa * x);
        }
        x.halved(self.exponent)
    }

    /// Square root; NaN below 0.
    pub fn sqrt(self) -> Self {
        if self.is_zero() {
            return self;
        }
        if self.nan || self.negative {
            return Self::NAN;
        }
        // An even power of two is taken out.
        let half = self.exponent.div_euclid(2);
        let m = self.halved(2 * half);
        let one = Self::from_integer(1);
        let mut x = Self::from_f64(m.to_f64().sqrt().recip());
        for _ in 0..STEPS {
            x = x + x * (one - m * x * x).halved(1);
        }
        let root = m * x;
        // Squares have their root to the last bit: what is left is divided once more.
        (root + (m - root * root) * x.halved(1)).halved(-half)
    }
}

impl Div for Wide {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let inverse = other.recip();
        let quotient = self * inverse;
        quotient + (self - quotient * other) * inverse
    }
}
