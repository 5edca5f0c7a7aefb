//! What the runtime's Newton method needs: Φ as declared where it is any map, and the relations of declared manifolds.

use super::finite::residual_of_factor;
use super::motion::exponential;
use crate::expr::{Expr, Symbol};
use crate::matrix::Matrix;
use crate::model::JointSpec;
use std::collections::BTreeSet;

/// Whether Φ is Q exp(ϕ) on every factor, so that its finite maps have closed forms.
pub fn is_exponential(spec: &JointSpec) -> bool {
    if spec
        .freedoms
        .value
        .iter()
        .any(|freedom| freedom.generator.is_empty())
    {
        return false;
    }
    let Some(declared) = &spec.retract else {
        return true;
    };
    let Some(expected) = exponential(spec) else {
        return false;
    };
    let ideal = spec.manifold.value.ideal();
    let mut pairs = declared.value.iter().zip(&expected);
    pairs.all(|(entry, other)| ideal.vanishes(&(entry - other)))
}

/// Φ(Q, ϕ) as declared.
pub fn retract(spec: &JointSpec) -> Option<Matrix> {
    let declared = spec.retract.as_ref()?;
    Some(Matrix::column_vector(declared.value.clone()))
}

/// The declared relations with those of the known manifolds that they touch, as a column.
pub fn relations(spec: &JointSpec) -> Option<Matrix> {
    let manifold = &spec.manifold.value;
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
