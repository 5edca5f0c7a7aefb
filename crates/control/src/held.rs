//! How long the efforts of a law may be held before deviations grow.

use super::ControlError;
use super::error::positive;
use alloc::vec::Vec;
use hamel_integrate::eigen;
use nalgebra::{Complex, ComplexField, DMatrix};
use num_traits::Float;

/// The largest eigenvalue of a step that passes for 1: rounding of what is not seen, which keeps its size.
const GROWS: f64 = 1.0 + 1e-6;

/// Halvings of a period that is too long, and steps of bisection then.
const HALVINGS: usize = 60;
const BISECTIONS: usize = 10;

/// Terms of the series: the next is below 1e-21 of the first.
const TERMS: u32 = 16;

/// Halvings of a matrix at most: its exponential is beyond all numbers long before.
const MOST_HALVINGS: f64 = 64.0;

/// `ẋ = A x + B u` with `u = −K x`.
pub(super) struct Loop<'a> {
    pub(super) a: &'a DMatrix<f64>,
    pub(super) b: &'a DMatrix<f64>,
    pub(super) gain: &'a DMatrix<f64>,
}

impl Loop<'_> {
    /// Whether deviations do not grow where u is held for `period`, s.
    ///
    /// # Errors
    /// A period that is not positive, or not finite; one that is too long, with the longest.
    pub(super) fn check(&self, period: f64) -> Result<(), ControlError> {
        positive("period", period)?;
        match self.grows(period) {
            true => Err(ControlError::HeldTooLong {
                period,
                longest: self.longest(period),
            }),
            false => Ok(()),
        }
    }

    /// The longest period below one that is too long.
    fn longest(&self, period: f64) -> f64 {
        let halves = core::iter::successors(Some(0.5 * period), |half| Some(0.5 * half));
        let stable = halves.take(HALVINGS).find(|&half| !self.grows(half));
        let Some(mut least) = stable else { return 0.0 };
        let mut most = 2.0 * least;
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (least + most);
            match self.grows(middle) {
                true => most = middle,
                false => least = middle,
            }
        }
        least
    }

    /// Whether an eigenvalue of one period is larger than 1: x goes to `(A_d − B_d K) x`, where A_d and B_d are the upper blocks of `exp([A B; 0 0] T)`.
    fn grows(&self, period: f64) -> bool {
        let (states, inputs) = self.b.shape();
        let mut both = DMatrix::zeros(states + inputs, states + inputs);
        both.view_mut((0, 0), (states, states))
            .copy_from(&(self.a * period));
        both.view_mut((0, states), (states, inputs))
            .copy_from(&(self.b * period));
        let both = exponential(both);
        let mut step = both.view((0, 0), (states, states)).into_owned();
        step -= both.view((0, states), (states, inputs)) * self.gain;
        let Some(_) = eigen::balance(&mut step) else {
            return true;
        };
        let all: Option<Vec<Complex<f64>>> = eigen::eigenvalues(step);
        // Where they are not found, nothing is said of them.
        all.is_some_and(|all| all.iter().any(|own| own.modulus() > GROWS))
    }
}

/// The exponential of a matrix: Taylor's series of a part of it that is below a half, squared as often as that was halved (that of nalgebra needs `std`).
fn exponential(matrix: DMatrix<f64>) -> DMatrix<f64> {
    let size = matrix.amax() * matrix.nrows() as f64;
    let halvings = Float::log2(size).ceil().clamp(0.0, MOST_HALVINGS) + 1.0;
    let part = matrix * Float::exp2(-halvings);
    let mut term = DMatrix::identity(part.nrows(), part.nrows());
    let mut sum = term.clone();
    for k in 1..=TERMS {
        term = &term * &part / f64::from(k);
        sum += &term;
    }
    for _ in 0..halvings as u32 {
        sum = &sum * &sum;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::Loop;
    use nalgebra::DMatrix;

    /// A double integrator with `u = −ω² x − 2ζω ẋ`, by Jury's conditions: up to min(4 ζ, 1/ζ)/ω.
    #[test]
    fn the_longest_period_is_that_of_jury() {
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0]);
        let b = DMatrix::from_row_slice(2, 1, &[0.0, 1.0]);
        for (ratio, omega) in [(1.0, 50.0), (0.2, 3.0), (2.5, 10.0)] {
            let gain = DMatrix::from_row_slice(1, 2, &[omega * omega, 2.0 * ratio * omega]);
            let own = Loop {
                a: &a,
                b: &b,
                gain: &gain,
            };
            let longest = (4.0 * ratio).min(1.0 / ratio) / omega;
            assert!(own.check(0.99 * longest).is_ok());
            let told = own.check(7.0 * longest).map_err(|error| error.to_string());
            assert!(told.is_err_and(|told| told.contains("too long")));
            // A bisection of the last factor of two in 10 steps.
            assert!((own.longest(7.0 * longest) / longest - 1.0).abs() < 2e-3);
        }
    }
}
