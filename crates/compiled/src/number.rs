//! What loops over pairs of joints compute with: a scalar, or one number each of eight states.

use super::{LANES, Lanes};
use hamel_runtime::scalar::{Lane, Scalar};

/// Numbers with the arithmetic of loops over pairs of joints ([`Pairs`](super::Pairs)).
///
/// Lanes round, number by number, as one state does at their level: with `FUSED`, products are added by fused instructions. A scalar has its own.
pub trait Number: Copy {
    /// The most columns that are solved for at once.
    const COLUMNS: usize;

    /// A number, in all states.
    fn from_f64(value: f64) -> Self;

    /// The opposite.
    fn negative(self) -> Self;

    /// A sum.
    fn plus(self, other: Self) -> Self;

    /// A product.
    fn times(self, factor: Self) -> Self;

    /// A quotient.
    fn over(self, divisor: Self) -> Self;

    /// `self · factor + addend`.
    fn times_plus<const FUSED: bool>(self, factor: Self, addend: Self) -> Self;
}

impl<T: Scalar> Number for T {
    const COLUMNS: usize = 32;

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        <T as Scalar>::from_f64(value)
    }

    #[inline(always)]
    fn negative(self) -> Self {
        -self
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self + other
    }

    #[inline(always)]
    fn times(self, factor: Self) -> Self {
        self * factor
    }

    #[inline(always)]
    fn over(self, divisor: Self) -> Self {
        self / divisor
    }

    #[inline(always)]
    fn times_plus<const FUSED: bool>(self, factor: Self, addend: Self) -> Self {
        self.mul_add(factor, addend)
    }
}

impl Number for Lanes {
    // As many registers.
    const COLUMNS: usize = 8;

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    fn negative(self) -> Self {
        self.each(self, |a, _| -a)
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.each(other, |a, b| a + b)
    }

    #[inline(always)]
    fn times(self, factor: Self) -> Self {
        self.each(factor, |a, b| a * b)
    }

    #[inline(always)]
    fn over(self, divisor: Self) -> Self {
        self.each(divisor, |a, b| a / b)
    }

    #[inline(always)]
    fn times_plus<const FUSED: bool>(self, factor: Self, addend: Self) -> Self {
        let mut sum = addend;
        for ((sum, a), b) in sum.0.iter_mut().zip(self.0).zip(factor.0) {
            *sum = Lane::<FUSED>(a).mul_add(Lane(b), Lane(*sum)).0;
        }
        sum
    }
}

impl Lanes {
    #[inline(always)]
    fn each(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        let mut results = self;
        for (a, b) in results.0.iter_mut().zip(other.0) {
            *a = of(*a, b);
        }
        results
    }
}
