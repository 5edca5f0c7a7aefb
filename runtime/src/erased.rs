//! Joints behind one object-safe trait, so that a mechanism holds joints of any type.
//!
//! [`AnyJoint`] mirrors the kernels of [`Joint`] over slices of `f64`. Matrices are stored column by column, and the K
//! slices of a derivative in ϕ one after the other. Nothing here allocates. What recursions do with a joint, on slices that they have cut
//! themselves, is [`Kernels`], which nothing outside can call.

use crate::chart::Chart;
use crate::elements::ElementKernels;
use crate::joint::{Joint, Products, Structures, VelocityFrame};
use crate::spatial::Pose;
use crate::steps::{ExtendedSteps, Steps};
use alloc::sync::Arc;
use core::fmt::Debug;
use nalgebra::{SMatrix, SVector, Vector6};

/// Sizes of a joint, or their sums over a mechanism.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layout {
    /// N: stored scalars of Q.
    pub configuration: usize,
    /// K: freedoms, the size of v and of ϕ.
    pub freedoms: usize,
    /// S: speeds, the size of v̄ and of p̄.
    pub speeds: usize,
    /// C: nonholonomic constraints, the size of λ.
    pub constraints: usize,
}

/// A joint of any type, [`Joint`] over slices.
///
/// With (N, K, S, C) of [`AnyJoint::layout`], shapes are as in [`Joint`]. The caller hands over slices of exactly these
/// sizes; of any other every result is NaN, or an error where there can be one.
pub trait AnyJoint: Debug + Send + Sync {
    /// The same joint for recursions.
    #[doc(hidden)]
    fn kernels(self: Arc<Self>, _: Token) -> Arc<dyn Kernels>;

    /// Name of the spec.
    fn name(&self) -> &'static str;
    /// N, K, S and C.
    fn layout(&self) -> Layout;
    /// Which kernels are trivial.
    fn structures(&self) -> Structures;
    /// Frame in which v is read.
    fn velocity_frame(&self) -> VelocityFrame;
    /// Names of the stored scalars of Q.
    fn coordinates(&self) -> &'static [&'static str];
    /// Names of the freedoms.
    fn freedoms(&self) -> &'static [&'static str];
    /// Names of the speeds.
    fn speeds(&self) -> &'static [&'static str];
    /// Basis of the inertias that the joint cannot feel, [`Joint::IMPERCEPTIBLE`].
    fn imperceptible(&self) -> &'static [[f64; 10]];
    /// The functions whose zeros the joint must stay away from, [`Joint::SINGULARITIES`].
    fn singularities(&self) -> &'static [&'static str];
    /// Hands each parameter's name and value to `visit`.
    fn parameters(&self, visit: &mut dyn FnMut(&'static str, f64));

    /// [`Joint::home`] into `q` (N).
    fn home(&self, q: &mut [f64]);
    /// [`Joint::pose`].
    fn pose(&self, q: &[f64]) -> Pose<f64>;
    /// [`Joint::twist_map`] into `out` (6×K).
    fn twist_map(&self, q: &[f64], out: &mut [f64]);
    /// [`Joint::twist_map_child`] into `out` (6×K).
    fn twist_map_child(&self, q: &[f64], out: &mut [f64]);
    /// [`Joint::twist_map_child_gradient`] into `out` (K slices of 6×K).
    fn twist_map_child_gradient(&self, q: &[f64], out: &mut [f64]);
    /// [`Joint::velocity_map`] into `out` (K×K).
    fn velocity_map(&self, q: &[f64], out: &mut [f64]);
    /// [`Joint::velocity_map_inverse`] into `out` (K×K).
    fn velocity_map_inverse(&self, q: &[f64], out: &mut [f64]);
    /// [`Joint::velocity_map_gradient`] into `out` (K slices of K×K).
    fn velocity_map_gradient(&self, q: &[f64], out: &mut [f64]);
    /// [`Joint::gamma`] into `out` (K×K).
    fn gamma(&self, q: &[f64], v: &[f64], out: &mut [f64]);
    /// [`Joint::j22`] into `out` (K×K).
    fn j22(&self, q: &[f64], p: &[f64], out: &mut [f64]);
    /// [`Joint::constraint`] into `out` (K×C).
    fn constraint(&self, q: &[f64], out: &mut [f64]);
    /// [`Joint::speed_basis`] into `out` (K×S).
    fn speed_basis(&self, q: &[f64], out: &mut [f64]);
    /// [`Joint::speed_basis_gradient`] into `out` (K slices of K×S).
    fn speed_basis_gradient(&self, q: &[f64], out: &mut [f64]);
    /// [`Joint::configuration_rate`] into `out` (N).
    fn configuration_rate(&self, q: &[f64], v: &[f64], out: &mut [f64]);
    /// [`Joint::retract`] into `out` (N).
    fn retract(&self, q: &[f64], phi: &[f64], out: &mut [f64]);
    /// [`Joint::local`] into `phi` (K).
    ///
    /// # Errors
    /// When ϕ is not finite: Newton's method did not converge, or a configuration is not finite.
    fn local(&self, q: &[f64], target: &[f64], phi: &mut [f64]) -> Result<(), FiniteMapError>;
    /// [`Joint::retract_differential`] into `out` (K×K).
    fn retract_differential(&self, q: &[f64], phi: &[f64], out: &mut [f64]);
    /// [`Joint::retract_differential_inverse`] into `out` (K).
    fn retract_differential_inverse(&self, q: &[f64], phi: &[f64], rate: &[f64], out: &mut [f64]);
    /// `ϕ̇ = D⁻¹ S₀⁻¹ S̄ v̄` at `moved`, which is Φ(Q, ϕ), into `out` (K): D is the differential of Φ at (Q, ϕ), S₀ and S̄ are those at `moved`.
    fn local_rate(&self, q: &[f64], phi: &[f64], moved: &[f64], speeds: &[f64], out: &mut [f64]);
    /// [`Joint::project`] in place.
    ///
    /// # Errors
    /// When the result is not finite, as for [`AnyJoint::local`].
    fn project(&self, q: &mut [f64]) -> Result<(), FiniteMapError>;
    /// [`Joint::residual`].
    fn residual(&self, q: &[f64]) -> f64;
    /// [`Joint::singularity`].
    fn singularity(&self, q: &[f64]) -> f64;
    /// [`Joint::bias_acceleration`].
    fn bias_acceleration(&self, q: &[f64], speeds: &[f64]) -> Vector6<f64>;
    /// [`Joint::bias_momentum`] into `out` (S).
    fn bias_momentum(&self, q: &[f64], speeds: &[f64], h: &Vector6<f64>, out: &mut [f64]);
    /// [`Products::local_twist_map`] into `out` (6×K).
    fn local_twist_map(&self, q: &[f64], out: &mut [f64]);
    /// [`Products::twist_gradient`] into `out` (6×K).
    fn twist_gradient(&self, q: &[f64], speeds: &[f64], out: &mut [f64]);
    /// [`Products::effort_gradient`] into `out` (S×K).
    fn effort_gradient(&self, q: &[f64], h: &Vector6<f64>, out: &mut [f64]);
    /// [`Products::twist_map_rate`] into `out` (6×S).
    fn twist_map_rate(&self, q: &[f64], speeds: &[f64], out: &mut [f64]);
    /// [`Products::bias_acceleration_gradient`] into `out` (6×K).
    fn bias_acceleration_gradient(&self, q: &[f64], speeds: &[f64], out: &mut [f64]);
    /// [`Products::bias_acceleration_slope`] into `out` (6×S).
    fn bias_acceleration_slope(&self, q: &[f64], speeds: &[f64], out: &mut [f64]);
    /// [`Products::bias_momentum_gradient`] into `out` (S×K).
    fn bias_momentum_gradient(&self, q: &[f64], speeds: &[f64], h: &Vector6<f64>, out: &mut [f64]);
    /// [`Products::bias_momentum_slope`] into `out` (S×S).
    fn bias_momentum_slope(&self, q: &[f64], h: &Vector6<f64>, out: &mut [f64]);
}

/// A joint as recursions use it: their own slices always have the sizes that its type asks for.
#[doc(hidden)]
pub trait Kernels: AnyJoint + Steps + ExtendedSteps + Chart + ElementKernels {}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Kernels
    for (J, Sizes<N, K, S, C>)
where
    J: Joint<N, K, S, C>,
{
}

/// What only this crate has, so that it alone can ask for [`Kernels`].
#[derive(Clone, Copy, Debug)]
pub struct Token(());

impl Token {
    pub(crate) const OWN: Self = Self(());
}

/// A finite map of a joint has no value: a Newton iteration does not converge, or its arguments are not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the {map} of joint type `{joint}` cannot be found: Newton's method does not converge here, or the configuration is not \
     finite or of another size"
)]
pub struct FiniteMapError {
    /// Joint type.
    pub joint: &'static str,
    /// `local coordinates` or `projection`.
    pub map: &'static str,
}

/// Whether there are `size` values, all finite.
fn check_finite(
    joint: &'static str,
    map: &'static str,
    values: &[f64],
    size: usize,
) -> Result<(), FiniteMapError> {
    match values.len() == size && values.iter().all(|value| value.is_finite()) {
        true => Ok(()),
        false => Err(FiniteMapError { joint, map }),
    }
}

/// A joint of any type, shared: what an entry of a registry builds.
pub type Shared = Arc<dyn AnyJoint>;

/// Puts a joint behind [`AnyJoint`].
pub fn erase<J, const N: usize, const K: usize, const S: usize, const C: usize>(joint: J) -> Shared
where
    J: Joint<N, K, S, C>,
{
    Arc::new((joint, Sizes::<N, K, S, C>))
}

/// The sizes of a joint as a type, beside which the pair `(J, Sizes)` is the adapter behind [`erase`].
///
/// A pair and not a struct around J: rustc puts the code of an `impl` for a pair beside the pair's first type. So each joint is compiled
/// on its own, and an edit of one spec leaves the others as they are.
#[derive(Debug)]
pub(crate) struct Sizes<const N: usize, const K: usize, const S: usize, const C: usize>;

/// Entry by entry: nalgebra's own way copies a number of bytes that is not known when it is compiled, by a call. NaN for a slice of another size.
#[inline]
pub(crate) fn vector<const D: usize>(slice: &[f64]) -> SVector<f64, D> {
    match <&[f64; D]>::try_from(slice) {
        Ok(entries) => SVector::from(core::array::from_fn(|i| entries[i])),
        Err(_) => SVector::from_element(f64::NAN),
    }
}

/// The entries into `out`; NaN where that is of another size.
fn store<const R: usize, const C: usize>(matrix: &SMatrix<f64, R, C>, out: &mut [f64]) {
    match out.len() == R * C {
        true => out.copy_from_slice(matrix.as_slice()),
        false => out.fill(f64::NAN),
    }
}

fn store_slices<const R: usize, const C: usize, const K: usize>(
    slices: &[SMatrix<f64, R, C>; K],
    out: &mut [f64],
) {
    if out.len() != R * C * K {
        return out.fill(f64::NAN);
    }
    // chunks_exact_mut refuses a chunk size of 0, which a joint without constraints can ask for.
    for (slice, chunk) in slices.iter().zip(out.chunks_exact_mut((R * C).max(1))) {
        store(slice, chunk);
    }
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> AnyJoint
    for (J, Sizes<N, K, S, C>)
where
    J: Joint<N, K, S, C>,
{
    fn kernels(self: Arc<Self>, _: Token) -> Arc<dyn Kernels> {
        self
    }

    fn name(&self) -> &'static str {
        J::NAME
    }

    fn layout(&self) -> Layout {
        Layout {
            configuration: N,
            freedoms: K,
            speeds: S,
            constraints: C,
        }
    }

    fn structures(&self) -> Structures {
        J::STRUCTURES
    }

    fn velocity_frame(&self) -> VelocityFrame {
        J::VELOCITY_FRAME
    }

    fn coordinates(&self) -> &'static [&'static str] {
        const { &J::COORDINATES }
    }

    fn freedoms(&self) -> &'static [&'static str] {
        const { &J::FREEDOMS }
    }

    fn speeds(&self) -> &'static [&'static str] {
        const { &J::SPEEDS }
    }

    fn imperceptible(&self) -> &'static [[f64; 10]] {
        J::IMPERCEPTIBLE
    }

    fn singularities(&self) -> &'static [&'static str] {
        J::SINGULARITIES
    }

    fn parameters(&self, visit: &mut dyn FnMut(&'static str, f64)) {
        for (name, value) in self.0.parameters() {
            visit(name, value);
        }
    }

    fn home(&self, q: &mut [f64]) {
        store(&self.0.home(), q);
    }

    fn pose(&self, q: &[f64]) -> Pose<f64> {
        self.0.pose(&vector(q))
    }

    fn twist_map(&self, q: &[f64], out: &mut [f64]) {
        store(&self.0.twist_map(&vector(q)), out);
    }

    fn twist_map_child(&self, q: &[f64], out: &mut [f64]) {
        store(&self.0.twist_map_child(&vector(q)), out);
    }

    fn twist_map_child_gradient(&self, q: &[f64], out: &mut [f64]) {
        store_slices(&self.0.twist_map_child_gradient(&vector(q)), out);
    }

    fn velocity_map(&self, q: &[f64], out: &mut [f64]) {
        store(&self.0.velocity_map(&vector(q)), out);
    }

    fn velocity_map_inverse(&self, q: &[f64], out: &mut [f64]) {
        store(&self.0.velocity_map_inverse(&vector(q)), out);
    }

    fn velocity_map_gradient(&self, q: &[f64], out: &mut [f64]) {
        store_slices(&self.0.velocity_map_gradient(&vector(q)), out);
    }

    fn gamma(&self, q: &[f64], v: &[f64], out: &mut [f64]) {
        store(&self.0.gamma(&vector(q), &vector(v)), out);
    }

    fn j22(&self, q: &[f64], p: &[f64], out: &mut [f64]) {
        store(&self.0.j22(&vector(q), &vector(p)), out);
    }

    fn constraint(&self, q: &[f64], out: &mut [f64]) {
        store(&self.0.constraint(&vector(q)), out);
    }

    fn speed_basis(&self, q: &[f64], out: &mut [f64]) {
        store(&self.0.speed_basis(&vector(q)), out);
    }

    fn speed_basis_gradient(&self, q: &[f64], out: &mut [f64]) {
        store_slices(&self.0.speed_basis_gradient(&vector(q)), out);
    }

    fn configuration_rate(&self, q: &[f64], v: &[f64], out: &mut [f64]) {
        store(&self.0.configuration_rate(&vector(q), &vector(v)), out);
    }

    fn retract(&self, q: &[f64], phi: &[f64], out: &mut [f64]) {
        store(&self.0.retract(&vector(q), &vector(phi)), out);
    }

    fn local(&self, q: &[f64], target: &[f64], phi: &mut [f64]) -> Result<(), FiniteMapError> {
        store(&self.0.local(&vector(q), &vector(target)), phi);
        check_finite(J::NAME, "local coordinates", phi, K)
    }

    fn retract_differential(&self, q: &[f64], phi: &[f64], out: &mut [f64]) {
        store(&self.0.retract_differential(&vector(q), &vector(phi)), out);
    }

    fn retract_differential_inverse(&self, q: &[f64], phi: &[f64], rate: &[f64], out: &mut [f64]) {
        let result = self
            .0
            .retract_differential_inverse(&vector(q), &vector(phi), &vector(rate));
        store(&result, out);
    }

    fn local_rate(&self, q: &[f64], phi: &[f64], moved: &[f64], speeds: &[f64], out: &mut [f64]) {
        let (joint, structures) = (&self.0, J::STRUCTURES);
        let moved = vector(moved);
        let velocity: SVector<f64, K> = match structures.speed_basis.is_identity() {
            true => vector(speeds),
            false => joint.speed_basis(&moved) * vector::<S>(speeds),
        };
        let rate = match structures.velocity_map.is_identity() {
            true => velocity,
            false => joint.velocity_map_inverse(&moved) * velocity,
        };
        let local_rate = match structures.retract_differential.is_identity() {
            true => rate,
            false => joint.retract_differential_inverse(&vector(q), &vector(phi), &rate),
        };
        store(&local_rate, out);
    }

    fn project(&self, q: &mut [f64]) -> Result<(), FiniteMapError> {
        store(&self.0.project(&vector(q)), q);
        check_finite(J::NAME, "projection", q, N)
    }

    fn residual(&self, q: &[f64]) -> f64 {
        self.0.residual(&vector(q))
    }

    fn singularity(&self, q: &[f64]) -> f64 {
        self.0.singularity(&vector(q))
    }

    fn bias_acceleration(&self, q: &[f64], speeds: &[f64]) -> Vector6<f64> {
        self.0.bias_acceleration(&vector(q), &vector(speeds))
    }

    fn bias_momentum(&self, q: &[f64], speeds: &[f64], h: &Vector6<f64>, out: &mut [f64]) {
        store(&self.0.bias_momentum(&vector(q), &vector(speeds), h), out);
    }

    fn local_twist_map(&self, q: &[f64], out: &mut [f64]) {
        store(&self.0.local_twist_map(&vector(q)), out);
    }

    fn twist_gradient(&self, q: &[f64], speeds: &[f64], out: &mut [f64]) {
        store(&self.0.twist_gradient(&vector(q), &vector(speeds)), out);
    }

    fn effort_gradient(&self, q: &[f64], h: &Vector6<f64>, out: &mut [f64]) {
        store(&self.0.effort_gradient(&vector(q), h), out);
    }

    fn twist_map_rate(&self, q: &[f64], speeds: &[f64], out: &mut [f64]) {
        store(&self.0.twist_map_rate(&vector(q), &vector(speeds)), out);
    }

    fn bias_acceleration_gradient(&self, q: &[f64], speeds: &[f64], out: &mut [f64]) {
        let (q, speeds) = (vector(q), vector(speeds));
        store(&self.0.bias_acceleration_gradient(&q, &speeds), out);
    }

    fn bias_acceleration_slope(&self, q: &[f64], speeds: &[f64], out: &mut [f64]) {
        let (q, speeds) = (vector(q), vector(speeds));
        store(&self.0.bias_acceleration_slope(&q, &speeds), out);
    }

    fn bias_momentum_gradient(&self, q: &[f64], speeds: &[f64], h: &Vector6<f64>, out: &mut [f64]) {
        let (q, speeds) = (vector(q), vector(speeds));
        store(&self.0.bias_momentum_gradient(&q, &speeds, h), out);
    }

    fn bias_momentum_slope(&self, q: &[f64], h: &Vector6<f64>, out: &mut [f64]) {
        store(&self.0.bias_momentum_slope(&vector(q), h), out);
    }
}
