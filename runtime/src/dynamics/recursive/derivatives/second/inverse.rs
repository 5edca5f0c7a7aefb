//! Second derivatives of inverse dynamics.

use super::contraction::Contraction;
use crate::dynamics::recursive::Recursive;
use crate::dynamics::{DynamicsError, Sensitivity};
use crate::mechanism::Mechanism;

/// `λᵀ∂²τ̄` of inverse dynamics, over (ϕ, v̄, v̄̇).
#[derive(Clone, Debug)]
pub struct InverseSecondDerivatives {
    contraction: Contraction,
}

impl InverseSecondDerivatives {
    /// Room for the second derivatives of `mechanism`.
    pub fn new(mechanism: &Mechanism) -> Self {
        Self {
            contraction: Contraction::new(mechanism),
        }
    }

    /// The Hessian of `λᵀτ̄(Φ(Q, ϕ), v̄, v̄̇)` at ϕ = 0: a row and a column for each degree of freedom, then for each speed, then for each acceleration.
    /// Symmetric to rounding; in units of λᵀτ̄ over those of both coordinates.
    pub const fn hessian(&self) -> &Sensitivity {
        &self.contraction.hessian
    }

    /// The Hessian times a `direction` (δϕ, δv̄, δv̄̇), into `out` of the same size.
    ///
    /// # Errors
    /// A vector of another size.
    pub fn times(&self, direction: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        self.hessian().times(direction, out)
    }
}

impl Recursive {
    /// Second derivatives of [`Recursive::inverse_dynamics`] in ϕ, v̄ and v̄̇ at (q, v̄, v̄̇), contracted with `weights` λ (one entry per speed), into `out`:
    /// `Σ_i λ_i ∂²τ̄_i`. O(n · depth). Constraints that couple joints exert nothing here, as in inverse dynamics itself.
    ///
    /// # Errors
    /// When a vector has the wrong size, or is not finite; results that were made for another mechanism; an element that does not say how what it exerts
    /// bends.
    pub fn inverse_dynamics_second_derivatives(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        accelerations: &[f64],
        weights: &[f64],
        out: &mut InverseSecondDerivatives,
    ) -> Result<(), DynamicsError> {
        self.check(
            q,
            &[
                ("speeds", speeds),
                ("accelerations", accelerations),
                ("weights", weights),
            ],
        )?;
        self.check_twice_differentiable(&out.contraction.branches)?;
        out.contraction.virtual_speeds.copy_from_slice(weights);
        self.contract((q, speeds, accelerations), None, &mut out.contraction);
        self.check_found((q, speeds), &[&out.contraction.hessian])
    }
}
