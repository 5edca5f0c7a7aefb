//! What the runtime's Newton method needs: Φ as declared where it is any map, and the relations of declared manifolds.

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

/// The declared relations with those of the known manifolds that they touch, as a column.
pub fn relations(joint: &Prepared) -> Option<Matrix> {
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
    Some(Matrix::column_vector(
        own.chain(declared.iter().cloned()).collect(),
    ))
}
