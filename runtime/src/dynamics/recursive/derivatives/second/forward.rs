//! Second derivatives of forward dynamics.

use super::super::{Branch, ForwardDerivatives};
use super::contraction::Contraction;
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::dynamics::{DynamicsError, Sensitivity};
use crate::mechanism::Mechanism;
use alloc::vec;
use alloc::vec::Vec;

/// `λᵀ∂²v̄̇` of forward dynamics, over (ϕ, v̄, τ), with the first derivatives and v̄̇ itself.
#[derive(Clone, Debug)]
pub struct ForwardSecondDerivatives {
    first: ForwardDerivatives,
    hessian: Sensitivity,
    contraction: Contraction,
    /// λ without the entries of driven joints.
    weights: Vec<f64>,
    /// v̄̇_x, a column a coordinate, speed or effort.
    responses: Sensitivity,
    /// By ϕ and v̄̇.
    by_accelerations: Sensitivity,
    /// Their product.
    products: Sensitivity,
}

impl ForwardSecondDerivatives {
    /// Room for the second derivatives of `mechanism`.
    pub fn new(mechanism: &Mechanism) -> Self {
        let (speeds, freedoms) = (mechanism.layout().speeds, mechanism.layout().freedoms);
        let size = 2 * freedoms + speeds;
        Self {
            first: ForwardDerivatives::new(mechanism),
            hessian: Sensitivity::new(size, size),
            contraction: Contraction::new(mechanism),
            weights: vec![0.0; speeds],
            responses: Sensitivity::new(speeds, size),
            by_accelerations: Sensitivity::new(freedoms, speeds),
            products: Sensitivity::new(freedoms, size),
        }
    }

    /// v̄̇ and its first derivatives at the same state.
    pub const fn first(&self) -> &ForwardDerivatives {
        &self.first
    }

    /// The Hessian of `λᵀv̄̇(Φ(Q, ϕ), v̄, τ)` at ϕ = 0: a row and a column for each degree of freedom, then for each speed, then for each effort.
    /// Symmetric to rounding; in units of λᵀv̄̇ over those of both coordinates.
    pub const fn hessian(&self) -> &Sensitivity {
        &self.hessian
    }

    /// The Hessian times a `direction` (δϕ, δv̄, δτ), into `out` of the same size.
    ///
    /// # Errors
    /// A vector of another size.
    pub fn times(&self, direction: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        self.hessian.times(direction, out)
    }

    fn branches(&self) -> &[Branch] {
        &self.contraction.branches
    }

    /// `−(H_xx + H_xa v̄̇_x + v̄̇_xᵀ H_ax)`, except for the entries by ϕ and τ of H_xx.
    fn combine(&mut self) {
        let first = &self.first;
        let parts = [first.by_local(), first.by_speeds(), first.by_efforts()];
        for row in 0..self.responses.rows() {
            let mut rest = self.responses.row_mut(row);
            for part in parts {
                let (own, after) = rest.split_at_mut(part.columns());
                own.copy_from_slice(part.row(row));
                rest = after;
            }
        }
        let (known, bent) = (&self.contraction.hessian, &mut self.by_accelerations);
        let state = parts[0].columns() + parts[1].columns();
        for k in 0..bent.rows() {
            bent.row_mut(k).copy_from_slice(&known.row(k)[state..]);
        }
        self.products.clear();
        self.products
            .add_product(&self.by_accelerations, &self.responses);
        self.hessian.clear();
        for row in 0..state {
            for column in 0..state {
                self.hessian.set(row, column, -known.entry(row, column));
            }
        }
        for k in 0..self.products.rows() {
            for x in 0..self.products.columns() {
                let entry = self.products.entry(k, x);
                self.hessian.add(k, x, -entry);
                self.hessian.add(x, k, -entry);
            }
        }
    }
}

impl Recursive {
    /// Second derivatives of v̄̇ at (q, v̄, τ) in ϕ, v̄ and τ, contracted with `weights` λ (one entry per speed), into `out`: `Σ_i λ_i ∂²v̄̇_i`; with them v̄̇ and the
    /// first derivatives. The first efforts of a driven joint are its accelerations, as in [`Recursive::forward_dynamics_derivatives`]. O(n · depth) beyond
    /// the first derivatives, except for one product of matrices, O(n³).
    ///
    /// # Errors
    /// What [`Recursive::forward_dynamics_derivatives`] refuses; weights of the wrong size or not finite; an element that does not say how what it exerts
    /// bends; constraints that couple joints.
    pub fn forward_dynamics_second_derivatives(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        weights: &[f64],
        out: &mut ForwardSecondDerivatives,
    ) -> Result<(), DynamicsError> {
        self.check(q, &[("speeds", speeds), ("weights", weights)])?;
        self.check_twice_differentiable(out.branches())?;
        if let Some(constraint) = self.mechanism.constraints().first() {
            return Err(DynamicsError::NotTwiceDifferentiable {
                what: "forward dynamics under a constraint that couples joints",
                name: constraint.name.clone(),
            });
        }
        self.forward_dynamics_derivatives(q, speeds, efforts, &mut out.first)?;
        out.weights.copy_from_slice(weights);
        for link in self.links.iter().filter(|link| link.driven) {
            out.weights[link.speeds.clone()].fill(0.0);
        }
        self.solve_speeds(q, &out.weights, &mut out.contraction.virtual_speeds)?;
        let state = (q, speeds, out.first.rates());
        self.contract(state, Some(efforts), &mut out.contraction);
        out.combine();
        for index in 0..self.links.len() {
            self.add_input_pairs(index, q, out);
        }
        self.check_found((q, speeds), &[&out.hessian])
    }

    /// `μᵀ ∂S̄_kᵀ`: by ϕ_k and τ.
    fn add_input_pairs(&self, index: usize, q: &[f64], out: &mut ForwardSecondDerivatives) {
        let link = &self.links[index];
        if !link.leads || link.joint.structures().speed_basis_gradient.is_zero() {
            return;
        }
        let (rows, columns) = (link.freedoms.len(), link.speeds.len());
        let mut slices = [0.0; MOST_FREEDOMS * MOST_FREEDOMS * MOST_FREEDOMS];
        let slices = &mut slices[..rows * rows * columns];
        let q = &q[link.configuration.clone()];
        link.joint.speed_basis_gradient(q, slices);
        let virtual_speeds = &out.contraction.virtual_speeds[link.speeds.clone()];
        let first = out.first.by_local().columns() + out.first.by_speeds().columns();
        for (k, slice) in link
            .freedoms
            .clone()
            .zip(slices.chunks_exact((rows * columns).max(1)))
        {
            for (column, weight) in slice.chunks_exact(rows.max(1)).zip(virtual_speeds) {
                for (effort, entry) in link.freedoms.clone().zip(column) {
                    out.hessian.add(k, first + effort, weight * entry);
                    out.hessian.add(first + effort, k, weight * entry);
                }
            }
        }
    }
}
