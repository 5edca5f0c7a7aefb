//! Joints that carry several bodies: each body is seen as a joint of its own that carries it alone.
//!
//! Such a joint hangs m bodies on one parent, with one configuration Q and one velocity v. Body b has its pose `H_b(Q)` and its twist map
//! `X_b(Q)`; all else belongs to Q and v, and is the same for every body. The type of the joint is the [`Joint`] of its first body;
//! [`Carries`] adds the others, and [`Member`] makes a [`Joint`] of each of them. Condition (23) on the rank of X holds for all X_b below
//! one another, not for each.

use super::{Joint, Patterns, Pin, Port, Structures, Units, VelocityFrame};
use crate::erased::Shared;
use crate::scalar::Scalar;
use crate::spatial::Pose;
use nalgebra::{SMatrix, SVector};

/// Body B of a joint that carries several; shapes, units and frames are those of [`Joint`].
pub trait Carries<const B: usize, const N: usize, const K: usize, const S: usize, const C: usize>:
    Joint<N, K, S, C>
{
    /// Which kernels are trivial: those of Q and v alone are as those of the joint.
    const STRUCTURES: Structures;
    /// Which entries of H, X^c, S̄ and the derivatives of the last two are known.
    const PATTERNS: Patterns<K, S>;
    /// Basis of the inertias of this body that do not affect the joint, [`Joint::UNIDENTIFIABLE`].
    const UNIDENTIFIABLE: &'static [[f64; 10]];

    /// H_B(Q): coordinates of the body's child frame to parent coordinates.
    fn pose<T: Scalar>(&self, q: &SVector<T, N>) -> Pose<T>;

    /// X_B(Q): v to the twist of the body relative to the parent, in the parent frame.
    fn twist_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K>;

    /// `Ad_{H⁻¹} X` of the body: v to the same twist, in its child frame.
    fn twist_map_child<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K>;

    /// [`Joint::relation_twists`] of the body.
    fn relation_twists<T: Scalar>(&self, _q: &SVector<T, N>) -> impl AsRef<[[T; 6]]> {
        const {
            assert!(
                Self::RELATIONS.is_empty(),
                "the joint has relations: the body must implement relation_twists"
            )
        };
        let none: [[T; 6]; 0] = [];
        none
    }

    /// ∂X^c/∂ϕ of the body; slice k is the derivative along ϕ_k.
    fn twist_map_child_gradient<T: Scalar>(&self, _q: &SVector<T, N>) -> [SMatrix<T, 6, K>; K] {
        const {
            assert!(
                <Self as Carries<B, N, K, S, C>>::STRUCTURES
                    .twist_map_child_gradient
                    .is_zero(),
                "twist_map_child_gradient is not zero: the body must implement it"
            )
        };
        [SMatrix::zeros(); K]
    }
}

/// Body B of a joint, seen as a joint that carries it alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Member<J, const B: usize>(pub J);

impl<J, const B: usize, const N: usize, const K: usize, const S: usize, const C: usize>
    Joint<N, K, S, C> for Member<J, B>
where
    J: Carries<B, N, K, S, C>,
{
    const NAME: &'static str = J::NAME;
    const COORDINATES: [&'static str; N] = J::COORDINATES;
    const FREEDOMS: [&'static str; K] = J::FREEDOMS;
    const SPEEDS: [&'static str; S] = J::SPEEDS;
    const VELOCITY_FRAME: VelocityFrame = J::VELOCITY_FRAME;
    const STRUCTURES: Structures = <J as Carries<B, N, K, S, C>>::STRUCTURES;
    const PATTERNS: Patterns<K, S> = <J as Carries<B, N, K, S, C>>::PATTERNS;
    const UNIDENTIFIABLE: &'static [[f64; 10]] = <J as Carries<B, N, K, S, C>>::UNIDENTIFIABLE;
    const SINGULARITIES: &'static [&'static str] = J::SINGULARITIES;
    const RELATIONS: &'static [&'static str] = J::RELATIONS;
    const RELATION_UNITS: &'static [&'static str] = J::RELATION_UNITS;
    const UNITS: Units = J::UNITS;
    const PORTS: &'static [Port] = J::PORTS;
    const HAS_PORTS: bool = J::HAS_PORTS;
    const PINS: &'static [Pin] = J::PINS;
    const BODIES: &'static [&'static str] = J::BODIES;
    const BODY: usize = B;

    fn more(&self, visit: &mut dyn FnMut(Shared)) {
        self.0.more(visit);
    }

    fn parameters(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.0.parameters()
    }

    fn home<T: Scalar>(&self) -> SVector<T, N> {
        self.0.home()
    }

    fn pose<T: Scalar>(&self, q: &SVector<T, N>) -> Pose<T> {
        Carries::pose(&self.0, q)
    }

    fn twist_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K> {
        Carries::twist_map(&self.0, q)
    }

    fn twist_map_child<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K> {
        Carries::twist_map_child(&self.0, q)
    }

    fn twist_map_child_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, 6, K>; K] {
        Carries::twist_map_child_gradient(&self.0, q)
    }

    fn velocity_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, K> {
        self.0.velocity_map(q)
    }

    fn velocity_map_inverse<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, K> {
        self.0.velocity_map_inverse(q)
    }

    fn velocity_map_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, K, K>; K] {
        self.0.velocity_map_gradient(q)
    }

    fn gamma<T: Scalar>(&self, q: &SVector<T, N>, v: &SVector<T, K>) -> SMatrix<T, K, K> {
        self.0.gamma(q, v)
    }

    fn j22<T: Scalar>(&self, q: &SVector<T, N>, p: &SVector<T, K>) -> SMatrix<T, K, K> {
        self.0.j22(q, p)
    }

    fn constraint<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, C> {
        self.0.constraint(q)
    }

    fn speed_basis<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, S> {
        self.0.speed_basis(q)
    }

    fn speed_basis_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, K, S>; K] {
        self.0.speed_basis_gradient(q)
    }

    fn port_map<T: Scalar>(&self, q: &SVector<T, N>) -> impl AsRef<[[T; K]]> {
        self.0.port_map(q)
    }

    fn port_values<T: Scalar>(&self, q: &SVector<T, N>) -> impl AsRef<[T]> {
        self.0.port_values(q)
    }

    fn pins<T: Scalar>(&self, q: &SVector<T, N>) -> impl AsRef<[[T; 9]]> {
        self.0.pins(q)
    }

    fn relation_twists<T: Scalar>(&self, q: &SVector<T, N>) -> impl AsRef<[[T; 6]]> {
        Carries::relation_twists(&self.0, q)
    }

    fn relation_ports<T: Scalar>(&self, q: &SVector<T, N>) -> impl AsRef<[T]> {
        self.0.relation_ports(q)
    }

    fn configuration_rate<T: Scalar>(&self, q: &SVector<T, N>, v: &SVector<T, K>) -> SVector<T, N> {
        self.0.configuration_rate(q, v)
    }

    fn retract<T: Scalar>(&self, q: &SVector<T, N>, phi: &SVector<T, K>) -> SVector<T, N> {
        self.0.retract(q, phi)
    }

    fn local<T: Scalar>(&self, q: &SVector<T, N>, target: &SVector<T, N>) -> SVector<T, K> {
        self.0.local(q, target)
    }

    fn retract_differential<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        phi: &SVector<T, K>,
    ) -> SMatrix<T, K, K> {
        self.0.retract_differential(q, phi)
    }

    fn retract_differential_inverse<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        phi: &SVector<T, K>,
        rate: &SVector<T, K>,
    ) -> SVector<T, K> {
        self.0.retract_differential_inverse(q, phi, rate)
    }

    fn project<T: Scalar>(&self, q: &SVector<T, N>) -> SVector<T, N> {
        self.0.project(q)
    }

    fn residual<T: Scalar>(&self, q: &SVector<T, N>) -> T {
        self.0.residual(q)
    }

    fn singularity<T: Scalar>(&self, q: &SVector<T, N>) -> T {
        self.0.singularity(q)
    }
}
