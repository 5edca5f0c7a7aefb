//! What one unit of each of a joint's local coordinates and speeds changes of the motion of all that it carries.

use super::{Motion, Steps};
use crate::erased::nan;
use crate::joint::{Joint, Products};
use crate::matrix::column;
use crate::scalar::Scalar;
use crate::spatial::fused::cross;
use crate::spatial::{bracket_product, join, shift_twist, split, turn_out};
use nalgebra::{SVector, Vector3, Vector6};

/// What one unit of a local coordinate ϕ, and of a speed, changes; at the child frame's origin, in world axes.
///
/// Every body that the joint carries then has `δV = ad_Z V + U` and `δV̇ = ad_Z V̇ + ad_U V + W`: it is moved along by Z, and U and W are
/// the same for all of them. For a speed with column X of X̄ it is `δV = X` and `δV̇ = ad_X V + W_v`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variation<T> {
    /// `Z`: the twist of ϕ̇.
    pub local: Vector6<T>,
    /// `U = ad_{V_λ} Z + ∂X̄ v̄`.
    pub drift: Vector6<T>,
    /// `W = ad_{V̇_λ} Z + ad_{V_λ} U + ad_V ∂X̄ v̄ + ∂(X̄ v̄̇ + c)`.
    pub rate: Vector6<T>,
    /// `W_v = ad_{V + V_λ} X + ∂c/∂v̄`; zero where the joint has fewer speeds than degrees of freedom.
    pub speed_rate: Vector6<T>,
}

impl<T: Scalar> Variation<T> {
    /// Of nothing.
    pub fn zero() -> Self {
        Self::repeat(T::zero())
    }

    /// NaN.
    pub(crate) fn unknown() -> Self {
        Self::repeat(nan())
    }

    fn repeat(entry: T) -> Self {
        let vector = Vector6::repeat(entry);
        Self {
            local: vector,
            drift: vector,
            rate: vector,
            speed_rate: vector,
        }
    }
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Steps<'_, J, N, K, S, C>
where
    J: Joint<N, K, S, C>,
{
    /// `ad_V X` for column `j` of X̄, without the part that this column does not have.
    #[inline(always)]
    fn bracket_of_column<T: Scalar>(
        j: usize,
        twist: &Vector6<T>,
        column: &Vector6<T>,
    ) -> Vector6<T> {
        let ((angular, linear), (turn, slide)) = (split(twist), split(column));
        match Self::column_parts(j) {
            (true, true) => bracket_product(twist, column),
            (true, false) => join(&cross(&angular, &turn), &cross(&linear, &turn)),
            (false, true) => join(&Vector3::zeros(), &cross(&angular, &slide)),
            (false, false) => Vector6::zeros(),
        }
    }

    /// The variations of one joint at (q, v̄, v̄̇), one per degree of freedom; `own` and `parent` are the motions of the child frames.
    #[inline(always)]
    pub(crate) fn variations<T: Scalar>(
        &self,
        (q, speeds, accelerations): (&SVector<T, N>, &SVector<T, S>, &SVector<T, S>),
        (own, parent): (&Motion<T>, &Motion<T>),
        columns: &[Vector6<T>; S],
        out: &mut [Variation<T>; K],
    ) {
        let placement = &own.placement;
        let carried = shift_twist(&parent.twist, &placement.offset);
        let carried_rate = shift_twist(&parent.rate, &placement.offset);
        // Then ϕ̇ = v = v̄, and Z are the columns themselves.
        if const { J::STRUCTURES.velocity_map.is_identity() && J::STRUCTURES.speed_basis.is_identity() }
        {
            for b in 0..K {
                let (variation, z) = (&mut out[b], &columns[b]);
                variation.local = *z;
                variation.drift = Self::bracket_of_column(b, &carried, z);
                variation.rate = Self::bracket_of_column(b, &carried_rate, z);
            }
        } else {
            let local = self.0.local_twist_map(q);
            for (b, variation) in out.iter_mut().enumerate() {
                let z = turn_out(&placement.rotation, &column(&local, b));
                variation.local = z;
                variation.drift = bracket_product(&carried, &z);
                variation.rate = bracket_product(&carried_rate, &z);
            }
        }
        for variation in out.iter_mut() {
            variation.speed_rate = Vector6::zeros();
        }
        let both = own.twist + carried;
        for (a, column) in columns.iter().enumerate() {
            out[a].speed_rate = Self::bracket_of_column(a, &both, column);
        }
        if const { !J::STRUCTURES.speed_map.is_constant() } {
            self.vary_map((q, speeds, accelerations), own, out);
        }
        for variation in out.iter_mut() {
            variation.rate += bracket_product(&carried, &variation.drift);
        }
    }

    /// What the change of X̄ with ϕ adds to the variations.
    #[inline(always)]
    fn vary_map<T: Scalar>(
        &self,
        (q, speeds, accelerations): (&SVector<T, N>, &SVector<T, S>, &SVector<T, S>),
        own: &Motion<T>,
        out: &mut [Variation<T>; K],
    ) {
        let joint = self.0;
        let rotation = &own.placement.rotation;
        let first = joint.first_order(q);
        let of_twist = J::twist_gradient_at(&first, speeds);
        let mut of_rate = J::twist_gradient_at(&first, accelerations);
        if const { !J::STRUCTURES.bias_acceleration.is_constant() } {
            of_rate += joint.bias_acceleration_gradient(q, speeds);
        }
        for (b, variation) in out.iter_mut().enumerate() {
            let drift = turn_out(rotation, &column(&of_twist, b));
            variation.drift += drift;
            variation.rate +=
                bracket_product(&own.twist, &drift) + turn_out(rotation, &column(&of_rate, b));
        }
        if const { !J::STRUCTURES.bias_acceleration.is_zero() } {
            let slope = joint.bias_acceleration_slope_at((q, speeds), &first, &of_twist);
            for (a, variation) in out.iter_mut().enumerate().take(S) {
                variation.speed_rate += turn_out(rotation, &column(&slope, a));
            }
        }
    }
}
