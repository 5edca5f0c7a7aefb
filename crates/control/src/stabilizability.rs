//! Whether feedback can hold a linear system: every motion that does not decay by itself must be in reach of an input.
//!
//! By the test of M. L. J. Hautus (*Controllability and observability conditions of linear autonomous systems*, 1969): `[A − λ, B]` has full
//! rank at every eigenvalue λ of A whose motion does not decay. Asked before a Riccati equation is solved, since rounding makes such a motion decay
//! or grow by 1e-16 to 1e-8 of the rates of A, and the solver would find a huge cost for it instead of none.

use super::scales;
use hamel_integrate::eigen::{MOST_SWEEPS, eigenvalues};
use nalgebra::{Complex, ComplexField, DMatrix, DVector, SVD};

/// Regularity of `A − μ` that passes for none, of rows and columns of norm 1: some hundred roundings, times 1e4 for the conditioning of coordinates.
const SINGULAR: f64 = 1e-10;

/// Reach that passes for none, of rows and columns of norm 1: the root of a rounding, as states that move others, and are moved by their rounding alone, are
/// scaled until both are alike.
const FAINT: f64 = 2e-8;

/// Part of the distance from μ to an eigenvalue within which another one is much nearer.
const NEARER: f64 = 0.1;

/// Sweeps that make norms of rows and columns alike, to a factor of two or so.
const SWEEPS: usize = 8;

/// How a motion of `ẋ = A x` or `x′ = A x` that does not decay goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// The state that has the largest part in it.
    pub state: usize,
    /// Its eigenvalue: growth and frequency, 1/s and rad/s; of a step, real and imaginary part of its factor.
    pub eigenvalue: [f64; 2],
}

impl core::fmt::Display for Motion {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let [re, im] = self.eigenvalue;
        write!(
            f,
            "eigenvalue {re:.3e} ± {im:.3e} i, largest part in state {}",
            self.state
        )
    }
}

/// Time as a flow or by steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Time {
    /// `ẋ = A x + B u`.
    Continuous,
    /// `x′ = A x + B u`.
    Discrete,
}

/// A motion that neither fades nor is reached by a column of `b`, if there is one.
pub fn beyond(a: &DMatrix<f64>, b: &DMatrix<f64>, time: Time) -> Option<Motion> {
    if !a.iter().chain(b.iter()).all(|x| x.is_finite()) {
        return None;
    }
    // The same motions in states of like size: units of states and inputs must not decide.
    let (balanced, reach) = scales::balanced(a, b)?;
    let values = eigenvalues(balanced.clone())?;
    let mut lasting = values
        .iter()
        .filter(|value| lasts(&balanced, **value, &values, time));
    lasting.find_map(|&value| {
        let state = faint(pencil(&balanced, value, &reach), FAINT)?;
        Some(Motion {
            state,
            eigenvalue: [value.re, value.im],
        })
    })
}

/// Whether the motion of an eigenvalue does not decay, or, up to rounding, might not: whether `A − μ` is regular at the nearest μ that does not.
/// Nearby eigenvalues are each far less certain than that, by the root of a rounding where two are one; those into which rounding parts one that is double lie
/// around it at like distances, so that one much nearer to μ tells of another motion.
fn lasts(a: &DMatrix<f64>, value: Complex<f64>, all: &[Complex<f64>], time: Time) -> bool {
    let nearest = match time {
        Time::Continuous if value.re < 0.0 => Complex::new(0.0, value.im),
        Time::Discrete if value.modulus() == 0.0 => return false,
        Time::Discrete if value.modulus() < 1.0 => value.unscale(value.modulus()),
        _ => return true,
    };
    let distance = (value - nearest).modulus();
    if all
        .iter()
        .any(|other| (other - nearest).modulus() < NEARER * distance)
    {
        return false;
    }
    let none = DMatrix::zeros(a.nrows(), 0);
    faint(pencil(a, nearest, &none), SINGULAR).is_some()
}

/// `[A − λ, B]` with rows and columns of norm 1 or so, and what its rows were divided by.
fn pencil(
    a: &DMatrix<f64>,
    value: Complex<f64>,
    b: &DMatrix<f64>,
) -> (DMatrix<Complex<f64>>, DVector<f64>) {
    let n = a.nrows();
    let mut whole = DMatrix::from_fn(n, n + b.ncols(), |i, j| match j.checked_sub(n) {
        None if i == j => Complex::from(a[(i, j)]) - value,
        None => Complex::from(a[(i, j)]),
        Some(input) => Complex::from(b[(i, input)]),
    });
    let mut sizes = DVector::from_element(n, 1.0);
    for _ in 0..SWEEPS {
        for (mut row, size) in whole.row_iter_mut().zip(&mut sizes) {
            let norm = size_of(row.norm());
            *size *= norm;
            row.unscale_mut(norm);
        }
        for mut column in whole.column_iter_mut() {
            column.unscale_mut(size_of(column.norm()));
        }
    }
    (whole, sizes)
}

/// What to divide rows and columns of a norm by.
fn size_of(norm: f64) -> f64 {
    if norm > 0.0 { norm } else { 1.0 }
}

/// The state that has the largest part in the direction in which rows reach no further than `least`. `None` also where the singular values
/// cannot be found.
fn faint((whole, sizes): (DMatrix<Complex<f64>>, DVector<f64>), least: f64) -> Option<usize> {
    let found = SVD::try_new(whole, true, false, 5.0 * f64::EPSILON, MOST_SWEEPS)?;
    let singular = found.singular_values.iter().enumerate();
    let (place, _) = singular
        .min_by(|left, right| left.1.total_cmp(right.1))
        .filter(|(_, found)| **found <= least)?;
    let direction = found.u?;
    let part = |state: usize| direction[(state, place)].modulus() / sizes[state];
    (0..sizes.len()).max_by(|&i, &j| part(i).total_cmp(&part(j)))
}

#[cfg(test)]
mod tests {
    use super::{Time, beyond};
    use nalgebra::DMatrix;

    /// Squares of these entries are beyond doubles: with norms that are infinite or 0, what is reached passes for missed, or the singular values
    /// are looked for without an end.
    #[test]
    fn inputs_and_weights_of_any_size_are_judged() {
        let oscillator = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -1.0, 0.0]);
        for size in [1e308, 1e-308, f64::MAX] {
            let reached = DMatrix::from_row_slice(2, 2, &[size, 0.0, 0.0, 2.0]);
            for time in [Time::Continuous, Time::Discrete] {
                assert_eq!(beyond(&oscillator, &reached, time), None, "{size}");
            }
            let drift = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0]);
            let missed = DMatrix::from_row_slice(2, 1, &[size, 0.0]);
            let found = beyond(&drift, &missed, Time::Continuous);
            assert_eq!(found.map(|motion| motion.state), Some(1), "{size}");
        }
    }

    /// A ball joint whose attitudes weigh 1e308: a scene that a fuzzer found, for which the singular values were looked for without an end.
    #[test]
    fn huge_weights_of_attitudes_beside_small_ones_of_rates_end() {
        let states = DMatrix::from_fn(6, 6, |i, j| match (i, j) {
            (0..=2, 3..=5) if j == i + 3 => 1.0,
            (3..=5, 0..=2) if i == j + 3 && j < 2 => -2.4,
            (3, 1) | (4, 2) => 0.3,
            _ => 0.0,
        });
        let weights = |i: usize| if i < 3 { 1.01e308 } else { 2.0 };
        let weights = DMatrix::from_fn(6, 6, |i, j| if i == j { weights(i) } else { 0.0 });
        for time in [Time::Continuous, Time::Discrete] {
            assert_eq!(beyond(&states.transpose(), &weights, time), None);
        }
    }
}
