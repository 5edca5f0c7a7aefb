//! How a joint's share in the derivatives of a scalar function of a mechanism's motion changes with the joint's own ϕ and v̄.
//!
//! The function has derivatives by the placement, the twist, its rate and the virtual twist of a child frame: [`MotionGradient`]. Those by ϕ and v̄ are products
//! of these with the [`Variation`]s. Here the products are differentiated once more along the joint's own directions, the [`MotionGradient`] held fixed in
//! the child frame: by dual numbers through the kernels of first order, with Q moved along `E_l = Q̇(Q, S₀ e_l)`.

use super::directions::{along, constant, derivative};
use super::{Motion, Placement, Steps, Variation};
use crate::joint::{Joint, Products};
use crate::scalar::{Dual, Scalar};
use crate::spatial::bracket_product;
use nalgebra::{Matrix3, SMatrix, SVector, Vector6};

/// The gradient of a scalar function of a mechanism's motion by the motion of one child frame and of all that hangs on it: four vectors that are read as
/// wrenches are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionGradient<T> {
    /// ζ, by the placement.
    pub placement: Vector6<T>,
    /// β, by V.
    pub twist: Vector6<T>,
    /// h, by V̇.
    pub rate: Vector6<T>,
    /// F, by the virtual twist P.
    pub virtual_twist: Vector6<T>,
}

/// V, V̇ and P of the parent, as they carry a child frame along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carrying<T> {
    /// V.
    pub twist: Vector6<T>,
    /// V̇.
    pub rate: Vector6<T>,
    /// P.
    pub virtual_twist: Vector6<T>,
}

/// Q, v̄, v̄̇ and the virtual speeds μ of one joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VirtualState<T, const N: usize, const S: usize> {
    pub(crate) q: SVector<T, N>,
    pub(crate) speeds: SVector<T, S>,
    pub(crate) accelerations: SVector<T, S>,
    pub(crate) virtual_speeds: SVector<T, S>,
}

/// Second derivatives of one joint's share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OwnHessian<T, const K: usize, const S: usize> {
    /// `E_l E_k`: row l, column k. Not symmetric: see [`Steps::chart_terms`].
    pub(crate) by_local: SMatrix<T, K, K>,
    /// By ϕ and v̄.
    pub(crate) mixed: SMatrix<T, K, S>,
    /// By v̄.
    pub(crate) by_speeds: SMatrix<T, S, S>,
}

impl<T: Scalar> MotionGradient<T> {
    /// Zeros.
    pub fn zero() -> Self {
        Self {
            placement: Vector6::zeros(),
            twist: Vector6::zeros(),
            rate: Vector6::zeros(),
            virtual_twist: Vector6::zeros(),
        }
    }

    /// Each of its vectors.
    pub(crate) fn map<U>(&self, f: impl Fn(&Vector6<T>) -> Vector6<U>) -> MotionGradient<U> {
        MotionGradient {
            placement: f(&self.placement),
            twist: f(&self.twist),
            rate: f(&self.rate),
            virtual_twist: f(&self.virtual_twist),
        }
    }
}

impl<T: Scalar> Carrying<T> {
    /// Each of its vectors.
    pub(crate) fn map<U>(&self, f: impl Fn(&Vector6<T>) -> Vector6<U>) -> Carrying<U> {
        Carrying {
            twist: f(&self.twist),
            rate: f(&self.rate),
            virtual_twist: f(&self.virtual_twist),
        }
    }
}

impl<T: Scalar, const N: usize, const S: usize> VirtualState<T, N, S> {
    fn constant(&self) -> VirtualState<Dual<T>, N, S> {
        VirtualState {
            q: constant(&self.q),
            speeds: constant(&self.speeds),
            accelerations: constant(&self.accelerations),
            virtual_speeds: constant(&self.virtual_speeds),
        }
    }
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Steps<'_, J, N, K, S, C>
where
    J: Joint<N, K, S, C>,
{
    /// Q as it moves along `E_l`.
    pub(super) fn moving<T: Scalar>(&self, q: &SVector<T, N>, l: usize) -> SVector<Dual<T>, N> {
        let velocity = self.0.velocity_map(q).column(l).into_owned();
        let rate = self.0.configuration_rate(q, &velocity);
        SVector::from_fn(|i, _| Dual::new(q[i], rate[i]))
    }

    /// The derivatives of the products of `gradient` with the variations, both in child axes, along the joint's own ϕ and v̄. `carrying` is of the parent, in
    /// child axes as well.
    pub(crate) fn second_variations<T: Scalar>(
        &self,
        state: &VirtualState<T, N, S>,
        carrying: &Carrying<T>,
        gradient: &MotionGradient<T>,
    ) -> OwnHessian<T, K, S> {
        let structures = J::STRUCTURES;
        // Then ϕ̇ = v = v̄ and X̄ stands still in the child: nothing changes but what the parent does, as seen from there.
        if structures.speed_map.is_constant()
            && structures.velocity_map.is_identity()
            && structures.speed_basis.is_identity()
        {
            let columns = self.columns(&state.q, &Matrix3::identity());
            return Self::second_variations_of(&columns, carrying, gradient);
        }
        let still = state.constant();
        let gradient = gradient.map(constant);
        let local = self.0.local_twist_map(&state.q);
        let mut hessian = OwnHessian {
            by_local: SMatrix::<T, K, K>::zeros(),
            mixed: SMatrix::<T, K, S>::zeros(),
            by_speeds: SMatrix::<T, S, S>::zeros(),
        };
        for l in 0..K {
            let moved = VirtualState {
                q: self.moving(&state.q, l),
                ..still
            };
            // What the parent does stands still in the parent, and turns back in the child.
            let z = local.column(l).into_owned();
            let carried = carrying.map(|twist| {
                let turned = bracket_product(&z, twist);
                Vector6::from_fn(|i, _| Dual::new(twist[i], -turned[i]))
            });
            let (by_local, _) = self.products(&moved, &carried, &gradient);
            hessian
                .by_local
                .set_row(l, &derivative(&by_local).transpose());
        }
        let carried = carrying.map(constant);
        for l in 0..S {
            let faster = VirtualState {
                speeds: still.speeds + along(l),
                ..still
            };
            let (by_local, by_speeds) = self.products(&faster, &carried, &gradient);
            hessian.mixed.set_column(l, &derivative(&by_local));
            let row = derivative(&by_speeds).transpose();
            hessian.by_speeds.set_row(l, &row);
        }
        hessian
    }

    /// [`Steps::second_variations`] where X̄ with these columns is constant, and the velocities of ϕ are the speeds.
    fn second_variations_of<T: Scalar>(
        columns: &[Vector6<T>; S],
        carrying: &Carrying<T>,
        gradient: &MotionGradient<T>,
    ) -> OwnHessian<T, K, S> {
        let mut hessian = OwnHessian {
            by_local: SMatrix::<T, K, K>::zeros(),
            mixed: SMatrix::<T, K, S>::zeros(),
            by_speeds: SMatrix::<T, S, S>::zeros(),
        };
        for (l, outer) in columns.iter().enumerate() {
            let moved = carrying.map(|twist| -bracket_product(outer, twist));
            for (k, inner) in columns.iter().enumerate() {
                let drift = bracket_product(&moved.twist, inner);
                let rate = bracket_product(&moved.rate, inner)
                    + bracket_product(&moved.twist, &bracket_product(&carrying.twist, inner))
                    + bracket_product(&carrying.twist, &drift);
                let virtual_drift = bracket_product(&moved.virtual_twist, inner);
                hessian.by_local[(l, k)] = gradient.twist.dot(&drift)
                    + gradient.rate.dot(&rate)
                    + gradient.virtual_twist.dot(&virtual_drift);
                hessian.by_speeds[(l, k)] = gradient.rate.dot(&bracket_product(outer, inner));
            }
        }
        hessian
    }

    /// What `gradient` says of one unit of each ϕ and v̄.
    fn products<T: Scalar>(
        &self,
        state: &VirtualState<T, N, S>,
        carrying: &Carrying<T>,
        gradient: &MotionGradient<T>,
    ) -> (SVector<T, K>, SVector<T, S>) {
        let columns = self.columns(&state.q, &Matrix3::identity());
        let parent = Motion {
            placement: Placement::world(),
            twist: carrying.twist,
            rate: carrying.rate,
        };
        let own = Motion {
            twist: Self::add_columns(&carrying.twist, &columns, &state.speeds),
            ..parent
        };
        let mut variations = [Variation::zero(); K];
        let rates = (&state.q, &state.speeds, &state.accelerations);
        self.variations(rates, (&own, &parent), &columns, &mut variations);
        let virtual_slopes = self.0.twist_gradient(&state.q, &state.virtual_speeds);
        let by_local = SVector::from_fn(|k, _| {
            let Variation {
                local, drift, rate, ..
            } = &variations[k];
            let virtual_drift =
                bracket_product(&carrying.virtual_twist, local) + virtual_slopes.column(k);
            gradient.placement.dot(local)
                + gradient.twist.dot(drift)
                + gradient.rate.dot(rate)
                + gradient.virtual_twist.dot(&virtual_drift)
        });
        let by_speeds = SVector::from_fn(|j, _| {
            gradient.twist.dot(&columns[j]) + gradient.rate.dot(&variations[j].speed_rate)
        });
        (by_local, by_speeds)
    }

    /// `Σ_m g_m [S₀⁻¹ (∂S_l − E_l S₀)]_mk` (row l, column k): with it `E_l E_k f` is the Hessian of f(Φ(Q, ϕ)) at ϕ = 0, where g_k is `E_k f`.
    ///
    /// At ϕ, one unit of ϕ_k moves Φ as `S₀(Φ)⁻¹ S(Q, ϕ) e_k` does at ϕ = 0, so that `∂(f∘Φ)/∂ϕ_k = Σ_m g_m(Φ) [S₀(Φ)⁻¹ S(Q, ϕ)]_mk`.
    pub(crate) fn chart_terms<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        gradient: &SVector<T, K>,
    ) -> SMatrix<T, K, K> {
        let structures = J::STRUCTURES;
        let slices = self.0.velocity_map_gradient(q);
        let mut terms = SMatrix::<T, K, K>::zeros();
        let weights = self.0.velocity_map_inverse(q).tr_mul(gradient);
        for (l, slice) in slices.iter().enumerate() {
            let mut change = *slice;
            if !structures.velocity_map.is_constant() {
                change -= self
                    .0
                    .velocity_map(&self.moving(q, l))
                    .map(|entry| entry.derivative());
            }
            terms.set_row(l, &change.tr_mul(&weights).transpose());
        }
        terms
    }
}
