//! Eigenvalues of small dense matrices.

use alloc::vec::Vec;
use nalgebra::linalg::{Schur, balancing::balance_parlett_reinsch};
use nalgebra::{Complex, DMatrix, DVector};

/// Sweeps of the iteration at most, many times what it takes.
pub const MOST_SWEEPS: usize = 100_000;

/// Largest entry of what is balanced: with larger ones squares of norms overflow, and balancing does not end.
const LARGEST: f64 = 1e140;

/// Makes norms of rows and columns of a matrix alike by a diagonal similarity, which is returned. `None` where entries are not finite, or beyond 1e140.
pub fn balance(matrix: &mut DMatrix<f64>) -> Option<DVector<f64>> {
    let is_moderate = |entry: &f64| entry.abs() <= LARGEST;
    let moderate = matrix.iter().all(is_moderate);
    moderate.then(|| balance_parlett_reinsch(matrix))
}

/// The eigenvalues of a square matrix; of each conjugate pair, the one above the real line. `None` where entries are not finite, or the iteration does not
/// end. The caller balances the matrix.
pub fn eigenvalues(matrix: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    if !matrix.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let schur = Schur::try_new(matrix, f64::EPSILON, MOST_SWEEPS)?;
    let all = schur.complex_eigenvalues();
    Some(all.iter().copied().filter(|x| x.im >= 0.0).collect())
}

#[cfg(test)]
mod tests {
    use super::{balance, eigenvalues};
    use nalgebra::DMatrix;

    #[test]
    fn what_cannot_be_balanced_is_refused() {
        for entry in [1e160, f64::INFINITY, f64::NAN] {
            let mut matrix = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -entry, 0.0]);
            assert!(balance(&mut matrix).is_none(), "{entry}");
        }
    }

    /// Of `ẍ = −k x`.
    #[test]
    fn an_oscillator_has_one_pair() {
        let mut matrix = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -1e12, 0.0]);
        balance(&mut matrix).expect("moderate entries");
        let found = eigenvalues(matrix).expect("finite entries");
        // A rounding of the frequency, 1e6.
        assert!(
            found.len() == 1 && (found[0].im - 1e6).abs() < 1e-9,
            "{found:?}"
        );
    }
}
