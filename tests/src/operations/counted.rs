//! Doubles that count the operations on them.

use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use hamel::curve::Curve;
use hamel::nalgebra::{Matrix3, Vector3};
use hamel::scalar::Scalar;
use num_traits::{One, Zero};
use std::cell::Cell;

thread_local! {
    static COUNTS: Cell<[usize; 5]> = const { Cell::new([0; 5]) };
}

/// Places of the counts: additions and multiplications with those that are fused.
const ADDED: usize = 0;
const MULTIPLIED: usize = 1;
const FUSED: usize = 2;
const DIVIDED: usize = 3;
const CALLED: usize = 4;

/// A double whose operations are counted; changes of sign and comparisons are not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Counted(pub f64);

fn count(place: usize) {
    let mut counts = COUNTS.get();
    counts[place] += 1;
    COUNTS.set(counts);
}

fn called(value: f64) -> Counted {
    count(CALLED);
    Counted(value)
}

/// Additions, multiplications, fused ones, divisions and function calls of `work`.
pub(super) fn operations_of<T>(work: impl FnOnce() -> T) -> [usize; 5] {
    COUNTS.set([0; 5]);
    work();
    COUNTS.get()
}

macro_rules! implement_operators {
    ($($trait:ident, $method:ident, $assign:ident, $assigned:ident, $operator:tt, $place:ident;)*) => {$(
        impl $trait for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                count($place);
                Self(self.0 $operator other.0)
            }
        }
        impl $assign for Counted {
            fn $assigned(&mut self, other: Self) {
                *self = *self $operator other;
            }
        }
    )*};
}

implement_operators! {
    Add, add, AddAssign, add_assign, +, ADDED;
    Sub, sub, SubAssign, sub_assign, -, ADDED;
    Mul, mul, MulAssign, mul_assign, *, MULTIPLIED;
    Div, div, DivAssign, div_assign, /, DIVIDED;
}

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Zero for Counted {
    fn zero() -> Self {
        Self(0.0)
    }
    fn is_zero(&self) -> bool {
        self.0 == 0.0
    }
}

impl One for Counted {
    fn one() -> Self {
        Self(1.0)
    }
}

macro_rules! count_calls {
    ($($function:ident),*) => {$(
        fn $function(self) -> Self {
            called(Scalar::$function(self.0))
        }
    )*};
}

impl Scalar for Counted {
    type Mask = bool;
    type Four = hamel::scalar::Each<Self>;

    count_calls! { sqrt, exp, ln, ln_1p, sinh, cosh, sech, tanh, ln_cosh }

    fn from_f64(value: f64) -> Self {
        Self(value)
    }

    fn epsilon() -> Self {
        Self(f64::EPSILON)
    }

    fn mul_add(self, factor: Self, addend: Self) -> Self {
        for place in [ADDED, MULTIPLIED, FUSED] {
            count(place);
        }
        Self(Scalar::mul_add(self.0, factor.0, addend.0))
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0.sin_cos();
        (called(sin), Self(cos))
    }

    fn atan2(self, x: Self) -> Self {
        called(self.0.atan2(x.0))
    }

    fn stumpff(self, order: usize) -> Self {
        called(self.0.stumpff(order))
    }

    fn dexp_inverse(self, derivative: usize) -> Self {
        called(self.0.dexp_inverse(derivative))
    }

    fn curve(self, curve: &Curve, order: usize) -> Self {
        called(self.0.curve(curve, order))
    }

    fn rotation_vector(rotation: &Matrix3<Self>) -> Vector3<Self> {
        count(CALLED);
        f64::rotation_vector(&rotation.map(|entry| entry.0)).map(Self)
    }

    fn quaternion_vector(quaternion: [Self; 4]) -> Vector3<Self> {
        count(CALLED);
        f64::quaternion_vector(quaternion.map(|entry| entry.0)).map(Self)
    }

    fn less(self, other: Self) -> bool {
        self.0 < other.0
    }

    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        if mask { if_true } else { if_false }
    }
}
