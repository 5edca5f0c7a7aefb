//! Theorem 1: the Boltzmann–Hamel equations of a system in quasi-coordinates, (16)–(19).
//!
//! A system has coordinates q and velocities `v = S(q) q̇`. Its author gives S, M and V once, generic in the scalar; their
//! derivatives are taken by dual numbers. Sums are written out as in the paper: this is for teaching and for tests.

use crate::scalar::{Dual, Scalar};
use core::array;
use nalgebra::{Cholesky, SMatrix, SVector};

/// A system in `N` quasi-coordinates.
pub trait QuasiSystem<const N: usize> {
    /// S(q), N×N and invertible: q̇ to v.
    fn velocity_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, N, N>;

    /// M(q), N×N and symmetric positive: kinetic co-energy `½ vᵀ M v`.
    fn mass_matrix<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, N, N>;

    /// V(q).
    fn potential<T: Scalar>(&self, q: &SVector<T, N>) -> T;
}

/// Why Theorem 1 does not apply at a point.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum QuasiError {
    /// S(q) has no inverse.
    #[error("the velocity map S(q) is singular at this q")]
    SingularVelocityMap,
    /// M(q) is not positive.
    #[error("the mass matrix M(q) is not positive definite at this q")]
    SingularMass,
}

/// S, M and V of a system at one q, with their derivatives: slice k is ∂/∂q_k.
#[derive(Clone, Debug)]
pub struct QuasiTerms<const N: usize> {
    /// S.
    pub velocity_map: SMatrix<f64, N, N>,
    /// S⁻¹.
    pub velocity_map_inverse: SMatrix<f64, N, N>,
    /// ∂S/∂q.
    pub velocity_map_gradient: [SMatrix<f64, N, N>; N],
    /// M.
    pub mass_matrix: SMatrix<f64, N, N>,
    /// ∂M/∂q.
    pub mass_matrix_gradient: [SMatrix<f64, N, N>; N],
    /// V.
    pub potential: f64,
    /// ∂V/∂q.
    pub potential_gradient: SVector<f64, N>,
}

impl<const N: usize> QuasiTerms<N> {
    /// The terms of `system` at `q`.
    ///
    /// # Errors
    /// When S(q) is singular.
    pub fn new(system: &impl QuasiSystem<N>, q: &SVector<f64, N>) -> Result<Self, QuasiError> {
        let velocity_map = system.velocity_map(q);
        let along = |k: usize| {
            SVector::<Dual<f64>, N>::from_fn(|i, _| {
                if i == k {
                    Dual::variable(q[i])
                } else {
                    Dual::constant(q[i])
                }
            })
        };
        Ok(Self {
            velocity_map,
            velocity_map_inverse: velocity_map
                .try_inverse()
                .ok_or(QuasiError::SingularVelocityMap)?,
            velocity_map_gradient: array::from_fn(|k| {
                system
                    .velocity_map(&along(k))
                    .map(|entry| entry.derivative())
            }),
            mass_matrix: system.mass_matrix(q),
            mass_matrix_gradient: array::from_fn(|k| {
                system
                    .mass_matrix(&along(k))
                    .map(|entry| entry.derivative())
            }),
            potential: system.potential(q),
            potential_gradient: SVector::from_fn(|k, _| system.potential(&along(k)).derivative()),
        })
    }

    /// `q̇ = S⁻¹ v`.
    pub fn coordinate_rate(&self, v: &SVector<f64, N>) -> SVector<f64, N> {
        self.velocity_map_inverse * v
    }

    /// γ, (17); `gamma()[k]` is γ_k. It vanishes where v is the rate of some coordinates.
    ///
    /// ```text
    /// (γ_k)_ij = Σ_{l,m} S⁻¹_li S⁻¹_mk ( ∂S_jl/∂q_m − ∂S_jm/∂q_l )
    /// ```
    pub fn gamma(&self) -> [SMatrix<f64, N, N>; N] {
        let inverse = &self.velocity_map_inverse;
        let slope = |j: usize, l: usize, m: usize| self.velocity_map_gradient[m][(j, l)];
        array::from_fn(|k| {
            SMatrix::from_fn(|i, j| {
                pairs::<N>()
                    .map(|(l, m)| {
                        inverse[(l, i)] * inverse[(m, k)] * (slope(j, l, m) - slope(j, m, l))
                    })
                    .sum()
            })
        })
    }

    /// v̇ of (16): `d/dt ∂L/∂v + Σ_k γ_k v_k ∂L/∂v − S⁻ᵀ ∂L/∂q = τ`.
    ///
    /// # Errors
    /// When M is not positive definite.
    pub fn accelerations(
        &self,
        v: &SVector<f64, N>,
        efforts: &SVector<f64, N>,
    ) -> Result<SVector<f64, N>, QuasiError> {
        let rate = self.coordinate_rate(v);
        let momentum = self.mass_matrix * v;
        let mass_rate = weighted_sum(&self.mass_matrix_gradient, &rate);
        let gamma = weighted_sum(&self.gamma(), v);
        let slope = self
            .velocity_map_inverse
            .tr_mul(&self.lagrangian_gradient(v));
        let forces = efforts - mass_rate * v - gamma * momentum + slope;
        Ok(self.factors()?.solve(&forces))
    }

    /// J22, (19): `S⁻ᵀ ( ∂ᵀ(Sᵀp)/∂q − ∂(Sᵀp)/∂q ) S⁻¹`. It vanishes with γ: `Σ_k γ_k v_k p = −J22 v`.
    pub fn j22(&self, p: &SVector<f64, N>) -> SMatrix<f64, N, N> {
        // (∂(Sᵀp)/∂q)_im = Σ_l ∂S_li/∂q_m p_l
        let slope: SMatrix<f64, N, N> = SMatrix::from_fn(|i, m| {
            (0..N)
                .map(|l| self.velocity_map_gradient[m][(l, i)] * p[l])
                .sum()
        });
        let inverse = &self.velocity_map_inverse;
        inverse.transpose() * (slope.transpose() - slope) * inverse
    }

    /// `v = M⁻¹ p`, and (q̇, ṗ) of (18): `q̇ = S⁻¹ v`, `ṗ = −S⁻ᵀ ∂H/∂q + J22 v + τ`.
    ///
    /// # Errors
    /// When M is not positive definite.
    pub fn hamiltonian_rates(
        &self,
        p: &SVector<f64, N>,
        efforts: &SVector<f64, N>,
    ) -> Result<(SVector<f64, N>, SVector<f64, N>), QuasiError> {
        let v = self.factors()?.solve(p);
        // ∂H/∂q at fixed p is −∂L/∂q at fixed v.
        let slope = self
            .velocity_map_inverse
            .tr_mul(&self.lagrangian_gradient(&v));
        Ok((self.coordinate_rate(&v), self.j22(p) * v + slope + efforts))
    }

    /// ∂L/∂q at fixed v: `½ vᵀ ∂M/∂q_k v − ∂V/∂q_k`.
    fn lagrangian_gradient(&self, v: &SVector<f64, N>) -> SVector<f64, N> {
        SVector::from_fn(|k, _| {
            0.5 * v.dot(&(self.mass_matrix_gradient[k] * v)) - self.potential_gradient[k]
        })
    }

    fn factors(&self) -> Result<Cholesky<f64, nalgebra::Const<N>>, QuasiError> {
        Cholesky::new(self.mass_matrix).ok_or(QuasiError::SingularMass)
    }
}

fn pairs<const N: usize>() -> impl Iterator<Item = (usize, usize)> {
    (0..N).flat_map(|l| (0..N).map(move |m| (l, m)))
}

fn weighted_sum<const N: usize>(
    slices: &[SMatrix<f64, N, N>; N],
    weights: &SVector<f64, N>,
) -> SMatrix<f64, N, N> {
    slices
        .iter()
        .zip(weights)
        .fold(SMatrix::zeros(), |sum, (slice, &weight)| {
            sum + slice * weight
        })
}
