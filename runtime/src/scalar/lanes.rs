//! Four or eight doubles side by side in SIMD registers of the level that the program is built for, with the feature `wide`.
//!
//! Every lane is, to the last bit, what `f64` gives: arithmetic, square root, comparison and selection are those of the
//! crate `wide`, which round correctly; sine, logarithm and the like are `f64`'s own, lane by lane, because the vector forms
//! there are not within 2 ulp at every argument. So are the functions that choose a formula by their argument.

use super::{Scalar, rotation};
use crate::curve::Curve;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use nalgebra::{Matrix3, Vector3};
use num_traits::{One, Zero};
use wide::{f64x4, f64x8};

macro_rules! implement_operator {
    ($name:ident, $trait:ident, $method:ident, $assign:ident, $assign_method:ident, $operator:tt) => {
        impl $trait for $name {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                Self(self.0 $operator other.0)
            }
        }

        impl $assign for $name {
            #[inline]
            fn $assign_method(&mut self, other: Self) {
                *self = *self $operator other;
            }
        }
    };
}

macro_rules! implement_lanes {
    ($name:ident, $mask:ident, $register:ident, $lanes:literal, $docs:literal) => {
        #[doc = $docs]
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct $name($register);

        impl $name {
            /// The number of lanes.
            pub const LANES: usize = $lanes;

            /// One number a lane.
            pub const fn new(lanes: [f64; Self::LANES]) -> Self {
                Self($register::new(lanes))
            }

            /// The number of each lane.
            pub fn to_array(self) -> [f64; Self::LANES] {
                self.0.to_array()
            }

            /// `function` of each lane.
            fn each(self, function: impl Fn(f64) -> f64) -> Self {
                Self::new(self.to_array().map(function))
            }
        }

        implement_operator!($name, Add, add, AddAssign, add_assign, +);
        implement_operator!($name, Sub, sub, SubAssign, sub_assign, -);
        implement_operator!($name, Mul, mul, MulAssign, mul_assign, *);
        implement_operator!($name, Div, div, DivAssign, div_assign, /);

        impl Neg for $name {
            type Output = Self;
            #[inline]
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }

        impl Zero for $name {
            fn zero() -> Self {
                Self($register::splat(0.0))
            }

            fn is_zero(&self) -> bool {
                *self == Self::zero()
            }
        }

        impl One for $name {
            fn one() -> Self {
                Self($register::splat(1.0))
            }
        }

        /// One truth value a lane: all bits of the lane set, or none.
        #[derive(Clone, Copy, Debug)]
        pub struct $mask($register);

        impl Scalar for $name {
            type Mask = $mask;
            type Four = super::Each<Self>;

            #[inline]
            fn from_f64(value: f64) -> Self {
                Self($register::splat(value))
            }

            fn epsilon() -> Self {
                Self::from_f64(f64::EPSILON)
            }

            #[inline]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                Self(self.0.mul_add(factor.0, addend.0))
            }

            #[inline]
            fn sqrt(self) -> Self {
                Self(self.0.sqrt())
            }

            fn sin_cos(self) -> (Self, Self) {
                let pairs = self.to_array().map(Scalar::sin_cos);
                (
                    Self::new(pairs.map(|(sin, _)| sin)),
                    Self::new(pairs.map(|(_, cos)| cos)),
                )
            }

            #[inline]
            fn sin_cos_all<const N: usize>(angles: &[Self; N]) -> ([Self; N], [Self; N]) {
                let (mut sines, mut cosines) = ([Self::zero(); N], [Self::zero(); N]);
                for i in 0..N {
                    let (sine, cosine) = f64::sin_cos_all(&angles[i].to_array());
                    (sines[i], cosines[i]) = (Self::new(sine), Self::new(cosine));
                }
                (sines, cosines)
            }

            fn atan2(self, x: Self) -> Self {
                let (y, x) = (self.to_array(), x.to_array());
                Self::new(core::array::from_fn(|i| Scalar::atan2(y[i], x[i])))
            }

            fn exp(self) -> Self {
                self.each(Scalar::exp)
            }

            fn ln(self) -> Self {
                self.each(Scalar::ln)
            }

            fn ln_1p(self) -> Self {
                self.each(Scalar::ln_1p)
            }

            fn sinh(self) -> Self {
                self.each(Scalar::sinh)
            }

            fn cosh(self) -> Self {
                self.each(Scalar::cosh)
            }

            fn sech(self) -> Self {
                self.each(Scalar::sech)
            }

            fn tanh(self) -> Self {
                self.each(Scalar::tanh)
            }

            fn ln_cosh(self) -> Self {
                self.each(Scalar::ln_cosh)
            }

            fn stumpff(self, order: usize) -> Self {
                self.each(|s| s.stumpff(order))
            }

            fn dexp_inverse(self, derivative: usize) -> Self {
                self.each(|s| s.dexp_inverse(derivative))
            }

            fn curve(self, curve: &Curve, order: usize) -> Self {
                self.each(|x| x.curve(curve, order))
            }

            fn rotation_vector(rotation: &Matrix3<Self>) -> Vector3<Self> {
                rotation::rotation_vector(rotation)
            }

            fn quaternion_vector(quaternion: [Self; 4]) -> Vector3<Self> {
                rotation::quaternion_vector(quaternion)
            }

            #[inline]
            fn less(self, other: Self) -> $mask {
                $mask(self.0.simd_lt(other.0))
            }

            #[inline]
            fn select(mask: $mask, if_true: Self, if_false: Self) -> Self {
                Self(mask.0.bitselect(if_true.0, if_false.0))
            }
        }
    };
}

implement_lanes!(F64x4, Mask4, f64x4, 4, "Four doubles, one a lane.");
implement_lanes!(F64x8, Mask8, f64x8, 8, "Eight doubles, one a lane.");
