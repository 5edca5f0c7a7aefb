//! Factorisation of mass matrices, with a name for what makes one singular.

use super::DynamicsError;
use crate::mechanism::{Mechanism, Space};
use nalgebra::{Cholesky, DMatrix, Dyn};

/// Cholesky factors of `matrix`, when its pivots stand above its rounding.
pub(super) fn factor(
    mechanism: &Mechanism,
    space: Space,
    matrix: DMatrix<f64>,
) -> Result<Cholesky<f64, Dyn>, DynamicsError> {
    let diagonal = matrix.diagonal();
    let limit = |row: usize| matrix.nrows() as f64 * f64::EPSILON * diagonal[row];
    let Some(factors) = Cholesky::new(matrix.clone()) else {
        let row = first_failure(&matrix);
        return Err(mechanism.singular_mass(space, row, 0.0, limit(row)));
    };
    for row in 0..diagonal.len() {
        let root = factors.l_dirty()[(row, row)];
        let pivot = root * root;
        if pivot.is_nan() || pivot <= limit(row) {
            return Err(mechanism.singular_mass(space, row, pivot, limit(row)));
        }
    }
    Ok(factors)
}

/// The row at which the factorisation breaks down: the smallest leading block that has none.
fn first_failure(matrix: &DMatrix<f64>) -> usize {
    let has_factors = |size: usize| {
        let block = matrix.view((0, 0), (size, size)).into_owned();
        Cholesky::new(block).is_some()
    };
    (0..matrix.nrows())
        .find(|row| !has_factors(row + 1))
        .unwrap_or(0)
}
