//! Hyperbolic functions that the standard library lacks, to a few units in the last place wherever their value is a number.

use super::Scalar;
use core::f64::consts::LN_2;
use num_traits::Float;

/// `1 / cosh x`, by the exponential that fades: cosh overflows before this is below the smallest number.
#[inline]
pub(super) fn sech<F: Float + Scalar>(x: F) -> F {
    let faded = Float::exp(-Float::abs(x));
    let one = F::from_f64(1.0);
    (faded + faded) / (one + faded * faded)
}

/// `ln cosh x`. Near 0 it is x²/2, where cosh x is 1 in rounded numbers: `cosh² = 1 + sinh²`; far from it |x| − ln 2.
#[inline]
pub(super) fn ln_cosh<F: Float + Scalar>(x: F) -> F {
    let size = Float::abs(x);
    if size <= F::from_f64(1.0) {
        let sine = Float::sinh(size);
        return F::from_f64(0.5) * Float::ln_1p(sine * sine);
    }
    let faded = Float::exp(F::from_f64(-2.0) * size);
    (size - F::from_f64(LN_2)) + Float::ln_1p(faded)
}
