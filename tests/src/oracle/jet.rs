//! Polynomials in three infinitesimals, each with square zero: all mixed derivatives up to order 3, exactly.

use std::array;
use std::ops::{Add, Mul, Neg, Sub};

/// `Σ c_m · Π_{i ∈ m} ε_i` with ε_i² = 0; bit i of the index m stands for ε_i.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet([f64; 8]);

impl Jet {
    /// A number.
    pub const fn constant(value: f64) -> Self {
        let mut terms = [0.0; 8];
        terms[0] = value;
        Self(terms)
    }

    /// The infinitesimal ε_i, i below 3.
    pub const fn infinitesimal(i: usize) -> Self {
        let mut terms = [0.0; 8];
        terms[1 << i] = 1.0;
        Self(terms)
    }

    /// The coefficient of the product of the infinitesimals in the bits of `mask`.
    pub const fn coefficient(&self, mask: usize) -> f64 {
        self.0[mask]
    }

    /// `∂/∂ε_i`: the coefficient of ε_i, itself a jet.
    pub fn derivative(&self, i: usize) -> Self {
        let bit = 1 << i;
        Self(array::from_fn(|m| {
            if m & bit == 0 { self.0[m | bit] } else { 0.0 }
        }))
    }

    /// Sine and cosine.
    pub fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0[0].sin_cos();
        (
            self.taylor([sin, cos, -sin, -cos]),
            self.taylor([cos, -sin, -cos, sin]),
        )
    }

    /// `f(self)` from f, f′, f″, f‴ at its value; fourth powers of infinitesimals are zero.
    fn taylor(self, derivatives: [f64; 4]) -> Self {
        let [f, d1, d2, d3] = derivatives.map(Self::constant);
        let n = self - Self::constant(self.0[0]);
        f + n * (d1 + n * (d2 * Self::constant(1.0 / 2.0) + n * d3 * Self::constant(1.0 / 6.0)))
    }
}

impl Add for Jet {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(array::from_fn(|m| self.0[m] + other.0[m]))
    }
}

impl Sub for Jet {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(array::from_fn(|m| self.0[m] - other.0[m]))
    }
}

impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|term| -term))
    }
}

impl Mul for Jet {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        // The infinitesimals of each term are split between the two factors in every way.
        let term = |m: usize| {
            let parts = (0..8).filter(|part| part & m == *part);
            parts.map(|part| self.0[part] * other.0[m ^ part]).sum()
        };
        Self(array::from_fn(term))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUNDING: f64 = 1e-14; // A few roundings of numbers of order 1 to 10.

    #[test]
    fn products_hold_all_mixed_derivatives() {
        let [a, b, c] = [0, 1, 2].map(Jet::infinitesimal);
        let x = Jet::constant(2.0) + a + b + c;
        // d³/da db dc of x³ is 6, of x⁴ is 24 x.
        assert!((x * x * x).coefficient(0b111) == 6.0);
        assert!((x * x * x * x).coefficient(0b111) == 48.0);
        assert!((x * x).coefficient(0b011) == 2.0);
        assert!((x * x).derivative(0).coefficient(0) == 4.0);
        assert!((a * a) == Jet::constant(0.0));
    }

    #[test]
    fn sine_has_the_derivatives_of_sine() {
        let [a, b, c] = [0, 1, 2].map(Jet::infinitesimal);
        let (sin, cos) = (Jet::constant(0.7) + a + b + c).sin_cos();
        let close = |x: f64, y: f64| assert!((x - y).abs() < ROUNDING, "{x} {y}");
        close(sin.coefficient(0b111), -0.7_f64.cos());
        close(cos.coefficient(0b111), 0.7_f64.sin());
        close(sin.coefficient(0b110), -0.7_f64.sin());
        close((sin * sin + cos * cos).coefficient(0b111), 0.0);
    }
}
