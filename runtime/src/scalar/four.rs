//! Four numbers side by side within one state: what emitted functions compute the like limbs of a mechanism with.

use super::Scalar;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// Four numbers of type `T` side by side; arithmetic is number by number.
pub trait Four<T>:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The four numbers beside each other.
    fn from_array(numbers: [T; 4]) -> Self;

    /// The numbers, each for itself.
    fn to_array(self) -> [T; 4];

    /// `self * factor + addend`, as [`Scalar::mul_add`].
    #[must_use]
    fn mul_add(self, factor: Self, addend: Self) -> Self;

    /// Square roots.
    #[must_use]
    fn sqrt(self) -> Self;
}

/// [`Four`] for every scalar: an array.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Each<T>([T; 4]);

impl<T: Scalar> Each<T> {
    #[inline(always)]
    fn with(self, other: Self, operation: impl Fn(T, T) -> T) -> Self {
        // Written out: closures over indices are most of what a compiler would have to work through.
        let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
        Self([
            operation(a, e),
            operation(b, f),
            operation(c, g),
            operation(d, h),
        ])
    }
}

macro_rules! implement_operator {
    ($trait:ident, $method:ident, $operator:tt) => {
        impl<T: Scalar> $trait for Each<T> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(other, |a, b| a $operator b)
            }
        }
    };
}

implement_operator!(Add, add, +);
implement_operator!(Sub, sub, -);
implement_operator!(Mul, mul, *);
implement_operator!(Div, div, /);

impl<T: Scalar> Neg for Each<T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        let [a, b, c, d] = self.0;
        Self([-a, -b, -c, -d])
    }
}

impl<T: Scalar> Four<T> for Each<T> {
    #[inline(always)]
    fn from_array(numbers: [T; 4]) -> Self {
        Self(numbers)
    }

    #[inline(always)]
    fn to_array(self) -> [T; 4] {
        self.0
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let ([a, b, c, d], [e, f, g, h], [i, j, k, l]) = (self.0, factor.0, addend.0);
        Self([
            a.mul_add(e, i),
            b.mul_add(f, j),
            c.mul_add(g, k),
            d.mul_add(h, l),
        ])
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let [a, b, c, d] = self.0;
        Self([a.sqrt(), b.sqrt(), c.sqrt(), d.sqrt()])
    }
}

#[cfg(feature = "wide")]
impl Four<f64> for super::F64x4 {
    #[inline(always)]
    fn from_array(numbers: [f64; 4]) -> Self {
        Self::new(numbers)
    }

    #[inline(always)]
    fn to_array(self) -> [f64; 4] {
        self.to_array()
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Scalar::mul_add(self, factor, addend)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Scalar::sqrt(self)
    }
}
