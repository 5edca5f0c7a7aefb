//! Factorisation of mass matrices, with a name for what makes one singular.

use super::DynamicsError;
use crate::mechanism::Mechanism;
use nalgebra::{Cholesky, DMatrix, Dyn};

/// The two sizes that a mass matrix of a mechanism can have.
#[derive(Clone, Copy)]
pub(super) enum Space {
    /// M, one row a freedom.
    Freedoms,
    /// M̄, one row a speed.
    Speeds,
}

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
        return Err(singular(mechanism, space, row, 0.0, limit(row)));
    };
    for row in 0..diagonal.len() {
        let root = factors.l_dirty()[(row, row)];
        let pivot = root * root;
        if pivot.is_nan() || pivot <= limit(row) {
            return Err(singular(mechanism, space, row, pivot, limit(row)));
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

fn singular(
    mechanism: &Mechanism,
    space: Space,
    row: usize,
    pivot: f64,
    limit: f64,
) -> DynamicsError {
    let owner = mechanism.bodies().iter().find_map(|body| {
        let (range, names) = match space {
            Space::Freedoms => (&body.ranges().freedoms, body.joint().freedoms()),
            Space::Speeds => (&body.ranges().speeds, body.joint().speeds()),
        };
        let name = range
            .contains(&row)
            .then(|| names.get(row - range.start))??;
        Some((body.joint_name(), *name))
    });
    let (joint, speed) = owner.unwrap_or(("", ""));
    DynamicsError::SingularMass {
        joint: joint.into(),
        speed,
        pivot,
        limit,
    }
}
