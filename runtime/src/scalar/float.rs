//! [`Scalar`] for `f64` and `f32`.

use super::{Scalar, hyperbolic, rotation, series};
use crate::curve::Curve;
use nalgebra::{Matrix3, Vector3};
use num_traits::Float;

macro_rules! implement_scalar {
    ($float:ident, $four:ty, $($batch:tt)*) => {
        impl Scalar for $float {
            type Mask = bool;
            type Four = $four;

            #[inline]
            fn from_f64(value: f64) -> Self {
                value as $float
            }

            #[inline]
            fn epsilon() -> Self {
                $float::EPSILON
            }

            #[inline]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                // Without the instruction a fused product is a library call, an order of magnitude slower.
                if cfg!(target_feature = "fma") {
                    Float::mul_add(self, factor, addend)
                } else {
                    self * factor + addend
                }
            }

            #[inline]
            fn sqrt(self) -> Self {
                Float::sqrt(self)
            }

            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                Float::sin_cos(self)
            }

            $($batch)*

            #[inline]
            fn atan2(self, x: Self) -> Self {
                Float::atan2(self, x)
            }

            #[inline]
            fn exp(self) -> Self {
                Float::exp(self)
            }

            #[inline]
            fn ln(self) -> Self {
                Float::ln(self)
            }

            #[inline]
            fn ln_1p(self) -> Self {
                Float::ln_1p(self)
            }

            #[inline]
            fn sinh(self) -> Self {
                Float::sinh(self)
            }

            #[inline]
            fn cosh(self) -> Self {
                Float::cosh(self)
            }

            #[inline]
            fn sech(self) -> Self {
                hyperbolic::sech(self)
            }

            #[inline]
            fn tanh(self) -> Self {
                Float::tanh(self)
            }

            #[inline]
            fn ln_cosh(self) -> Self {
                hyperbolic::ln_cosh(self)
            }

            #[inline]
            fn stumpff(self, order: usize) -> Self {
                series::stumpff(self, order)
            }

            #[inline]
            fn dexp_inverse(self, derivative: usize) -> Self {
                series::dexp_inverse(self, derivative)
            }

            #[inline]
            fn curve(self, curve: &Curve, order: usize) -> Self {
                curve.evaluate(self, self.into(), order)
            }

            #[inline]
            fn rotation_vector(rotation: &Matrix3<Self>) -> Vector3<Self> {
                rotation::rotation_vector(rotation)
            }

            #[inline]
            fn quaternion_vector(quaternion: [Self; 4]) -> Vector3<Self> {
                rotation::quaternion_vector(quaternion)
            }

            #[inline]
            fn less(self, other: Self) -> bool {
                self < other
            }

            #[inline]
            fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
                if mask { if_true } else { if_false }
            }
        }
    };
}

/// Four doubles side by side.
#[cfg(feature = "wide")]
type FourDoubles = super::F64x4;
#[cfg(not(feature = "wide"))]
type FourDoubles = super::Each<f64>;

implement_scalar!(
    f64,
    FourDoubles,
    #[inline]
    fn sin_cos_all<const N: usize>(angles: &[f64; N]) -> ([f64; N], [f64; N]) {
        super::batch::sin_cos_all(angles)
    }
);
implement_scalar!(f32, super::Each<Self>,);

/// Whether all are finite: `x − x` is 0 then, and NaN otherwise. Without a way out before the end, so that compilers compare several at once.
#[cfg(feature = "alloc")]
#[inline(always)]
pub fn all_finite(values: &[f64]) -> bool {
    #[expect(clippy::eq_op, reason = "0 where the value is finite, NaN elsewhere")]
    let bits = |value: &f64| (value - value).to_bits();
    values.iter().fold(0, |all, value| all | bits(value)) == 0
}

#[cfg(all(test, feature = "alloc"))]
mod tests {
    use super::all_finite;

    #[test]
    fn one_value_that_is_not_finite_is_seen_wherever_it_stands() {
        for length in 0..35 {
            let values: alloc::vec::Vec<f64> = (0..length)
                .map(|i| -f64::MAX / 2_f64.powi(61 * i))
                .collect();
            assert!(all_finite(&values));
            for at in 0..values.len() {
                for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                    let mut values = values.clone();
                    values[at] = broken;
                    assert!(!all_finite(&values), "{broken} at {at} of {length}");
                }
            }
        }
    }
}
