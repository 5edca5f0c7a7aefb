//! Doubles that note the arguments of functions, divisors and comparisons on the way.
//!
//! A kernel is narrow only where a function makes it so: at the top of an exponential's argument, where a divisor or a radicand is
//! least, where a comparison changes. The function's value is flat everywhere else, but its argument is not: from afar it leads there.

use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use hamel::curve::Curve;
use hamel::nalgebra::{Matrix3, Vector3};
use hamel::scalar::Scalar;
use num_traits::{One, Zero};
use std::cell::RefCell;

thread_local! {
    /// The notes, and how many are taken.
    static NOTES: RefCell<(Vec<f64>, usize)> = const { RefCell::new((Vec::new(), 0)) };
}

/// A double whose operations are noted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Traced(pub f64);

fn note(value: f64) {
    NOTES.with_borrow_mut(|(notes, most)| {
        if notes.len() < *most {
            notes.push(value);
        }
    });
}

/// The first `most` notes of `work`, in order: kernels do not branch, so that the same place means the same thing at every configuration.
pub(super) fn notes_of<T>(most: usize, work: impl FnOnce() -> T) -> Vec<f64> {
    NOTES.set((vec![], most));
    work();
    NOTES.take().0
}

macro_rules! implement_operators {
    ($($trait:ident, $method:ident, $assign:ident, $assigned:ident, $operator:tt;)*) => {$(
        impl $trait for Traced {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self(self.0 $operator other.0)
            }
        }
        impl $assign for Traced {
            fn $assigned(&mut self, other: Self) {
                *self = *self $operator other;
            }
        }
    )*};
}

implement_operators! {
    Add, add, AddAssign, add_assign, +;
    Sub, sub, SubAssign, sub_assign, -;
    Mul, mul, MulAssign, mul_assign, *;
}

impl Div for Traced {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        note(other.0);
        Self(self.0 / other.0)
    }
}

impl DivAssign for Traced {
    fn div_assign(&mut self, other: Self) {
        *self = *self / other;
    }
}

impl Neg for Traced {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Zero for Traced {
    fn zero() -> Self {
        Self(0.0)
    }
    fn is_zero(&self) -> bool {
        self.0 == 0.0
    }
}

impl One for Traced {
    fn one() -> Self {
        Self(1.0)
    }
}

impl Scalar for Traced {
    type Mask = bool;
    type Four = hamel::scalar::Each<Self>;

    fn from_f64(value: f64) -> Self {
        Self(value)
    }

    fn epsilon() -> Self {
        Self(f64::EPSILON)
    }

    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self(Scalar::mul_add(self.0, factor.0, addend.0))
    }

    fn sqrt(self) -> Self {
        note(self.0);
        Self(self.0.sqrt())
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0.sin_cos();
        (Self(sin), Self(cos))
    }

    fn atan2(self, x: Self) -> Self {
        note(self.0);
        note(x.0);
        Self(self.0.atan2(x.0))
    }

    fn exp(self) -> Self {
        note(self.0);
        Self(self.0.exp())
    }

    fn ln(self) -> Self {
        note(self.0);
        Self(self.0.ln())
    }

    fn ln_1p(self) -> Self {
        note(self.0);
        Self(Scalar::ln_1p(self.0))
    }

    fn sinh(self) -> Self {
        note(self.0);
        Self(Scalar::sinh(self.0))
    }

    fn cosh(self) -> Self {
        note(self.0);
        Self(Scalar::cosh(self.0))
    }

    fn sech(self) -> Self {
        note(self.0);
        Self(self.0.sech())
    }

    fn tanh(self) -> Self {
        note(self.0);
        Self(Scalar::tanh(self.0))
    }

    fn ln_cosh(self) -> Self {
        note(self.0);
        Self(self.0.ln_cosh())
    }

    fn stumpff(self, order: usize) -> Self {
        Self(self.0.stumpff(order))
    }

    fn dexp_inverse(self, derivative: usize) -> Self {
        Self(self.0.dexp_inverse(derivative))
    }

    fn curve(self, curve: &Curve, order: usize) -> Self {
        Self(self.0.curve(curve, order))
    }

    fn rotation_vector(rotation: &Matrix3<Self>) -> Vector3<Self> {
        f64::rotation_vector(&rotation.map(|entry| entry.0)).map(Self)
    }

    fn quaternion_vector(quaternion: [Self; 4]) -> Vector3<Self> {
        f64::quaternion_vector(quaternion.map(|entry| entry.0)).map(Self)
    }

    fn less(self, other: Self) -> bool {
        note(other.0 - self.0);
        self.0 < other.0
    }

    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        if mask { if_true } else { if_false }
    }
}
