//! How a joint's share in the derivatives of a scalar function of a mechanism's motion changes with the joint's own ϕ and v̄.
//!
//! The function has derivatives by the placement, the twist, its rate and the virtual twist of a child frame: [`MotionGradient`]. Those by ϕ and v̄ are products
//! of these with what one unit of ϕ and v̄ changes. Here the products are differentiated once more along the joint's own directions, the [`MotionGradient`] held
//! fixed in the child frame: by dual numbers through the kernels of first order, with Q moved along `E_l = Q̇(Q, S₀ e_l)`.

use super::Steps;
use super::directions::{along, constant, derivative, moving};
use super::motion_gradient::{Carrying, MotionGradient, OwnMotion, have_sizes};
use crate::joint::{Joint, Products};
use crate::matrix::{column, transposed_product, zeros};
use crate::scalar::{Dual, Scalar};
use nalgebra::{Matrix3, SMatrix, SVector, Vector6};

/// Q, v̄, v̄̇ and the virtual speeds μ of one joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VirtualState<T, const N: usize, const S: usize> {
    pub(crate) q: SVector<T, N>,
    pub(crate) speeds: SVector<T, S>,
    pub(crate) accelerations: SVector<T, S>,
    pub(crate) virtual_speeds: SVector<T, S>,
}

impl<const N: usize, const S: usize> VirtualState<f64, N, S> {
    fn constant(&self) -> VirtualState<Dual<f64>, N, S> {
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
    /// Whether X̄ is constant, and ϕ̇ = v = v̄.
    const fn has_constant_columns() -> bool {
        let structures = J::STRUCTURES;
        structures.speed_map.is_constant()
            && structures.velocity_map.is_identity()
            && structures.speed_basis.is_identity()
    }

    /// Q as it moves along `E_l`.
    pub(super) fn moving<T: Scalar>(&self, q: &SVector<T, N>, l: usize) -> SVector<Dual<T>, N> {
        let velocity = column(&self.0.velocity_map(q), l);
        moving(q, &self.0.configuration_rate(q, &velocity))
    }

    /// The derivatives of the products of `gradient` with the variations, both in child axes, along the joint's own ϕ and v̄. `carrying` is of the parent, in
    /// child axes as well. Into `out` as [`AnyJoint::second_variations`](crate::erased::AnyJoint::second_variations) says.
    pub(crate) fn second_variations(
        &self,
        state: &VirtualState<f64, N, S>,
        carrying: &Carrying<f64>,
        gradient: &MotionGradient<f64>,
        mut out: [&mut [f64]; 3],
    ) {
        if !have_sizes(&mut out, [K * K, K * S, S * S]) {
            return;
        }
        if const { Self::has_constant_columns() } {
            let columns = self.columns(&state.q, &Matrix3::identity());
            return gradient.constant_columns(&columns, carrying, out);
        }
        let (still, gradient) = (state.constant(), gradient.constant());
        let local = self.0.local_twist_map(&state.q);
        let [by_local, mixed, by_speeds] = out;
        // One loop, so that what it does is compiled once: along each ϕ, then along each speed.
        for l in 0..K + S {
            let (moved, carried) = match l < K {
                true => {
                    let q = self.moving(&state.q, l);
                    let carried = carrying.turned_back(&column(&local, l));
                    (VirtualState { q, ..still }, carried)
                }
                false => {
                    let speeds = still.speeds + along(l - K);
                    (VirtualState { speeds, ..still }, carrying.constant())
                }
            };
            let (of_local, of_speeds) = self.products(&moved, &carried, &gradient);
            match l.checked_sub(K) {
                None => {
                    for k in 0..K {
                        by_local[k * K + l] = of_local[k].derivative();
                    }
                }
                Some(j) => {
                    for k in 0..K {
                        mixed[j * K + k] = of_local[k].derivative();
                    }
                    for i in 0..S {
                        by_speeds[i * S + j] = of_speeds[i].derivative();
                    }
                }
            }
        }
    }

    /// What `gradient` says of one unit of each ϕ and v̄.
    fn products(
        &self,
        state: &VirtualState<Dual<f64>, N, S>,
        carrying: &Carrying<Dual<f64>>,
        gradient: &MotionGradient<Dual<f64>>,
    ) -> ([Dual<f64>; K], [Dual<f64>; S]) {
        let VirtualState {
            q,
            speeds,
            accelerations,
            virtual_speeds,
        } = state;
        let joint = self.0;
        let columns = self.columns(q, &Matrix3::identity());
        let first = joint.first_order(q);
        let twist_slopes = J::twist_gradient_at(&first, speeds);
        let mut rate_slopes = J::twist_gradient_at(&first, accelerations);
        if const { !J::STRUCTURES.bias_acceleration.is_constant() } {
            rate_slopes += joint.bias_acceleration_gradient(q, speeds);
        }
        let speed_slopes = match const { J::STRUCTURES.bias_acceleration.is_zero() } {
            true => zeros(),
            false => joint.bias_acceleration_slope_at((q, speeds), &first, &twist_slopes),
        };
        let own = OwnMotion {
            columns: &columns,
            local: &columns_of(&joint.local_twist_map(q)),
            twist: Self::add_columns(&Vector6::zeros(), &columns, speeds),
            twist_slopes: &columns_of(&twist_slopes),
            rate_slopes: &columns_of(&rate_slopes),
            virtual_slopes: &columns_of(&J::twist_gradient_at(&first, virtual_speeds)),
            speed_slopes: &columns_of(&speed_slopes),
        };
        let zero = Dual::constant(0.0);
        let (mut by_local, mut by_speeds) = ([zero; K], [zero; S]);
        gradient.products(&own, carrying, &mut by_local, &mut by_speeds);
        (by_local, by_speeds)
    }

    /// `Σ_m g_m [S₀⁻¹ (∂S_l − E_l S₀)]_mk` (row l, column k): with it `E_l E_k f` is the Hessian of f(Φ(Q, ϕ)) at ϕ = 0, where g_k is `E_k f`.
    ///
    /// At ϕ, one unit of ϕ_k moves Φ as `S₀(Φ)⁻¹ S(Q, ϕ) e_k` does at ϕ = 0, so that `∂(f∘Φ)/∂ϕ_k = Σ_m g_m(Φ) [S₀(Φ)⁻¹ S(Q, ϕ)]_mk`.
    pub(crate) fn chart_terms(
        &self,
        q: &SVector<f64, N>,
        gradient: &SVector<f64, K>,
    ) -> SMatrix<f64, K, K> {
        let slices = self.0.velocity_map_gradient(q);
        let mut terms = zeros::<f64, K, K>();
        let weights = transposed_product(&self.0.velocity_map_inverse(q), gradient);
        for (l, slice) in slices.iter().enumerate() {
            let mut change = *slice;
            if const { !J::STRUCTURES.velocity_map.is_constant() } {
                change -= derivative(&self.0.velocity_map(&self.moving(q, l)));
            }
            let row = transposed_product(&change, &weights);
            for k in 0..K {
                terms[(l, k)] = row[k];
            }
        }
        terms
    }
}

/// The columns of a matrix.
fn columns_of<T: Scalar, const M: usize>(matrix: &SMatrix<T, 6, M>) -> [Vector6<T>; M] {
    let mut columns = [Vector6::zeros(); M];
    for (j, own) in columns.iter_mut().enumerate() {
        *own = column(matrix, j);
    }
    columns
}
