//! The scalar that kernels are generic over: `f64`, `f32`, SIMD lanes, dual numbers.
//!
//! Kernels are pure and branch on data only through [`Scalar::select`], so that one source serves all of them.
//! Functions whose textbook form loses digits near a removable singularity are primitives of their own here, with
//! derivatives of their own; no branch is ever differentiated.

mod batch;
mod dual;
mod extended;
mod float;
mod four;
mod hyperbolic;
mod lane;
#[cfg(feature = "wide")]
mod lanes;
mod rotation;
mod series;

pub use dual::Dual;
pub use extended::Extended;
#[cfg(feature = "alloc")]
pub use float::all_finite;
pub use four::{Each, Four};
pub use lane::Lane;
#[cfg(feature = "wide")]
pub use lanes::{F64x4, F64x8, Mask4, Mask8};

use crate::curve::Curve;
use core::ops::Neg;
use nalgebra::{
    ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign, Matrix3, Vector3,
};
use num_traits::{One, Zero};

/// A real number, a bundle of them (SIMD lanes), or a truncated series (dual numbers).
pub trait Scalar:
    nalgebra::Scalar
    + Copy
    + Send
    + Sync
    + Zero
    + One
    + Neg<Output = Self>
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
{
    /// The result of a comparison: `bool`, or one truth value a lane.
    type Mask: Copy;

    /// Four of them side by side, for what a mechanism's like limbs share: in SIMD registers for `f64` with the feature `wide`.
    type Four: Four<Self>;

    /// The constant `value`, in every lane.
    fn from_f64(value: f64) -> Self;

    /// Distance from 1 to the next larger number of its precision.
    fn epsilon() -> Self;

    /// `self * factor + addend`, fused only where the target has a fused instruction.
    fn mul_add(self, factor: Self, addend: Self) -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);

    /// Sine and cosine of several angles in radians, together faster than one by one; within 1.5 units in the last place.
    #[inline]
    fn sin_cos_all<const N: usize>(angles: &[Self; N]) -> ([Self; N], [Self; N]) {
        let (mut sines, mut cosines) = ([Self::zero(); N], [Self::zero(); N]);
        for i in 0..N {
            (sines[i], cosines[i]) = angles[i].sin_cos();
        }
        (sines, cosines)
    }

    /// Angle of the point `(x, self)` in the plane, in (−π, π].
    fn atan2(self, x: Self) -> Self;

    /// Exponential function.
    fn exp(self) -> Self;

    /// Natural logarithm.
    fn ln(self) -> Self;

    /// `ln(1 + self)`, accurate where `self` is small.
    fn ln_1p(self) -> Self;

    /// `ln(1 + self · e^scale)` for a scale that is not negative, without the exponential, which may overflow; accurate for a small
    /// `self` where the scale is 0.
    #[inline]
    fn ln_1p_scaled(self, scale: Self) -> Self {
        let far = scale + (self + (-scale).exp()).ln();
        Self::select(Self::zero().less(scale), far, self.ln_1p())
    }

    /// Hyperbolic sine.
    fn sinh(self) -> Self;

    /// Hyperbolic cosine.
    fn cosh(self) -> Self;

    /// Hyperbolic secant `1 / cosh`, also where the hyperbolic cosine overflows.
    fn sech(self) -> Self;

    /// Hyperbolic tangent.
    fn tanh(self) -> Self;

    /// `ln cosh`, also where the hyperbolic cosine overflows, and accurate where it is 1.
    fn ln_cosh(self) -> Self;

    /// Stumpff function `c_k(s) = Σ_j (−s)^j / (k + 2j)!` of `s = self`, entire in `s`.
    ///
    /// With `s = θ²`: `c_0 = cos θ`, `c_1 = sin θ / θ`, `c_2 = (1 − cos θ)/θ²`, `c_3 = (θ − sin θ)/θ³`. The derivative is
    /// `dc_k/ds = (k c_{k+2} − c_{k+1}) / 2`, so the family is closed under differentiation.
    fn stumpff(self, order: usize) -> Self;

    /// `n`-th derivative in `s = self` of `G(s) = (1 − (θ/2) cot(θ/2)) / θ²`, `s = θ²`, for `|θ| < 2π`.
    ///
    /// `G` is the coefficient of `ad²` in `dexp⁻¹`; `G(0) = 1/12`.
    fn dexp_inverse(self, derivative: usize) -> Self;

    /// The derivative of this order of a curve at `self`, that of order 0 being its value; the piece is that of the plain value.
    fn curve(self, curve: &Curve, order: usize) -> Self;

    /// Rotation vector `r` with `exp(r~) = rotation` and `|r| ≤ π`, accurate at every angle.
    fn rotation_vector(rotation: &Matrix3<Self>) -> Vector3<Self>;

    /// Rotation vector, `|r| ≤ π`, of the rotation by the quaternion `(w, x, y, z)`, accurate at every angle; neither the length of the
    /// quaternion, which is not 0, nor its sign matters.
    fn quaternion_vector(quaternion: [Self; 4]) -> Vector3<Self>;

    /// Whether `self < other`, lane by lane.
    fn less(self, other: Self) -> Self::Mask;

    /// `if_true` where `mask` holds, else `if_false`, lane by lane.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;

    /// The larger of two numbers, lane by lane.
    #[inline]
    fn larger(self, other: Self) -> Self {
        Self::select(self.less(other), other, self)
    }
}

/// `a₁ b₁ + (a₂ b₂ + …)`, each product but the last fused with the sum of those after it, as emitted formulas write it.
#[inline(always)]
pub fn dot<T: Scalar, const N: usize>(a: [T; N], b: [T; N]) -> T {
    let mut sum = a[N - 1] * b[N - 1];
    for i in (0..N - 1).rev() {
        sum = a[i].mul_add(b[i], sum);
    }
    sum
}
