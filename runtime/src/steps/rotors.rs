//! How the velocities of ports change, and what rotors there take: dual numbers through the joint's own kernels.
//!
//! p̄ = P S̄ is the row of a port, with w = p̄ v̄; p̄̇ is its rate along the motion at v̄.

use super::Steps;
use super::directions::{along, columns, constant, derivative, moving};
use crate::erased::nan;
use crate::joint::Joint;
use crate::matrix::{dot, entries, filled, map, of_columns, product, transposed_product};
use crate::scalar::{Dual, Scalar};
use nalgebra::{SMatrix, SVector};

/// What a rotor of unit inertia at a port amounts to, one entry a speed, at (Q, v̄).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RotorTerm {
    /// What it takes to accelerate it: `p̄ᵀ(p̄ x + p̄̇ v̄)` at x = v̄̇.
    Needed,
    /// `p̄ᵀ p̄ x`: its momentum at x = v̄, which does not change with v̄.
    Momentum,
    /// How its momentum turns: `p̄̇ᵀ(p̄ v̄)`.
    Turning,
}

/// One port of a joint, and what is asked of a rotor there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AtPort {
    pub(crate) port: usize,
    pub(crate) term: RotorTerm,
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Steps<'_, J, N, K, S, C>
where
    J: Joint<N, K, S, C>,
{
    /// The row of P of a port, as a column; NaN of a port that is not there.
    pub(crate) fn port_row<T: Scalar>(&self, q: &SVector<T, N>, port: usize) -> SVector<T, K> {
        let map = self.0.port_map(q);
        match map.as_ref().get(port) {
            Some(row) => of_columns([*row]),
            None => filled(nan()),
        }
    }

    /// p̄ of a port, as a column.
    pub(crate) fn speed_row<T: Scalar>(&self, q: &SVector<T, N>, port: usize) -> SVector<T, S> {
        let row = self.port_row(q, port);
        match const { J::STRUCTURES.speed_basis.is_identity() } {
            true => entries(|j| row.data.0[0][j]),
            false => transposed_product(&self.0.speed_basis(q), &row),
        }
    }

    /// p̄ and p̄̇ of a port at v̄, as columns.
    pub(crate) fn port_row_motion<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
        port: usize,
    ) -> [SVector<T, S>; 2] {
        if const { !J::HAS_PORTS } {
            return [filled(nan()); 2];
        }
        let velocity = product(&self.0.speed_basis(q), speeds);
        let rate = self.0.configuration_rate(q, &velocity);
        let row: SVector<Dual<T>, S> = self.speed_row(&moving(q, &rate), port);
        [map(&row, |entry| entry.value), derivative(&row)]
    }

    /// ∂P/∂ϕ of a port: column k is the derivative of its row along ϕ_k.
    pub(crate) fn port_row_gradient<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        port: usize,
    ) -> SMatrix<T, K, K> {
        if const { !J::HAS_PORTS } {
            return filled(nan());
        }
        let q = constant(q);
        columns(|k| derivative(&self.port_row(&self.0.retract(&q, &along(k)), port)))
    }

    pub(super) fn rotor_term<T: Scalar>(
        &self,
        (q, speeds, x): (&SVector<T, N>, &SVector<T, S>, &SVector<T, S>),
        AtPort { port, term }: AtPort,
    ) -> SVector<T, S> {
        if const { !J::HAS_PORTS } {
            return filled(nan());
        }
        match term {
            RotorTerm::Momentum => {
                let row = self.speed_row(q, port);
                row * dot(&row, x)
            }
            RotorTerm::Needed => {
                let [row, rate] = self.port_row_motion(q, speeds, port);
                row * (dot(&row, x) + dot(&rate, speeds))
            }
            RotorTerm::Turning => {
                let [row, rate] = self.port_row_motion(q, speeds, port);
                rate * dot(&row, speeds)
            }
        }
    }

    /// The derivatives of a [`RotorTerm`] in ϕ and in v̄ at fixed x.
    pub(crate) fn rotor_term_slopes<T: Scalar>(
        &self,
        (q, speeds, x): (&SVector<T, N>, &SVector<T, S>, &SVector<T, S>),
        at: AtPort,
    ) -> (SMatrix<T, S, K>, SMatrix<T, S, S>) {
        if const { !J::HAS_PORTS } {
            return (filled(nan()), filled(nan()));
        }
        let (speeds, x, q) = (constant(speeds), constant(x), constant(q));
        let by_local = columns(|k| {
            let moved = self.0.retract(&q, &along(k));
            derivative(&self.rotor_term((&moved, &speeds, &x), at))
        });
        let by_speeds = columns(|j| {
            let faster = speeds + along(j);
            derivative(&self.rotor_term((&q, &faster, &x), at))
        });
        (by_local, by_speeds)
    }
}
