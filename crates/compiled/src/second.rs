//! Second derivatives by the functions of a module, or by the tree.

use super::tree::Compiled;
use hamel_runtime::dynamics::{
    Dynamics, DynamicsError, ForwardSecondDerivatives, InverseSecondDerivatives,
};
use hamel_runtime::mechanism::{Space, WHOLE, check_size};
use hamel_runtime::scalar::all_finite;

impl Compiled {
    /// `Σ_i λ_i ∂²v̄̇_i` with `weights` λ at (q, v̄, τ) into `hessian`, by rows over (ϕ, v̄, τ), as
    /// [`Recursive::forward_dynamics_second_derivatives`](hamel_runtime::dynamics::Recursive::forward_dynamics_second_derivatives) has it. Allocates where the
    /// module has no such function.
    ///
    /// # Errors
    /// A wrong size; what the tree refuses: constraints that couple joints, an element that does not say how what it exerts bends.
    pub fn forward_dynamics_second_derivatives(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        weights: &[f64],
        hessian: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let size = 2 * self.functions.freedoms + self.functions.speeds;
        check_size(WHOLE, "entries of the Hessian", size * size, hessian.len())?;
        let forward = self.functions.forward_dynamics_second_derivatives.as_ref();
        if let Some(forward) = forward.filter(|_| !self.timed.are_there) {
            self.check(q, [("speeds", speeds), ("weights", weights)])?;
            let mechanism = self.tree.mechanism();
            mechanism.check_vector("efforts", Space::Freedoms, efforts)?;
            forward(q, speeds, efforts, weights, hessian);
            if all_finite(hessian) {
                return Ok(());
            }
        }
        let mut found = ForwardSecondDerivatives::new(self.tree.mechanism());
        self.tree
            .forward_dynamics_second_derivatives(q, speeds, efforts, weights, &mut found)?;
        hessian.copy_from_slice(found.hessian().entries());
        Ok(())
    }

    /// `Σ_i λ_i ∂²τ̄_i` of inverse dynamics with `weights` λ at (q, v̄, v̄̇) into `hessian`, by rows over (ϕ, v̄, v̄̇), as
    /// [`Recursive::inverse_dynamics_second_derivatives`](hamel_runtime::dynamics::Recursive::inverse_dynamics_second_derivatives) has it. Allocates where the
    /// module has no such function.
    ///
    /// # Errors
    /// A wrong size; an element that does not say how what it exerts bends.
    pub fn inverse_dynamics_second_derivatives(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        accelerations: &[f64],
        weights: &[f64],
        hessian: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let size = self.functions.freedoms + 2 * self.functions.speeds;
        check_size(WHOLE, "entries of the Hessian", size * size, hessian.len())?;
        let inverse = self.functions.inverse_dynamics_second_derivatives.as_ref();
        if let Some(inverse) = inverse.filter(|_| !self.timed.are_there) {
            let vectors = [
                ("speeds", speeds),
                ("accelerations", accelerations),
                ("weights", weights),
            ];
            self.check(q, vectors)?;
            inverse(q, speeds, accelerations, weights, hessian);
            if all_finite(hessian) {
                return Ok(());
            }
        }
        let mut found = InverseSecondDerivatives::new(self.tree.mechanism());
        self.tree.inverse_dynamics_second_derivatives(
            q,
            speeds,
            accelerations,
            weights,
            &mut found,
        )?;
        hessian.copy_from_slice(found.hessian().entries());
        Ok(())
    }
}
