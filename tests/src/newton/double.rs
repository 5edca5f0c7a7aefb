//! Double-double arithmetic: M. Joldes, J.-M. Muller, V. Popescu, *Tight and rigorous error bounds for basic building blocks of double-word
//! arithmetic*, ACM TOMS 44 (2017); the algorithms are numbered as there.
//!
//! Of our own, since the crate at hand (`twofloat` 0.8.4) divides without a fused product, and so to single doubles only.

use num_traits::{One, Zero};
use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// The sum of two doubles, of which the second is at most half an ulp of the first: 106 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Real {
    high: f64,
    low: f64,
}

impl Real {
    /// The sum of two doubles, exactly (algorithm 2).
    pub const fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let part = high - b;
        let rest = high - part;
        Self {
            high,
            low: (a - part) + (b - rest),
        }
    }

    /// The same where `a` is the larger (algorithm 1).
    const fn quick(a: f64, b: f64) -> Self {
        let high = a + b;
        Self {
            high,
            low: b - (high - a),
        }
    }

    /// The product of two doubles, exactly (algorithm 3).
    fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        Self {
            high,
            low: a.mul_add(b, -high),
        }
    }

    /// The double nearest to it.
    pub const fn high(self) -> f64 {
        self.high
    }

    /// What that leaves.
    pub const fn low(self) -> f64 {
        self.low
    }

    /// The square root; NaN of what is negative.
    #[must_use]
    pub fn sqrt(self) -> Self {
        if self.is_zero() {
            return self;
        }
        let root = self.high.sqrt();
        // One step of Newton's method doubles the digits.
        let rest = self - Self::product(root, root);
        Self::quick(root, rest.high / (2.0 * root))
    }
}

impl From<f64> for Real {
    fn from(value: f64) -> Self {
        Self {
            high: value,
            low: 0.0,
        }
    }
}

impl From<Real> for f64 {
    fn from(value: Real) -> Self {
        value.high
    }
}

impl PartialOrd for Real {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let high = self.high.partial_cmp(&other.high)?;
        Some(high.then(self.low.partial_cmp(&other.low)?))
    }
}

impl Neg for Real {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Add for Real {
    type Output = Self;
    /// Algorithm 6.
    fn add(self, other: Self) -> Self {
        let head = Self::sum(self.high, other.high);
        let tail = Self::sum(self.low, other.low);
        let sum = Self::quick(head.high, head.low + tail.high);
        Self::quick(sum.high, tail.low + sum.low)
    }
}

impl Sub for Real {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Real {
    type Output = Self;
    /// Algorithm 12.
    fn mul(self, other: Self) -> Self {
        let head = Self::product(self.high, other.high);
        let cross = self.high.mul_add(other.low, self.low * other.low);
        let cross = self.low.mul_add(other.high, cross);
        Self::quick(head.high, head.low + cross)
    }
}

impl Div for Real {
    type Output = Self;
    /// Algorithm 17: a quotient of doubles, and one of what it leaves.
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        Self::quick(first, rest.high / other.high)
    }
}

macro_rules! assigning {
    ($($operator:ident $method:ident $plain:ident),*) => {$(
        impl $operator for Real {
            fn $method(&mut self, other: Self) {
                *self = self.$plain(other);
            }
        }
    )*};
}

assigning!(
    AddAssign add_assign add,
    SubAssign sub_assign sub,
    MulAssign mul_assign mul,
    DivAssign div_assign div
);

impl Zero for Real {
    fn zero() -> Self {
        Self::from(0.0)
    }
    fn is_zero(&self) -> bool {
        self.high == 0.0
    }
}

impl One for Real {
    fn one() -> Self {
        Self::from(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::Real;
    use hamel_codegen::precise::Precise;

    fn exact(value: Real) -> Precise {
        let part = |part: f64| Precise::from_f64(part, 512);
        &part(value.high()) + &part(value.low())
    }

    #[test]
    fn every_operation_is_within_a_few_units_of_the_106th_bit() {
        let part = |i: f64| Real::sum((0.37 * i).sin(), 3e-17 * (1.1 * i).cos());
        for i in 1..1000 {
            let (a, b) = (part(f64::from(i)), part(f64::from(i) + 0.5));
            let (x, y) = (exact(a), exact(b));
            let root = (a * a).sqrt();
            let pairs = [
                (a + b, &x + &y),
                (a - b, &x - &y),
                (a * b, &x * &y),
                (a / b, &x / &y),
                (root, (&x * &x).sqrt()),
            ];
            for (found, expected) in pairs {
                let error = (&(&exact(found) - &expected) / &expected).to_f64().abs();
                // The bounds of the paper are 3 (sum), 4 (product) and 15 (quotient) units of 2^-106.
                assert!(error < 16.0 * 2.0_f64.powi(-106), "{a:?}, {b:?}: {error:e}");
            }
        }
    }
}
