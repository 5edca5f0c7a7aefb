//! Whether feedback can hold a linear system: every motion that does not fade by itself must be in reach of an input.
//!
//! By the test of M. L. J. Hautus (*Controllability and observability conditions of linear autonomous systems*, 1969): `[A − λ, B]` has full
//! rank at every eigenvalue λ of A whose motion does not fade. Asked before a Riccati equation is solved, since rounding makes such a motion fade
//! or grow by 1e-16 to 1e-8 of the rates of A, and the solver would find a huge cost for it instead of none.

use crate::eigen::{balance, eigenvalues};
use nalgebra::{Complex, DMatrix, DVector};

/// Rates of fading that pass for none, as parts of the largest rate: two equal eigenvalues of a Jordan block move by √eps = 1.5e-8, three by 6e-6
/// of which the test of rank is left to judge.
const SLOW: f64 = 1e-7;

/// Reach that passes for none, as a part of the largest: some hundred roundings, times 1e4 for the conditioning of coordinates.
const FAINT: f64 = 1e-10;

/// Entries that pass for the rounding of zeros, as parts of the largest, where scales are chosen: balanced against them, states would differ by 1e8.
const ROUNDING: f64 = 1e-13;

/// How a motion of `ẋ = A x` or `x′ = A x` that does not fade goes on.
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
    // The same motions in states of like size: units of states must not decide.
    let scales = like_sizes(a)?;
    let balanced = DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| {
        a[(i, j)] * (scales[j] / scales[i])
    });
    let size = match balanced.norm() {
        0.0 => 1.0,
        norm => norm,
    };
    let mut reach = b.clone();
    for (mut row, scale) in reach.row_iter_mut().zip(&scales) {
        row /= *scale;
    }
    for mut column in reach.column_iter_mut() {
        let norm = column.norm();
        if norm > 0.0 {
            column *= size / norm;
        }
    }
    let lasts = |value: &Complex<f64>| match time {
        Time::Continuous => value.re >= -SLOW * size,
        Time::Discrete => value.norm_sqr() >= 1.0 - 2.0 * SLOW,
    };
    let mut lasting = eigenvalues(balanced.clone())?.into_iter().filter(lasts);
    lasting.find_map(|eigenvalue| {
        let state = unreached(&balanced, &reach, eigenvalue, FAINT * size)?;
        Some(Motion {
            state,
            eigenvalue: [eigenvalue.re, eigenvalue.im],
        })
    })
}

/// Sizes of states in which rows and columns of `a` are alike.
fn like_sizes(a: &DMatrix<f64>) -> Option<DVector<f64>> {
    let least = ROUNDING * a.amax();
    let mut known = a.map(|x| if x.abs() <= least { 0.0 } else { x });
    balance(&mut known)
}

/// The state that has the largest part in the direction in which `[A − λ, B]` reaches no further than `faint`.
fn unreached(
    a: &DMatrix<f64>,
    reach: &DMatrix<f64>,
    eigenvalue: Complex<f64>,
    faint: f64,
) -> Option<usize> {
    let n = a.nrows();
    let whole = DMatrix::from_fn(n, n + reach.ncols(), |i, j| match j.checked_sub(n) {
        None if i == j => Complex::from(a[(i, j)]) - eigenvalue,
        None => Complex::from(a[(i, j)]),
        Some(input) => Complex::from(reach[(i, input)]),
    });
    let found = whole.svd(true, false);
    let (place, &least) = found
        .singular_values
        .iter()
        .enumerate()
        .min_by(|left, right| left.1.total_cmp(right.1))?;
    if least > faint {
        return None;
    }
    let direction = found.u?;
    (0..n).max_by(|&i, &j| {
        let part = |k: usize| direction[(k, place)].norm_sqr();
        part(i).total_cmp(&part(j))
    })
}
