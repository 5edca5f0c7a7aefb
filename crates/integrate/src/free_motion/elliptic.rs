//! Jacobi's amplitude and the elliptic integral of the first kind, by the arithmetic–geometric mean.
//!
//! M. Abramowitz and I. A. Stegun, *Handbook of Mathematical Functions*, 16.4 and 17.6.

use core::f64::consts::{FRAC_PI_2, PI};
use num_traits::Float;

/// Means that are taken at most: they converge quadratically, from k′ = 1e-300 on after 13.
const MOST: usize = 16;

/// The means of 1 and k′.
#[derive(Clone, Copy, Debug)]
pub(super) struct Elliptic {
    /// a_n, b_n and c_n.
    means: [[f64; 3]; MOST],
    /// The index of the last of them.
    last: usize,
}

impl Elliptic {
    /// For the modulus k and k′, with k² + k′² = 1. `None` where k′ is 0: the period is infinite there.
    pub(super) fn new(k: f64, complement: f64) -> Option<Self> {
        if complement.is_nan() || complement <= 0.0 {
            return None;
        }
        let mut means = [[0.0; 3]; MOST];
        means[0] = [1.0, complement, k];
        for n in 0..MOST - 1 {
            let [a, b, c] = means[n];
            if c <= f64::EPSILON * a {
                return Some(Self { means, last: n });
            }
            means[n + 1] = [0.5 * (a + b), Float::sqrt(a * b), 0.5 * (a - b)];
        }
        None
    }

    /// K, a quarter of the period.
    pub(super) fn quarter(&self) -> f64 {
        FRAC_PI_2 / self.means[self.last][0]
    }

    /// `F(φ) = ∫ dφ / √(1 − k² sin²φ)` from 0 to φ.
    pub(super) fn integral(&self, phi: f64) -> f64 {
        let turns = Float::round(phi / PI);
        let mut phi = phi - turns * PI;
        let mut scale = 1.0;
        for [a, b, _] in &self.means[..self.last] {
            // `tan(φₙ₊₁ − φₙ) = b/a tan φₙ`, by what it is beyond 2φₙ: that is less than a right angle.
            let (sin, cos) = Float::sin_cos(phi);
            phi = 2.0 * phi + Float::atan2((b - a) * sin * cos, a * cos * cos + b * sin * sin);
            scale *= 2.0;
        }
        2.0 * self.quarter() * turns + phi / (scale * self.means[self.last][0])
    }

    /// am(u): the φ with F(φ) = u.
    pub(super) fn amplitude(&self, u: f64) -> f64 {
        let half = 2.0 * self.quarter();
        let turns = Float::round(u / half);
        let mut phi = (u - turns * half) * self.means[self.last][0];
        for _ in 0..self.last {
            phi *= 2.0;
        }
        for [a, _, c] in self.means[1..=self.last].iter().rev() {
            phi = 0.5 * (phi + Float::asin(c / a * Float::sin(phi)));
        }
        turns * PI + phi
    }
}

#[cfg(test)]
mod tests {
    use super::Elliptic;

    /// K(1/2) and F(1 | m = 1/2) of A&S tables 17.1 and 17.5, and am as the inverse of F.
    #[test]
    fn values_and_inverses() {
        let half = f64::sqrt(0.5);
        let elliptic = Elliptic::new(half, half).expect("a period");
        assert!((elliptic.quarter() - 1.854_074_677_301_372).abs() < 1e-15);
        for k2 in [0.0, 1e-20, 1e-6, 0.3, 0.999, 1.0 - 1e-12] {
            let elliptic = Elliptic::new(f64::sqrt(k2), f64::sqrt(1.0 - k2)).expect("a period");
            for phi in [-7.0, -1.5, 0.0, 1e-9, 0.4, 1.5, 1.7, 3.0, 12.0] {
                let back = elliptic.amplitude(elliptic.integral(phi));
                // Near a half turn F grows as 1/k′ with φ.
                assert!(
                    (back - phi).abs() < 1e-14 * phi.abs().max(1.0),
                    "{k2} {phi}: {back}"
                );
            }
        }
        assert!(Elliptic::new(1.0, 0.0).is_none());
    }
}
