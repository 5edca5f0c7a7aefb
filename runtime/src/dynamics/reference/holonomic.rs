//! Theorem 2: dynamics of a mechanism with holonomic joints, (24)–(28).
//!
//! The same matrices serve nonholonomic joints before their reduction, with v in place of v̄.

use super::factor::factor;
use super::{DynamicsError, Expansion};
use crate::mechanism::{Mechanism, Space, StateError, WHOLE, check_size};
use alloc::borrow::Cow;
use nalgebra::{DMatrix, DVector};

/// The vector itself; NaN in its place where it has not so many entries.
pub(super) fn fitted(vector: &DVector<f64>, size: usize) -> Cow<'_, DVector<f64>> {
    match vector.len() == size {
        true => Cow::Borrowed(vector),
        false => Cow::Owned(DVector::from_element(size, f64::NAN)),
    }
}

/// Matrices and vectors at v, p and τ of K entries each; with other vectors they are NaN, or an error where there can be one.
impl Expansion {
    /// K.
    pub(super) fn freedoms(&self) -> usize {
        self.velocity_map.nrows()
    }

    /// Whether `values` are so many.
    pub(super) fn check(
        quantity: &'static str,
        size: usize,
        values: &DVector<f64>,
    ) -> Result<(), StateError> {
        check_size(WHOLE, quantity, size, values.len())
    }

    /// `ϕ̇ = S⁻¹ v`, K.
    pub fn local_rate(&self, v: &DVector<f64>) -> DVector<f64> {
        &self.velocity_map_inverse * &*fitted(v, self.freedoms())
    }

    /// `Ṁ = Σ_k ∂M/∂ϕ_k ϕ̇_k`, K×K.
    pub fn mass_matrix_rate(&self, v: &DVector<f64>) -> DMatrix<f64> {
        combine(&self.mass_matrix_gradient, &self.local_rate(v))
    }

    /// `N̂ = S⁻ᵀ ∂V/∂ϕ`, K, (25).
    pub fn potential_forces(&self) -> DVector<f64> {
        self.velocity_map_inverse.tr_mul(&self.potential_gradient)
    }

    /// Ĉ, K×K, (26) with its index pattern set right:
    ///
    /// ```text
    /// Ĉ_ij = Σ_{k,l} ( ∂M_ij/∂ϕ_k S⁻¹_kl − ½ S⁻¹_ki ∂M_jl/∂ϕ_k ) v_l
    ///      + Σ_{k,l,m,s} S⁻¹_mi ( ∂S_km/∂ϕ_s − ∂S_ks/∂ϕ_m ) S⁻¹_sj M_kl v_l
    /// ```
    pub fn coriolis_matrix(&self, v: &DVector<f64>) -> DMatrix<f64> {
        let v = &*fitted(v, self.freedoms());
        let inverse = &self.velocity_map_inverse;
        let momentum = &self.mass_matrix * v;
        // Row k holds Σ_l ∂M_jl/∂ϕ_k v_l.
        let slopes = self.momentum_slopes(v);
        let curl = self.velocity_map_curl(&momentum);
        self.mass_matrix_rate(v) - inverse.tr_mul(&slopes) * 0.5 + inverse.tr_mul(&curl) * inverse
    }

    /// Ĉ′ = ½Ṁ + ½(B − Bᵀ) − J22 with `B_ij = Σ_{k,l} ∂M_il/∂ϕ_k S⁻¹_kj v_l`, K×K.
    ///
    /// `Ĉ′ v = Ĉ v`, and Ṁ − 2Ĉ′ is skew, which Ĉ of (26) lacks: controllers with a passivity argument need this one.
    pub fn coriolis_matrix_skew(&self, v: &DVector<f64>) -> DMatrix<f64> {
        let v = &*fitted(v, self.freedoms());
        let b = self.momentum_slopes(v).transpose() * &self.velocity_map_inverse;
        let skew = &b - b.transpose();
        (self.mass_matrix_rate(v) + skew) * 0.5 - self.j22(&(&self.mass_matrix * v))
    }

    /// J22 = S⁻ᵀ ( ∂ᵀ(Sᵀp)/∂ϕ − ∂(Sᵀp)/∂ϕ ) S⁻¹, K×K, (28).
    pub fn j22(&self, p: &DVector<f64>) -> DMatrix<f64> {
        let slope = self.momentum_map_gradient(&fitted(p, self.freedoms()));
        let inverse = &self.velocity_map_inverse;
        inverse.tr_mul(&(slope.transpose() - slope)) * inverse
    }

    /// v̇ of `M v̇ + Ĉ v + N̂ = τ`, K, (24).
    ///
    /// # Errors
    /// A singular mass matrix; a wrong size.
    pub fn accelerations(
        &self,
        mechanism: &Mechanism,
        v: &DVector<f64>,
        efforts: &DVector<f64>,
    ) -> Result<DVector<f64>, DynamicsError> {
        Self::check("velocity", self.freedoms(), v)?;
        Self::check("efforts", self.freedoms(), efforts)?;
        let factors = factor(mechanism, Space::Freedoms, self.mass_matrix.clone())?;
        let forces = efforts - self.coriolis_matrix(v) * v - self.potential_forces();
        Ok(factors.solve(&forces))
    }

    /// ∂H/∂ϕ at fixed p, K: `−½ vᵀ ∂M/∂ϕ v + ∂V/∂ϕ` with `v = M⁻¹ p`.
    pub fn hamiltonian_gradient(&self, v: &DVector<f64>) -> DVector<f64> {
        let v = &*fitted(v, self.freedoms());
        &self.potential_gradient - self.momentum_slopes(v) * v * 0.5
    }

    /// `ṗ = −S⁻ᵀ ∂H/∂ϕ + J22 v + τ`, K, (27), for `v = M⁻¹ p`.
    pub fn momentum_rate(&self, v: &DVector<f64>, efforts: &DVector<f64>) -> DVector<f64> {
        let (v, efforts) = (
            &*fitted(v, self.freedoms()),
            &*fitted(efforts, self.freedoms()),
        );
        let p = &self.mass_matrix * v;
        let gradient = self.hamiltonian_gradient(v);
        self.j22(&p) * v + efforts - self.velocity_map_inverse.tr_mul(&gradient)
    }

    /// `(∂(Sᵀp)/∂ϕ)_im = Σ_l ∂S_li/∂ϕ_m p_l`, K×K: column m is ∂Sᵀ/∂ϕ_m p.
    fn momentum_map_gradient(&self, p: &DVector<f64>) -> DMatrix<f64> {
        from_columns(p.len(), &self.velocity_map_gradient, |slope| {
            slope.tr_mul(p)
        })
    }

    /// `Σ_k ( ∂S_km/∂ϕ_s − ∂S_ks/∂ϕ_m ) p_k`, row m, column s.
    fn velocity_map_curl(&self, p: &DVector<f64>) -> DMatrix<f64> {
        let slope = self.momentum_map_gradient(p);
        &slope - slope.transpose()
    }

    /// Row k is `(∂M/∂ϕ_k v)ᵀ`, K×K.
    pub(super) fn momentum_slopes(&self, v: &DVector<f64>) -> DMatrix<f64> {
        from_columns(v.len(), &self.mass_matrix_gradient, |slope| slope * v).transpose()
    }
}

/// `Σ_k slices_k weights_k`; the sum needs one slice at least to know its shape, and is 0×0 without.
pub(super) fn combine(slices: &[DMatrix<f64>], weights: &DVector<f64>) -> DMatrix<f64> {
    let (rows, columns) = slices.first().map_or((0, 0), DMatrix::shape);
    slices
        .iter()
        .zip(weights)
        .fold(DMatrix::zeros(rows, columns), |sum, (slice, &weight)| {
            sum + slice * weight
        })
}

/// The matrix whose column m is `column(slices_m)`.
pub(super) fn from_columns(
    rows: usize,
    slices: &[DMatrix<f64>],
    column: impl Fn(&DMatrix<f64>) -> DVector<f64>,
) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(rows, slices.len());
    for (m, slice) in slices.iter().enumerate() {
        matrix.set_column(m, &column(slice));
    }
    matrix
}
