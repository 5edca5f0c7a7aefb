//! Joints from H, X, Φ and S̄ alone: every other kernel follows by dual numbers from its definition.
//!
//! Slow, but nothing in it is derived by hand, so that no sign can be wrong twice.

use super::dual::{along, constant, slope, solve, unit};
use core::array;
use hamel_runtime::erased::Shared;
use hamel_runtime::joint::{Carries, Joint, Patterns, Structure, Structures, VelocityFrame};
use hamel_runtime::scalar::{Dual, Scalar};
use hamel_runtime::spatial::{Pose, join, vee};
use nalgebra::{SMatrix, SVector, Vector6};

/// What the author of a joint declares.
pub trait Declared<const N: usize, const K: usize, const S: usize, const C: usize>:
    Clone + core::fmt::Debug + Send + Sync + 'static
{
    const NAME: &'static str;
    const COORDINATES: [&'static str; N];
    const FREEDOMS: [&'static str; K];
    const SPEEDS: [&'static str; S];
    const VELOCITY_FRAME: VelocityFrame;
    const SINGULARITIES: &'static [&'static str] = &[];
    const BODIES: &'static [&'static str] = &[];

    /// The further bodies, as [`Joint::more`] hands them over.
    fn more(&self, _visit: &mut dyn FnMut(Shared)) {}
    /// S(Q, ϕ) of (23): `X(Φ) S = J`, by least squares.
    fn velocity_map_at<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        phi: &SVector<T, K>,
    ) -> SMatrix<T, K, K> {
        by_twists(self, q, phi)
    }
    fn home<T: Scalar>(&self) -> SVector<T, N>;
    fn pose<T: Scalar>(&self, q: &SVector<T, N>) -> Pose<T>;
    /// X in the parent frame.
    fn twist_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K>;
    fn retract<T: Scalar>(&self, q: &SVector<T, N>, phi: &SVector<T, K>) -> SVector<T, N>;
    fn local<T: Scalar>(&self, q: &SVector<T, N>, target: &SVector<T, N>) -> SVector<T, K>;
    fn speed_basis<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, S>;
    fn constraint<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, C>;
    fn project<T: Scalar>(&self, q: &SVector<T, N>) -> SVector<T, N>;
    fn residual<T: Scalar>(&self, q: &SVector<T, N>) -> T;
    fn singularity<T: Scalar>(&self, _q: &SVector<T, N>) -> T {
        hamel_runtime::finite::least_absolute([])
    }
}

/// `X(Φ) S = J` by least squares.
fn by_twists<T: Scalar, D, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &D,
    q: &SVector<T, N>,
    phi: &SVector<T, K>,
) -> SMatrix<T, K, K>
where
    D: Declared<N, K, S, C>,
{
    let jacobian = columns(|k| {
        let moved = joint.retract(&constant(q), &along(phi, &unit(k)));
        velocity(&joint.pose(&moved))
    });
    let x = joint.twist_map(&joint.retract(q, phi));
    solve(x.transpose() * x, x.transpose() * jacobian)
}

/// The matrix of these columns.
fn columns<T: Scalar, const R: usize, const K: usize>(
    column: impl FnMut(usize) -> SVector<T, R>,
) -> SMatrix<T, R, K> {
    SMatrix::from_columns(&array::from_fn::<_, K, _>(column))
}

/// The twist with which a pose moves, in the parent frame.
pub fn velocity<T: Scalar>(pose: &Pose<Dual<T>>) -> SVector<T, 6> {
    let (rotation, rate) = (
        pose.rotation.map(|entry| entry.value),
        pose.rotation.map(|entry| entry.derivative()),
    );
    let omega = vee(&(rate * rotation.transpose()));
    let origin = pose.translation.map(|entry| entry.value);
    join(&omega, &(slope(&pose.translation) - omega.cross(&origin)))
}

/// X where v are the rates of the coordinates: how the pose moves with each of them.
pub fn twists_of_rates<T: Scalar, const K: usize>(
    q: &SVector<T, K>,
    pose: impl Fn(&SVector<Dual<T>, K>) -> Pose<Dual<T>>,
) -> SMatrix<T, 6, K> {
    columns(|k| velocity(&pose(&along(q, &unit(k)))))
}

/// What the author declares of the second body of a joint.
pub trait DeclaredSecond<const N: usize, const K: usize, const S: usize, const C: usize>:
    Declared<N, K, S, C>
{
    fn second_pose<T: Scalar>(&self, q: &SVector<T, N>) -> Pose<T>;
    /// X of the second body in the parent frame.
    fn second_twist_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K>;
}

/// The joint that a declaration amounts to.
#[derive(Clone, Debug)]
pub struct Derived<D>(pub D);

impl<D> Derived<D> {
    /// Derivative of `function` of Q along ϕ = direction.
    fn slope_along<
        T: Scalar,
        const N: usize,
        const K: usize,
        const S: usize,
        const C: usize,
        const R: usize,
        const W: usize,
    >(
        &self,
        q: &SVector<T, N>,
        direction: &SVector<T, K>,
        function: impl Fn(&SVector<Dual<T>, N>) -> SMatrix<Dual<T>, R, W>,
    ) -> SMatrix<T, R, W>
    where
        D: Declared<N, K, S, C>,
    {
        let moved = self
            .0
            .retract(&constant(q), &along(&SVector::zeros(), direction));
        slope(&function(&moved))
    }

    /// Derivatives of a column along every ϕ_k.
    fn gradient<
        T: Scalar,
        const N: usize,
        const K: usize,
        const S: usize,
        const C: usize,
        const R: usize,
    >(
        &self,
        q: &SVector<T, N>,
        function: impl Fn(&SVector<Dual<T>, N>) -> SVector<Dual<T>, R>,
    ) -> SMatrix<T, R, K>
    where
        D: Declared<N, K, S, C>,
    {
        let columns: [_; K] = array::from_fn(|k| self.slope_along(q, &unit(k), &function));
        SMatrix::from_columns(&columns)
    }

    fn twist_basis_slope<
        T: Scalar,
        const N: usize,
        const K: usize,
        const S: usize,
        const C: usize,
    >(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
    ) -> SMatrix<T, 6, S>
    where
        D: Declared<N, K, S, C>,
    {
        let v = self.0.speed_basis(q) * speeds;
        let rate = self.velocity_map_inverse(q) * v;
        self.slope_along(q, &rate, |q| {
            Joint::twist_map_child(self, q) * self.0.speed_basis(q)
        })
    }
}

/// Nothing but S̄ of a holonomic joint is trivial.
const fn structures(constraints: usize) -> Structures {
    let speed_basis = match constraints {
        0 => Structure::Identity,
        _ => Structure::General,
    };
    Structures {
        speed_basis,
        ..Structures::GENERAL
    }
}

impl<D, const N: usize, const K: usize, const S: usize, const C: usize> Carries<1, N, K, S, C>
    for Derived<D>
where
    D: DeclaredSecond<N, K, S, C>,
{
    const STRUCTURES: Structures = structures(C);
    const PATTERNS: Patterns<K, S> = Patterns::DENSE;
    const UNIDENTIFIABLE: &'static [[f64; 10]] = &[];

    fn pose<T: Scalar>(&self, q: &SVector<T, N>) -> Pose<T> {
        self.0.second_pose(q)
    }

    fn twist_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K> {
        self.0.second_twist_map(q)
    }

    fn twist_map_child<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K> {
        self.0
            .second_pose(q)
            .act_twist_inverse_columns(&self.0.second_twist_map(q))
    }

    fn twist_map_child_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, 6, K>; K] {
        array::from_fn(|k| {
            self.slope_along(q, &unit(k), |q| {
                <Self as Carries<1, N, K, S, C>>::twist_map_child(self, q)
            })
        })
    }
}

impl<D, const N: usize, const K: usize, const S: usize, const C: usize> Joint<N, K, S, C>
    for Derived<D>
where
    D: Declared<N, K, S, C>,
{
    const NAME: &'static str = D::NAME;
    const COORDINATES: [&'static str; N] = D::COORDINATES;
    const FREEDOMS: [&'static str; K] = D::FREEDOMS;
    const SPEEDS: [&'static str; S] = D::SPEEDS;
    const VELOCITY_FRAME: VelocityFrame = D::VELOCITY_FRAME;
    const STRUCTURES: Structures = structures(C);
    const PATTERNS: Patterns<K, S> = Patterns::DENSE;
    const UNIDENTIFIABLE: &'static [[f64; 10]] = &[];
    const SINGULARITIES: &'static [&'static str] = D::SINGULARITIES;
    const BODIES: &'static [&'static str] = D::BODIES;

    fn more(&self, visit: &mut dyn FnMut(Shared)) {
        self.0.more(visit);
    }

    fn parameters(&self) -> impl Iterator<Item = (&'static str, f64)> {
        core::iter::empty()
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
        self.0
            .pose(q)
            .act_twist_inverse_columns(&self.0.twist_map(q))
    }

    fn twist_map_child_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, 6, K>; K] {
        array::from_fn(|k| self.slope_along(q, &unit(k), |q| Joint::twist_map_child(self, q)))
    }

    fn velocity_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, K> {
        self.0.velocity_map_at(q, &SVector::zeros())
    }

    fn velocity_map_inverse<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, K> {
        let map = self.velocity_map(q);
        // Normal equations: S₀ itself can need pivots (a rotation does).
        solve(map.transpose() * map, map.transpose())
    }

    fn velocity_map_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, K, K>; K] {
        array::from_fn(|k| {
            slope(
                &self
                    .0
                    .velocity_map_at(&constant(q), &along(&SVector::zeros(), &unit(k))),
            )
        })
    }

    fn gamma<T: Scalar>(&self, q: &SVector<T, N>, v: &SVector<T, K>) -> SMatrix<T, K, K> {
        let (inverse, gradient) = (self.velocity_map_inverse(q), self.velocity_map_gradient(q));
        let rate = inverse * v;
        // Σ_k γ_k v_k = S⁻ᵀ (Ṡ − ∂S·rate)ᵀ with (Ṡ)_jl = Σ_m ∂S_jl/∂ϕ_m rate_m, (∂S·rate)_jl = Σ_m ∂S_jm/∂ϕ_l rate_m
        let difference = SMatrix::<T, K, K>::from_fn(|j, l| {
            (0..K).fold(T::zero(), |sum, m| {
                sum + (gradient[m][(j, l)] - gradient[l][(j, m)]) * rate[m]
            })
        });
        inverse.transpose() * difference.transpose()
    }

    fn j22<T: Scalar>(&self, q: &SVector<T, N>, p: &SVector<T, K>) -> SMatrix<T, K, K> {
        let (inverse, gradient) = (self.velocity_map_inverse(q), self.velocity_map_gradient(q));
        let slope = SMatrix::<T, K, K>::from_fn(|i, m| {
            (0..K).fold(T::zero(), |sum, l| sum + gradient[m][(l, i)] * p[l])
        });
        inverse.transpose() * (slope.transpose() - slope) * inverse
    }

    fn constraint<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, C> {
        self.0.constraint(q)
    }

    fn speed_basis<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, S> {
        self.0.speed_basis(q)
    }

    fn speed_basis_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, K, S>; K] {
        array::from_fn(|k| self.slope_along(q, &unit(k), |q| self.0.speed_basis(q)))
    }

    fn configuration_rate<T: Scalar>(&self, q: &SVector<T, N>, v: &SVector<T, K>) -> SVector<T, N> {
        self.slope_along(q, &(self.velocity_map_inverse(q) * v), |q| *q)
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
        self.velocity_map_inverse(&self.0.retract(q, phi)) * self.0.velocity_map_at(q, phi)
    }

    fn retract_differential_inverse<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        phi: &SVector<T, K>,
        rate: &SVector<T, K>,
    ) -> SVector<T, K> {
        let map = self.0.velocity_map_at(q, phi);
        let v = self.velocity_map(&self.0.retract(q, phi)) * rate;
        solve(map.transpose() * map, map.transpose() * v)
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

    fn bias_acceleration<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
    ) -> SVector<T, 6> {
        self.twist_basis_slope(q, speeds) * speeds
    }

    fn bias_momentum<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
        h: &Vector6<T>,
    ) -> SVector<T, S> {
        self.twist_basis_slope(q, speeds).transpose() * h
    }
}
