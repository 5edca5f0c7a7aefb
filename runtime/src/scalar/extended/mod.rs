//! Numbers of 106 bits: the unevaluated sum of two doubles.
//!
//! Algorithms as numbered by M. Joldes, J.-M. Muller and V. Popescu, *Tight and rigorous error bounds for basic building blocks of double-word
//! arithmetic*, ACM TOMS 44 (2017). They are for residuals of equations whose terms cancel, and take some ten times as long as doubles.

mod functions;
#[cfg(test)]
mod tests;

use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use num_traits::{Float, One, Zero};

/// The sum of two doubles, of which the second is at most half an ulp of the first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extended {
    high: f64,
    low: f64,
}

/// 2²⁷ + 1: what cuts a double into two halves whose products are exact (T. J. Dekker).
const CUT: f64 = 134_217_729.0;

impl Extended {
    /// The sum of two doubles, exactly (algorithm 2).
    pub const fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let of_a = high - b;
        let of_b = high - of_a;
        Self {
            high,
            low: (a - of_a) + (b - of_b),
        }
    }

    /// The same where `a` is the larger (algorithm 1).
    const fn ordered_sum(a: f64, b: f64) -> Self {
        let high = a + b;
        Self {
            high,
            low: b - (high - a),
        }
    }

    /// The product of two doubles, exactly (algorithm 3, or Dekker's where the target has no fused instruction).
    #[inline]
    fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        if cfg!(target_feature = "fma") {
            let low = Float::mul_add(a, b, -high);
            return Self { high, low };
        }
        let ((a, a_rest), (b, b_rest)) = (halves(a), halves(b));
        let low = ((a * b - high) + a * b_rest + a_rest * b) + a_rest * b_rest;
        Self { high, low }
    }

    /// The double nearest to it.
    pub const fn high(self) -> f64 {
        self.high
    }

    /// What the nearest double leaves.
    pub const fn low(self) -> f64 {
        self.low
    }

    /// Times a power of two, exactly.
    fn scaled(self, power: f64) -> Self {
        Self {
            high: self.high * power,
            low: self.low * power,
        }
    }
}

/// A double as a sum of two with half the digits.
#[inline]
fn halves(a: f64) -> (f64, f64) {
    let scaled = CUT * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

impl From<f64> for Extended {
    #[inline]
    fn from(value: f64) -> Self {
        Self {
            high: value,
            low: 0.0,
        }
    }
}

impl Neg for Extended {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Add for Extended {
    type Output = Self;
    /// Algorithm 6.
    #[inline]
    fn add(self, other: Self) -> Self {
        let head = Self::sum(self.high, other.high);
        let tail = Self::sum(self.low, other.low);
        let sum = Self::ordered_sum(head.high, head.low + tail.high);
        Self::ordered_sum(sum.high, tail.low + sum.low)
    }
}

impl Sub for Extended {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Extended {
    type Output = Self;
    /// Algorithm 10.
    #[inline]
    fn mul(self, other: Self) -> Self {
        let head = Self::product(self.high, other.high);
        let cross = self.high * other.low + self.low * other.high;
        Self::ordered_sum(head.high, head.low + cross)
    }
}

impl Div for Extended {
    type Output = Self;
    /// Algorithm 17: a quotient of doubles, and one of what it leaves.
    #[inline]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        Self::ordered_sum(first, rest.high / other.high)
    }
}

macro_rules! assigning {
    ($($operator:ident $method:ident $plain:ident),*) => {$(
        impl $operator for Extended {
            #[inline]
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

impl Zero for Extended {
    fn zero() -> Self {
        Self::from(0.0)
    }
    fn is_zero(&self) -> bool {
        self.high == 0.0
    }
}

impl One for Extended {
    fn one() -> Self {
        Self::from(1.0)
    }
}
