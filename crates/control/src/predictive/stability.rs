//! How long steps of Kutta's method of order 4 may be for a motion that does not grow.

use hamel_integrate::Mode;
use nalgebra::{Complex, ComplexField};

/// Beyond this product of step and rate they are stable for no motion.
const MOST: f64 = 3.0;

/// Steps of the search for the end of stability, over that.
const PARTS: u32 = 3000;

/// Rounding of the factor of short steps, which is 1.
const ROUNDING: f64 = 1e-12;

/// The largest product of step and rate at which no step amplifies the motion: 2.83 where it is not damped, 2.61 and more where it is, 2.785 where it does not
/// oscillate.
pub(super) fn limit(mode: &Mode) -> f64 {
    let direction = Complex::new(mode.growth.min(0.0), mode.frequency);
    let direction = direction.unscale(direction.modulus().max(f64::MIN_POSITIVE));
    let lengths = (1..=PARTS).map(|part| MOST * f64::from(part) / f64::from(PARTS));
    let stable = lengths.take_while(|length| factor(direction.scale(*length)) <= 1.0 + ROUNDING);
    stable.last().unwrap_or(0.0)
}

/// What a step multiplies a motion by, `|1 + z + z²/2 + z³/6 + z⁴/24|`.
fn factor(z: Complex<f64>) -> f64 {
    let sum = [1.0 / 6.0, 0.5, 1.0, 1.0].into_iter();
    let sum = sum.fold(Complex::from(1.0 / 24.0), |sum, coefficient| {
        sum * z + coefficient
    });
    sum.modulus()
}

#[cfg(test)]
mod tests {
    use super::limit;
    use hamel_integrate::Mode;

    /// Where |R(z)| = 1 on the real axis (2.7853), on the imaginary one (2√2), and at 120° between them, where damping is half the critical one (2.6225, by
    /// bisection in Python).
    #[test]
    fn damping_shortens_what_is_stable() {
        let of = |growth: f64, frequency: f64| limit(&Mode { growth, frequency });
        // A part of the search.
        let close = |found: f64, expected: f64| (found - expected).abs() < 2e-3;
        assert!(close(of(-7.0, 0.0), 2.7853), "{}", of(-7.0, 0.0));
        assert!(close(of(0.0, 0.3), 8.0_f64.sqrt()), "{}", of(0.0, 0.3));
        let half = of(-0.5, 0.75_f64.sqrt());
        assert!(close(half, 2.6225), "{half}");
    }
}
