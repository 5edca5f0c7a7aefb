//! One joint's ϕ̇ around a base point, and how it changes with the base point, with ϕ and with the speeds.
//!
//! An integrator's stage stands at `Q′ = Φ(Q_b, ϕ)` and moves by `ϕ̇ = S(Q_b, ϕ)⁻¹ S̄(Q′) v̄`. When its step starts elsewhere, at
//! `Q_b = Φ(Q₀, δ)`, and its ϕ is another, Q′ moves by `T δ + D δϕ` in local coordinates about itself, and ϕ̇ changes with all of δ, ϕ and v̄.
//! Φ is differentiated twice on the way; that is left to dual numbers through the joint's own kernels, so that it is exact for every Φ,
//! those that are inverted by Newton's method included.

use super::directions::{along, columns, constant, derivative};
use crate::erased::Store;
use crate::finite::least_squares;
use crate::joint::{Joint, Structure};
use crate::matrix::{column, identity, product, set_column, zeros};
use crate::scalar::{Dual, Scalar};
use nalgebra::{SMatrix, SVector};

/// What [`AnyJoint::differentiate`](crate::erased::AnyJoint::differentiate) fills in; matrices column by column.
#[derive(Debug)]
pub struct ChartDerivatives<'a, T = f64> {
    /// T, K×K: δ at the base point to local coordinates at Q′, ϕ held.
    pub carried: &'a mut [T],
    /// D, K×K: a change of ϕ to local coordinates at Q′, [`Joint::retract_differential`].
    pub moved: &'a mut [T],
    /// `∂ϕ̇/∂δ`, K×K.
    pub rate_by_base: &'a mut [T],
    /// `∂ϕ̇/∂ϕ`, K×K.
    pub rate_by_phi: &'a mut [T],
    /// `∂ϕ̇/∂v̄`, K×S.
    pub rate_by_speeds: &'a mut [T],
}

/// A joint where its field is evaluated.
pub(crate) struct Field<'a, T, J, const N: usize, const K: usize, const S: usize, const C: usize> {
    pub(crate) joint: &'a J,
    pub(crate) base: SVector<T, N>,
    pub(crate) phi: SVector<T, K>,
    pub(crate) speeds: SVector<T, S>,
}

impl<T, J, const N: usize, const K: usize, const S: usize, const C: usize>
    Field<'_, T, J, N, K, S, C>
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    /// Evaluates it.
    pub(crate) fn fill(&self, out: &mut ChartDerivatives<'_, T>) {
        let there = self.joint.retract(&self.base, &self.phi);
        let one = identity::<T, K, K>();
        let (mut carried, mut moved) = (one, one);
        let (mut by_base, mut by_phi) = (zeros::<T, K, K>(), zeros());
        if const { Self::is_flat() } {
            if const { Self::varies() } {
                by_phi = columns(|k| derivative(&self.local_rate(&self.pushed(&there, k))));
                by_base = by_phi;
            }
        } else {
            let tangent: SMatrix<T, N, K> = columns(|k| derivative(&self.pushed(&there, k)));
            let (base, phi) = (constant(&self.base), constant(&self.phi));
            let dragged: SMatrix<T, N, K> = columns(|k| {
                let base = self.pushed(&self.base, k);
                let (q, rate) = self.rate(&base, &phi);
                set_column(&mut by_base, k, &derivative(&rate));
                derivative(&q)
            });
            carried = least_squares(&tangent, &dragged);
            moved = self.joint.retract_differential(&self.base, &self.phi);
            by_phi = columns(|k| derivative(&self.rate(&base, &(phi + along(k))).1));
        }
        carried.store(out.carried);
        moved.store(out.moved);
        by_base.store(out.rate_by_base);
        by_phi.store(out.rate_by_phi);
        self.by_speeds(&there).store(out.rate_by_speeds);
    }

    /// Whether the differential of Φ is the identity.
    const fn is_flat() -> bool {
        J::STRUCTURES.retract_differential.is_identity()
    }

    /// Whether `S₀⁻¹ S̄` depends on Q.
    const fn varies() -> bool {
        matches!(J::STRUCTURES.velocity_map, Structure::General)
            || matches!(J::STRUCTURES.speed_basis, Structure::General)
    }

    /// Φ(q, ε e_k).
    fn pushed(&self, q: &SVector<T, N>, k: usize) -> SVector<Dual<T>, N> {
        self.joint.retract(&constant(q), &along(k))
    }

    /// `S₀⁻¹ S̄ v̄` at `q`.
    fn local_rate(&self, q: &SVector<Dual<T>, N>) -> SVector<Dual<T>, K> {
        let velocity = product(&self.joint.speed_basis(q), &constant(&self.speeds));
        match const { J::STRUCTURES.velocity_map.is_identity() } {
            true => velocity,
            false => product(&self.joint.velocity_map_inverse(q), &velocity),
        }
    }

    /// Q′ and ϕ̇.
    fn rate(
        &self,
        base: &SVector<Dual<T>, N>,
        phi: &SVector<Dual<T>, K>,
    ) -> (SVector<Dual<T>, N>, SVector<Dual<T>, K>) {
        let there = self.joint.retract(base, phi);
        let rate = self.local_rate(&there);
        let rate = self.joint.retract_differential_inverse(base, phi, &rate);
        (there, rate)
    }

    /// `S⁻¹ S̄` at Q′.
    fn by_speeds(&self, there: &SVector<T, N>) -> SMatrix<T, K, S> {
        let mut map = self.joint.speed_basis(there);
        if const { !J::STRUCTURES.velocity_map.is_identity() } {
            map = product(&self.joint.velocity_map_inverse(there), &map);
        }
        if const { !Self::is_flat() } {
            for j in 0..S {
                let rate = column(&map, j);
                let own = self
                    .joint
                    .retract_differential_inverse(&self.base, &self.phi, &rate);
                set_column(&mut map, j, &own);
            }
        }
        map
    }
}
