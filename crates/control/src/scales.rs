//! Scales in which the states of a linear system, and its inputs, are of like size.

use hamel_integrate::eigen::balance;
use nalgebra::{DMatrix, DVector};
use num_traits::Float;

/// Parts of an input's largest effect that pass for the rounding of zeros, and say nothing of scales.
const ROUNDING: f64 = 1e-13;

/// Sizes of states in which rows and columns of `[A, −G; −Q, −Aᵀ]` are alike, those of costates being their inverses. `None` where entries are not finite, or
/// beyond 1e140.
pub(super) fn of_hamiltonian(
    a: &DMatrix<f64>,
    reach: &DMatrix<f64>,
    state: &DMatrix<f64>,
) -> Option<DVector<f64>> {
    let n = a.nrows();
    let mut whole = DMatrix::zeros(2 * n, 2 * n);
    whole.view_mut((0, 0), (n, n)).copy_from(a);
    whole.view_mut((0, n), (n, n)).copy_from(&-reach);
    whole.view_mut((n, 0), (n, n)).copy_from(&-state);
    whole.view_mut((n, n), (n, n)).copy_from(&-a.transpose());
    let all = balance(&mut whole)?;
    Some(DVector::from_fn(n, |i, _| Float::sqrt(all[i] / all[n + i])))
}

/// `D⁻¹ A D`.
pub(super) fn similar(a: &DMatrix<f64>, scales: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| {
        a[(i, j)] * (scales[j] / scales[i])
    })
}

/// `D⁻¹ B`.
pub(super) fn divided(b: &DMatrix<f64>, scales: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(b.nrows(), b.ncols(), |i, j| b[(i, j)] / scales[i])
}

/// A and B with states of like size, also as the inputs move them, and inputs that do no more in any state than its own motion.
pub(super) fn balanced(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let first = balance(&mut a.clone())?;
    let (own, driven) = (similar(a, &first), divided(&of_size_one(b), &first));
    let n = a.nrows();
    let mut loops = loops(&own, &driven);
    let scales = balance(&mut loops)?.rows(0, n).into_owned();
    let (a, mut b) = (similar(&own, &scales), divided(&driven, &scales));
    let rates = rates(&a);
    for mut column in b.column_iter_mut() {
        let sizes = column
            .iter()
            .zip(&rates)
            .map(|(entry, rate)| entry.abs() / rate);
        let most = sizes.fold(0.0, f64::max);
        if most > 0.0 {
            column /= most;
        }
    }
    Some((a, b))
}

/// The matrix with columns whose largest entry is 1: squares of larger ones may be beyond doubles, and norms with them.
fn of_size_one(b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut columns = b.clone();
    for mut column in columns.column_iter_mut() {
        let largest = column.amax();
        if largest > 0.0 {
            column /= largest;
        }
    }
    columns
}

/// A and B with a feedback that closes each way of B by the rate of the state it drives.
fn loops(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let (n, m) = b.shape();
    let rates = rates(a);
    let mut whole = DMatrix::zeros(n + m, n + m);
    whole.view_mut((0, 0), (n, n)).copy_from(a);
    for (j, column) in b.column_iter().enumerate() {
        let norm = column.norm();
        let known = column.iter().enumerate();
        for (i, entry) in known.filter(|(_, entry)| entry.abs() > ROUNDING * norm) {
            whole[(i, n + j)] = entry / norm;
            whole[(n + j, i)] = rates[i] * rates[i] * norm / entry;
        }
    }
    whole
}

/// How fast each state moves, or moves others; that of all where it does neither.
fn rates(a: &DMatrix<f64>) -> DVector<f64> {
    let largest = match a.norm() {
        0.0 => 1.0,
        norm => norm,
    };
    DVector::from_fn(a.nrows(), |i, _| {
        match a.row(i).norm().max(a.column(i).norm()) {
            0.0 => largest,
            rate => rate,
        }
    })
}
