//! One joint's ϕ̇ around a base point, and how it changes with the base point, with ϕ and with the speeds.
//!
//! An integrator's stage stands at `Q′ = Φ(Q_b, ϕ)` and moves by `ϕ̇ = S(Q_b, ϕ)⁻¹ S̄(Q′) v̄`. When its step starts elsewhere, at
//! `Q_b = Φ(Q₀, δ)`, and its ϕ is another, Q′ moves by `T δ + D δϕ` in local coordinates about itself, and ϕ̇ changes with all of δ, ϕ and v̄.
//! Φ is differentiated twice on the way; that is left to dual numbers through the joint's own kernels, so that it is exact for every Φ,
//! those that are inverted by Newton's method included.

use crate::erased::{Sizes, vector};
use crate::finite::least_squares;
use crate::joint::Joint;
use crate::scalar::Dual;
use nalgebra::{SMatrix, SVector};

type D = Dual<f64>;

/// What [`Chart::differentiate`] fills in; matrices column by column.
#[derive(Debug)]
pub struct ChartDerivatives<'a> {
    /// T, K×K: δ at the base point to local coordinates at Q′, ϕ held.
    pub carried: &'a mut [f64],
    /// D, K×K: a change of ϕ to local coordinates at Q′, [`Joint::retract_differential`].
    pub moved: &'a mut [f64],
    /// `∂ϕ̇/∂δ`, K×K.
    pub rate_by_base: &'a mut [f64],
    /// `∂ϕ̇/∂ϕ`, K×K.
    pub rate_by_phi: &'a mut [f64],
    /// `∂ϕ̇/∂v̄`, K×S.
    pub rate_by_speeds: &'a mut [f64],
}

/// The vector field of one joint in a chart; slices have the joint's own sizes.
pub trait Chart {
    /// The derivatives of Q′ and ϕ̇ at base point `base`, ϕ = `phi` and v̄ = `speeds`.
    fn differentiate(
        &self,
        base: &[f64],
        phi: &[f64],
        speeds: &[f64],
        out: &mut ChartDerivatives<'_>,
    );
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Chart
    for (J, Sizes<N, K, S, C>)
where
    J: Joint<N, K, S, C>,
{
    fn differentiate(
        &self,
        base: &[f64],
        phi: &[f64],
        speeds: &[f64],
        out: &mut ChartDerivatives<'_>,
    ) {
        let field = Field::<J, N, K, S, C> {
            joint: &self.0,
            base: vector(base),
            phi: vector(phi),
            speeds: vector(speeds),
        };
        field.fill(out);
    }
}

/// A joint where its field is evaluated.
struct Field<'a, J, const N: usize, const K: usize, const S: usize, const C: usize> {
    joint: &'a J,
    base: SVector<f64, N>,
    phi: SVector<f64, K>,
    speeds: SVector<f64, S>,
}

fn lift<const R: usize>(vector: &SVector<f64, R>) -> SVector<D, R> {
    vector.map(Dual::constant)
}

/// The infinitesimal along axis `k`.
fn along<const K: usize>(k: usize) -> SVector<D, K> {
    SVector::from_fn(|i, _| Dual::new(0.0, f64::from(u8::from(i == k))))
}

fn derivative<const R: usize>(vector: &SVector<D, R>) -> SVector<f64, R> {
    vector.map(|entry| entry.derivative)
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Field<'_, J, N, K, S, C>
where
    J: Joint<N, K, S, C>,
{
    fn fill(&self, out: &mut ChartDerivatives<'_>) {
        let there = self.joint.retract(&self.base, &self.phi);
        let flat = J::STRUCTURES.retract_differential.is_identity();
        let one = SMatrix::<f64, K, K>::identity();
        let (mut carried, mut moved) = (one, one);
        let (mut by_base, mut by_phi) = (SMatrix::<f64, K, K>::zeros(), SMatrix::zeros());
        if flat {
            if self.varies() {
                by_phi = columns(|k| derivative(&self.local_rate(&self.pushed(&there, k))));
                by_base = by_phi;
            }
        } else {
            let tangent: SMatrix<f64, N, K> = columns(|k| derivative(&self.pushed(&there, k)));
            let (base, phi) = (lift(&self.base), lift(&self.phi));
            let dragged: [_; K] = core::array::from_fn(|k| {
                let base = self.pushed(&self.base, k);
                let (q, rate) = self.rate(&base, &phi);
                by_base.set_column(k, &derivative(&rate));
                derivative(&q)
            });
            carried = least_squares(&tangent, &SMatrix::from_columns(&dragged));
            moved = self.joint.retract_differential(&self.base, &self.phi);
            by_phi = columns(|k| derivative(&self.rate(&base, &(phi + along(k))).1));
        }
        out.carried.copy_from_slice(carried.as_slice());
        out.moved.copy_from_slice(moved.as_slice());
        out.rate_by_base.copy_from_slice(by_base.as_slice());
        out.rate_by_phi.copy_from_slice(by_phi.as_slice());
        out.rate_by_speeds
            .copy_from_slice(self.by_speeds(&there, flat).as_slice());
    }

    /// Whether `S₀⁻¹ S̄` depends on Q.
    fn varies(&self) -> bool {
        use crate::joint::Structure::General;
        let structures = &J::STRUCTURES;
        matches!(structures.velocity_map, General) || matches!(structures.speed_basis, General)
    }

    /// Φ(q, ε e_k).
    fn pushed(&self, q: &SVector<f64, N>, k: usize) -> SVector<D, N> {
        self.joint.retract(&lift(q), &along(k))
    }

    /// `S₀⁻¹ S̄ v̄` at `q`.
    fn local_rate(&self, q: &SVector<D, N>) -> SVector<D, K> {
        let velocity = self.joint.speed_basis(q) * lift(&self.speeds);
        match J::STRUCTURES.velocity_map.is_identity() {
            true => velocity,
            false => self.joint.velocity_map_inverse(q) * velocity,
        }
    }

    /// Q′ and ϕ̇.
    fn rate(&self, base: &SVector<D, N>, phi: &SVector<D, K>) -> (SVector<D, N>, SVector<D, K>) {
        let there = self.joint.retract(base, phi);
        let rate = self.local_rate(&there);
        let rate = self.joint.retract_differential_inverse(base, phi, &rate);
        (there, rate)
    }

    /// `S⁻¹ S̄` at Q′.
    fn by_speeds(&self, there: &SVector<f64, N>, flat: bool) -> SMatrix<f64, K, S> {
        let mut map = self.joint.speed_basis(there);
        if !J::STRUCTURES.velocity_map.is_identity() {
            map = self.joint.velocity_map_inverse(there) * map;
        }
        if !flat {
            for j in 0..S {
                let rate = map.column(j).into_owned();
                let own = self
                    .joint
                    .retract_differential_inverse(&self.base, &self.phi, &rate);
                map.set_column(j, &own);
            }
        }
        map
    }
}

fn columns<const R: usize, const K: usize>(
    column: impl FnMut(usize) -> SVector<f64, R>,
) -> SMatrix<f64, R, K> {
    let columns: [_; K] = core::array::from_fn(column);
    SMatrix::from_columns(&columns)
}
