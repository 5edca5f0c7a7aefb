//! One double in code that the compiler turns into SIMD code across states.
//!
//! A loop over states whose body is straight-line code in this scalar has neither branches nor calls, so that the optimiser takes
//! several turns of it at once, in whatever registers the function may use. That holds for arithmetic, square roots, comparisons,
//! selection, sines and cosines; the other functions are those of `f64`, and a loop with them is not vectorised.

use super::{Scalar, batch, rotation};
use crate::curve::Curve;
use crate::unrolled;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use nalgebra::{Matrix3, Vector3};
use num_traits::{Float, One, Zero};

/// A double; with `FUSED`, multiply–adds are fused whatever the target: slow where it has no such instruction.
///
/// Sine and cosine are NaN beyond 8e5 rad, where they cannot be had without a branch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lane<const FUSED: bool>(
    /// The number.
    pub f64,
);

macro_rules! implement_operators {
    ($($trait:ident, $method:ident, $assign:ident, $assign_method:ident, $operator:tt;)*) => {$(
        impl<const FUSED: bool> $trait for Lane<FUSED> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0 $operator other.0)
            }
        }

        impl<const FUSED: bool> $assign for Lane<FUSED> {
            #[inline(always)]
            fn $assign_method(&mut self, other: Self) {
                *self = *self $operator other;
            }
        }
    )*};
}

implement_operators! {
    Add, add, AddAssign, add_assign, +;
    Sub, sub, SubAssign, sub_assign, -;
    Mul, mul, MulAssign, mul_assign, *;
    Div, div, DivAssign, div_assign, /;
}

impl<const FUSED: bool> Neg for Lane<FUSED> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<const FUSED: bool> Zero for Lane<FUSED> {
    #[inline(always)]
    fn zero() -> Self {
        Self(0.0)
    }

    #[inline(always)]
    fn is_zero(&self) -> bool {
        self.0 == 0.0
    }
}

impl<const FUSED: bool> One for Lane<FUSED> {
    #[inline(always)]
    fn one() -> Self {
        Self(1.0)
    }
}

impl<const FUSED: bool> Scalar for Lane<FUSED> {
    type Mask = bool;
    type Four = super::Each<Self>;

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self(value)
    }

    fn epsilon() -> Self {
        Self(f64::EPSILON)
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self(batch::multiply_add::<FUSED>(self.0, factor.0, addend.0))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(Float::sqrt(self.0))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = batch::sin_cos::<FUSED>(self.0);
        (Self(sine), Self(cosine))
    }

    #[inline(always)]
    fn sin_cos_all<const N: usize>(angles: &[Self; N]) -> ([Self; N], [Self; N]) {
        let (mut sines, mut cosines) = ([Self(0.0); N], [Self(0.0); N]);
        unrolled!(i in N {
            (sines[i], cosines[i]) = angles[i].sin_cos();
        });
        (sines, cosines)
    }

    #[inline]
    fn atan2(self, x: Self) -> Self {
        Self(Float::atan2(self.0, x.0))
    }

    #[inline]
    fn exp(self) -> Self {
        Self(Float::exp(self.0))
    }

    #[inline]
    fn ln(self) -> Self {
        Self(Float::ln(self.0))
    }

    #[inline]
    fn ln_1p(self) -> Self {
        Self(Scalar::ln_1p(self.0))
    }

    #[inline]
    fn sinh(self) -> Self {
        Self(Scalar::sinh(self.0))
    }

    #[inline]
    fn cosh(self) -> Self {
        Self(Scalar::cosh(self.0))
    }

    #[inline]
    fn sech(self) -> Self {
        Self(Scalar::sech(self.0))
    }

    #[inline]
    fn tanh(self) -> Self {
        Self(Scalar::tanh(self.0))
    }

    #[inline]
    fn ln_cosh(self) -> Self {
        Self(Scalar::ln_cosh(self.0))
    }

    #[inline]
    fn stumpff(self, order: usize) -> Self {
        Self(self.0.stumpff(order))
    }

    #[inline]
    fn dexp_inverse(self, derivative: usize) -> Self {
        Self(self.0.dexp_inverse(derivative))
    }

    #[inline]
    fn curve(self, curve: &Curve, order: usize) -> Self {
        Self(self.0.curve(curve, order))
    }

    fn rotation_vector(rotation: &Matrix3<Self>) -> Vector3<Self> {
        rotation::rotation_vector(rotation)
    }

    fn quaternion_vector(quaternion: [Self; 4]) -> Vector3<Self> {
        rotation::quaternion_vector(quaternion)
    }

    #[inline(always)]
    fn less(self, other: Self) -> bool {
        self.0 < other.0
    }

    #[inline(always)]
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        if mask { if_true } else { if_false }
    }
}
