//! Eigenvalues of small dense matrices.

use alloc::vec::Vec;
use nalgebra::linalg::Schur;
use nalgebra::{Complex, DMatrix};

/// Sweeps of the iteration at most, many times what it takes.
const MOST_SWEEPS: usize = 100_000;

/// The eigenvalues of a square matrix; of each conjugate pair, the one above the real line. `None` where entries are not finite, or the iteration does not
/// end. The caller balances the matrix.
pub(crate) fn eigenvalues(matrix: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    if !matrix.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let schur = Schur::try_new(matrix, f64::EPSILON, MOST_SWEEPS)?;
    let all = schur.complex_eigenvalues();
    Some(all.iter().copied().filter(|x| x.im >= 0.0).collect())
}
