//! How the efforts of elements at one joint change with its configuration and velocity.
//!
//! Springs on a manifold differentiate Φ twice, and rotors the kernel of γ: dual numbers through the joint's own kernels do it exactly.

use super::Steps;
use super::directions::{along, columns, constant, derivative};
use crate::erased::nan;
use crate::joint::{Joint, PortLaw};
use crate::matrix::{by_rows, dot, entries, filled, map, product, zeros};
use crate::scalar::{Dual, Scalar};
use nalgebra::{Matrix3, SMatrix, SVector};

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Steps<'_, J, N, K, S, C>
where
    J: Joint<N, K, S, C>,
{
    /// `∂τ/∂ϕ` at `q` of a [`JointSpring`](crate::elements::JointSpring) with this `rest` configuration and stiffness, by rows.
    pub(crate) fn spring_slope<T: Scalar>(
        &self,
        (q, rest): (&SVector<T, N>, &SVector<T, N>),
        stiffness: &[T],
    ) -> SMatrix<T, K, K> {
        if stiffness.len() != K * K {
            return filled(nan());
        }
        let rest = constant(rest);
        let stiffness = map(&by_rows(stiffness), Dual::constant);
        self.slope(q, |q| self.spring_effort((q, &rest), &stiffness))
    }

    /// `∂τ/∂ϕ` at `q` of a [`RotationSpring`](crate::elements::RotationSpring) with this `rest` rotation and stiffness.
    pub(crate) fn turn_slope<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        rest: &Matrix3<T>,
        stiffness: T,
    ) -> SMatrix<T, K, K> {
        let back = map(&rest.transpose(), Dual::constant);
        let stiffness = Dual::constant(stiffness);
        self.slope(q, |q| self.turn_effort(q, &back, stiffness))
    }

    /// The derivatives in ϕ and in v of `Σ_k γ_k v_k (a v)`, the velocity term of rotors with inertias a.
    pub(crate) fn rotor_slopes<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        velocity: &SVector<T, K>,
        inertia: &SVector<T, K>,
    ) -> [SMatrix<T, K, K>; 2] {
        if const { J::STRUCTURES.gamma.is_zero() } {
            return [zeros(); 2];
        }
        let (velocity, inertia) = (constant(velocity), constant(inertia));
        let force = |q: &SVector<Dual<T>, N>, v: &SVector<Dual<T>, K>| {
            let momentum = entries(|k| v[k] * inertia[k]);
            product(&self.0.gamma(q, v), &momentum)
        };
        let by_local = self.slope(q, |q| force(q, &velocity));
        let q = constant(q);
        [
            by_local,
            columns(|k| derivative(&force(&q, &(velocity + along(k))))),
        ]
    }

    /// `∂τ/∂ϕ` at `q` and fixed v of `τ = Pᵀ f`, where f acts on one port by a law; NaN of a port that is not there.
    pub(crate) fn port_slope<T: Scalar>(
        &self,
        (q, velocity): (&SVector<T, N>, &SVector<T, K>),
        port: usize,
        law: &PortLaw<T>,
    ) -> SMatrix<T, K, K> {
        if const { !J::HAS_PORTS } {
            return filled(nan());
        }
        let PortLaw {
            effort,
            stiffness,
            damping,
        } = law;
        let [effort, stiffness, damping] = [*effort, *stiffness, *damping].map(Dual::constant);
        let here = self.port(&constant(q), port);
        let velocity = constant(velocity);
        let here_rate = dot(&here.1, &velocity);
        self.slope(q, |q| {
            let (value, row) = self.port(q, port);
            let spring = stiffness * (value - here.0);
            let damper = damping * (dot(&row, &velocity) - here_rate);
            row * (effort - spring - damper)
        })
    }

    /// The value of a port, and its row of P as a column.
    pub(super) fn port<T: Scalar>(&self, q: &SVector<T, N>, port: usize) -> (T, SVector<T, K>) {
        if const { !J::HAS_PORTS } {
            return (nan(), filled(nan()));
        }
        let values = self.0.port_values(q);
        let value = match values.as_ref().get(port) {
            Some(value) => *value,
            None => nan(),
        };
        (value, self.port_row(q, port))
    }

    /// `∂f/∂ϕ` of a function of the configuration.
    fn slope<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        f: impl Fn(&SVector<Dual<T>, N>) -> SVector<Dual<T>, K>,
    ) -> SMatrix<T, K, K> {
        let q = constant(q);
        columns(|k| derivative(&f(&self.0.retract(&q, &along(k)))))
    }
}
