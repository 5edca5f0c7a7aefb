//! Finite maps of a joint whose Φ is any map: Φ as declared and its derivatives, the rest by the runtime's Newton method.

use super::finite::residual_of_factor;
use crate::expr::{Expr, Symbol};
use crate::matrix::Matrix;
use crate::prepare::Prepared;
use std::collections::BTreeSet;

/// Φ(Q, ϕ) as declared.
pub fn retract(joint: &Prepared) -> Option<Matrix> {
    let declared = joint.spec.retract.as_ref()?;
    Some(Matrix::column_vector(declared.value.clone()))
}

/// ∂Φ/∂ϕ of the stored scalars, N×k.
pub fn retract_tangent(joint: &Prepared) -> Option<Matrix> {
    let moved = &joint.spec.retract.as_ref()?.value;
    let freedoms = &joint.spec.freedoms.value;
    Some(Matrix::from_fn(moved.len(), freedoms.len(), |i, j| {
        moved[i].derivative(&freedoms[j].local)
    }))
}

/// The declared relations with those of the known manifolds that they touch, and their derivatives by the stored scalars.
pub fn relations(joint: &Prepared) -> Option<(Matrix, Matrix)> {
    let manifold = &joint.space.manifold;
    let declared: &[Expr] = manifold.declared();
    if declared.is_empty() {
        return None;
    }
    let named: BTreeSet<Symbol> = declared.iter().flat_map(Expr::symbols).collect();
    let touched = manifold
        .factors()
        .iter()
        .filter(|factor| factor.coordinates.iter().any(|q| named.contains(q)));
    let own = touched.flat_map(residual_of_factor);
    let all: Vec<Expr> = own.chain(declared.iter().cloned()).collect();
    let coordinates = manifold.coordinates();
    let gradient = Matrix::from_fn(all.len(), coordinates.len(), |i, j| {
        all[i].derivative(&coordinates[j])
    });
    Some((Matrix::column_vector(all), gradient))
}
