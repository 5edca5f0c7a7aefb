//! The Boltzmann–Hamel terms at joint level: γ (17) and J22 (28).

use super::velocity::VelocityMap;
use crate::expr::Expr;
use crate::matrix::Matrix;

/// `Σ_k γ_k v_k` with `(γ_k)_ij = Σ_lm S⁻¹_li S⁻¹_mk (∂S_jl/∂ϕ_m − ∂S_jm/∂ϕ_l)`, (17).
pub fn gamma(s: &VelocityMap, s_inverse: &Matrix, velocity: &Matrix) -> Matrix {
    let size = s.base.rows();
    let rates = s_inverse.times(velocity);
    let inner = Matrix::from_fn(size, size, |l, j| {
        (0..size)
            .map(|m| &(s.slopes[m].at(j, l) - s.slopes[l].at(j, m)) * rates.at(m, 0))
            .sum()
    });
    s_inverse.transpose().times(&inner)
}

/// `J22 = S⁻ᵀ(Bᵀ − B)S⁻¹` with `B_im = Σ_l ∂S_li/∂ϕ_m p_l`, (28).
pub fn j22(s: &VelocityMap, s_inverse: &Matrix, momentum: &Matrix) -> Matrix {
    let size = s.base.rows();
    let b = Matrix::from_fn(size, size, |i, m| -> Expr {
        (0..size)
            .map(|l| s.slopes[m].at(l, i) * momentum.at(l, 0))
            .sum()
    });
    s_inverse
        .transpose()
        .times(&b.transpose().minus(&b))
        .times(s_inverse)
}
