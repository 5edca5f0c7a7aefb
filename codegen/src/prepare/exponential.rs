//! Φ = Q exp(ϕ) in closed form, and whether the declared Φ is that.

use crate::algebra;
use crate::expr::Expr;
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use crate::model::JointSpec;

/// Whether Φ is Q exp(ϕ) on every factor, so that its finite maps have closed forms.
pub fn is_exponential(spec: &JointSpec, ideal: &Ideal) -> bool {
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
    let mut pairs = declared.value.iter().zip(&expected);
    pairs.all(|(entry, other)| ideal.vanishes(&(entry - other)))
}

/// The algebra element Σ b_k ϕ_k of one factor, as the matrix that multiplies.
pub fn local_element(spec: &JointSpec, factor: usize) -> Matrix {
    let kind = spec.manifold.value.factors()[factor].kind;
    let mut standard = vec![Expr::zero(); kind.dimension()];
    for freedom in spec
        .freedoms
        .value
        .iter()
        .filter(|freedom| freedom.factor == factor && !freedom.generator.is_empty())
    {
        for (sum, component) in standard.iter_mut().zip(&freedom.generator) {
            *sum += &(component * &Expr::symbol(&freedom.local));
        }
    }
    algebra::hat(kind, &standard)
}

/// Q exp(ϕ) in closed form, as stored scalars; `None` where exp has none.
pub fn exponential(spec: &JointSpec) -> Option<Vec<Expr>> {
    let mut moved = vec![];
    for (n, factor) in spec.manifold.value.factors().iter().enumerate() {
        let exp = algebra::exp(&local_element(spec, n))?;
        moved.extend(factor.coordinates_of(&factor.matrix().times(&exp)));
    }
    Some(moved)
}
