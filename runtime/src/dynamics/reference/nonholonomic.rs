//! Theorem 3: dynamics of a mechanism with nonholonomic joints, (34)–(37), in speeds v̄ and momenta p̄.
//!
//! Where every S̄ is the identity, these are the equations of Theorem 2.

use super::actuation::hold;
use super::factor::factor;
use super::holonomic::{combine, fitted, from_columns};
use super::{DynamicsError, Expansion};
use crate::mechanism::{Mechanism, Space};
use nalgebra::{Cholesky, DMatrix, DVector};

/// Matrices and vectors at v̄ and p̄ of as many entries as S̄ has columns, and τ of K; with others they are NaN, or an error where there can be one.
impl Expansion {
    /// Columns of S̄.
    fn columns(&self) -> usize {
        self.speed_basis.ncols()
    }

    /// `M̄ = S̄ᵀ M S̄`, one row per speed.
    pub fn reduced_mass_matrix(&self) -> DMatrix<f64> {
        self.speed_basis
            .tr_mul(&(&self.mass_matrix * &self.speed_basis))
    }

    /// `S̄̇ = Σ_k ∂S̄/∂ϕ_k (S⁻¹S̄v̄)_k`, K×S.
    pub fn speed_basis_rate(&self, speeds: &DVector<f64>) -> DMatrix<f64> {
        let speeds = &*fitted(speeds, self.columns());
        let rate = self.local_rate(&(&self.speed_basis * speeds));
        combine(&self.speed_basis_gradient, &rate)
    }

    /// `C̄ = S̄ᵀ M Σ_i (S⁻¹S̄v̄)_i ∂S̄/∂ϕ_i + S̄ᵀ Ĉ S̄`, S×S, (34).
    pub fn reduced_coriolis_matrix(&self, speeds: &DVector<f64>) -> DMatrix<f64> {
        let speeds = &*fitted(speeds, self.columns());
        let coriolis = self.coriolis_matrix(&(&self.speed_basis * speeds));
        let inner =
            &self.mass_matrix * self.speed_basis_rate(speeds) + coriolis * &self.speed_basis;
        self.speed_basis.tr_mul(&inner)
    }

    /// `S̄ᵀ N̂`, one entry per speed, (34).
    pub fn reduced_potential_forces(&self) -> DVector<f64> {
        self.speed_basis.tr_mul(&self.potential_forces())
    }

    /// v̄̇ of `M̄ v̄̇ + C̄ v̄ + S̄ᵀN̂ = S̄ᵀτ`, (34).
    ///
    /// # Errors
    /// A singular mass matrix; a wrong size.
    pub fn reduced_accelerations(
        &self,
        mechanism: &Mechanism,
        speeds: &DVector<f64>,
        efforts: &DVector<f64>,
    ) -> Result<DVector<f64>, DynamicsError> {
        self.solve_accelerations(mechanism, speeds, efforts, &[])
    }

    /// [`Expansion::reduced_accelerations`] where some v̄̇ are known.
    pub(super) fn solve_accelerations(
        &self,
        mechanism: &Mechanism,
        speeds: &DVector<f64>,
        efforts: &DVector<f64>,
        known: &[(usize, f64)],
    ) -> Result<DVector<f64>, DynamicsError> {
        Self::check("speeds", self.columns(), speeds)?;
        Self::check("efforts", self.freedoms(), efforts)?;
        let mut mass = self.reduced_mass_matrix();
        let mut forces = self.speed_basis.tr_mul(efforts)
            - self.reduced_coriolis_matrix(speeds) * speeds
            - self.reduced_potential_forces();
        hold(&mut mass, &mut forces, known);
        Ok(factor(mechanism, Space::Speeds, mass)?.solve(&forces))
    }

    /// `v̄ = M̄⁻¹ p̄`.
    ///
    /// # Errors
    /// A singular mass matrix; a wrong size.
    pub fn speeds(
        &self,
        mechanism: &Mechanism,
        momenta: &DVector<f64>,
    ) -> Result<DVector<f64>, DynamicsError> {
        self.solve_speeds(mechanism, momenta, &[])
    }

    /// [`Expansion::speeds`] where some v̄ are known.
    pub(super) fn solve_speeds(
        &self,
        mechanism: &Mechanism,
        momenta: &DVector<f64>,
        known: &[(usize, f64)],
    ) -> Result<DVector<f64>, DynamicsError> {
        Self::check("momenta", self.columns(), momenta)?;
        let (mut mass, mut momenta) = (self.reduced_mass_matrix(), momenta.clone());
        hold(&mut mass, &mut momenta, known);
        Ok(factor(mechanism, Space::Speeds, mass)?.solve(&momenta))
    }

    /// `J̄22 = S̄ᵀJ22S̄ + ∂(S̄ᵀp)/∂ϕ S⁻¹S̄ − S̄ᵀS⁻ᵀ ∂ᵀ(S̄ᵀp)/∂ϕ`, S×S, (36), with `p = M S̄ v̄`.
    pub fn reduced_j22(&self, speeds: &DVector<f64>) -> DMatrix<f64> {
        let (basis, speeds) = (&self.speed_basis, &*fitted(speeds, self.columns()));
        let p = &self.mass_matrix * (basis * speeds);
        // (∂(S̄ᵀp)/∂ϕ)_im = Σ_l ∂S̄_li/∂ϕ_m p_l at fixed p.
        let slope = from_columns(speeds.len(), &self.speed_basis_gradient, |slice| {
            slice.tr_mul(&p)
        });
        let turn = slope * &self.velocity_map_inverse * basis;
        basis.tr_mul(&(self.j22(&p) * basis)) + &turn - turn.transpose()
    }

    /// ∂H̄/∂ϕ at fixed p̄, K: `−½ v̄ᵀ ∂M̄/∂ϕ v̄ + ∂V/∂ϕ`, where S̄ inside M̄ varies as well.
    pub fn reduced_hamiltonian_gradient(&self, speeds: &DVector<f64>) -> DVector<f64> {
        let speeds = &*fitted(speeds, self.columns());
        let v = &self.speed_basis * speeds;
        let p = &self.mass_matrix * &v;
        let basis_part = from_columns(v.len(), &self.speed_basis_gradient, |slice| slice * speeds);
        self.hamiltonian_gradient(&v) - basis_part.tr_mul(&p)
    }

    /// `p̄̇ = −S̄ᵀS⁻ᵀ ∂H̄/∂ϕ + J̄22 v̄ + S̄ᵀτ`, (35), for `v̄ = M̄⁻¹ p̄`.
    pub fn reduced_momentum_rate(
        &self,
        speeds: &DVector<f64>,
        efforts: &DVector<f64>,
    ) -> DVector<f64> {
        let speeds = &*fitted(speeds, self.columns());
        let efforts = &*fitted(efforts, self.freedoms());
        let gradient = self.reduced_hamiltonian_gradient(speeds);
        let forces = efforts - self.velocity_map_inverse.tr_mul(&gradient);
        self.reduced_j22(speeds) * speeds + self.speed_basis.tr_mul(&forces)
    }

    /// λ of `AᵀM⁻¹A λ = AᵀS̄̇v̄ + AᵀM⁻¹(ĈS̄v̄ + N̂ − τ)`, one entry a constraint, (37).
    ///
    /// With it `M v̇ + Ĉv + N̂ = τ + Aλ`.
    ///
    /// # Errors
    /// A singular mass matrix; dependent constraints; a wrong size.
    pub fn constraint_force(
        &self,
        mechanism: &Mechanism,
        speeds: &DVector<f64>,
        efforts: &DVector<f64>,
    ) -> Result<DVector<f64>, DynamicsError> {
        Self::check("speeds", self.columns(), speeds)?;
        Self::check("efforts", self.freedoms(), efforts)?;
        let mass = factor(mechanism, Space::Freedoms, self.mass_matrix.clone())?;
        let v = &self.speed_basis * speeds;
        let forces = self.coriolis_matrix(&v) * &v + self.potential_forces() - efforts;
        let violation = self.speed_basis_rate(speeds) * speeds + mass.solve(&forces);
        let resistance = self.constraint.tr_mul(&mass.solve(&self.constraint));
        let factors = Cholesky::new(resistance).ok_or(DynamicsError::DependentConstraints)?;
        Ok(factors.solve(&self.constraint.tr_mul(&violation)))
    }
}
