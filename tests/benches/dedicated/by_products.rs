//! A joint without the formulas for c and its dual that it may have of its own: both by products.

use hamel::joint::{Joint, Patterns, Structures, VelocityFrame};
use hamel::nalgebra::{SMatrix, SVector};
use hamel::scalar::Scalar;
use hamel::spatial::Pose;

/// `J` in all but [`Joint::bias_acceleration`] and [`Joint::bias_momentum`], which are the trait's.
#[derive(Clone, Debug)]
pub struct ByProducts<J>(pub J);

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Joint<N, K, S, C>
    for ByProducts<J>
where
    J: Joint<N, K, S, C>,
{
    const NAME: &'static str = J::NAME;
    const COORDINATES: [&'static str; N] = J::COORDINATES;
    const FREEDOMS: [&'static str; K] = J::FREEDOMS;
    const SPEEDS: [&'static str; S] = J::SPEEDS;
    const VELOCITY_FRAME: VelocityFrame = J::VELOCITY_FRAME;
    const STRUCTURES: Structures = J::STRUCTURES;
    const PATTERNS: Patterns<K, S> = J::PATTERNS;
    const UNIDENTIFIABLE: &'static [[f64; 10]] = J::UNIDENTIFIABLE;
    const SINGULARITIES: &'static [&'static str] = J::SINGULARITIES;

    fn parameters(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.0.parameters()
    }

    fn home<T: Scalar>(&self) -> SVector<T, N> {
        self.0.home()
    }

    fn pose<T: Scalar>(&self, q: &SVector<T, N>) -> Pose<T> {
        self.0.pose(q)
    }

    fn twist_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K> {
        self.0.twist_map(q)
    }

    fn twist_map_child<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K> {
        self.0.twist_map_child(q)
    }

    fn twist_map_child_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, 6, K>; K] {
        self.0.twist_map_child_gradient(q)
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
