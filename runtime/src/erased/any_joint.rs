//! The trait [`AnyJoint`]: what a mechanism knows of a joint.

use super::kernels::{declared, kernels};
use super::{FiniteMapError, Layout, Shared};
#[cfg(doc)]
use crate::joint::{Joint, Products};
use crate::joint::{Pin, Port, PortLaw, Structures, Units, VelocityFrame};
use crate::scalar::{Extended, Native, Scalar};
use crate::spatial::{ArticulatedInertia, Pose, SpatialInertia};
use crate::steps::{
    ChartDerivatives, Motion, Pivot, PivotFailure, Placement, RotorTerm, Variation,
};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::fmt::Debug;
use nalgebra::{Matrix3, Vector6};

/// A joint of any type in numbers T.
///
/// With (N, K, S, C) of [`AnyJoint::layout`], shapes, units and frames are as in [`Joint`]. The caller hands over slices of exactly these
/// sizes; of any other every result is NaN, or an error where there can be one. What does not depend on an argument does not look at it.
///
/// The methods from [`AnyJoint::parts`] on are the joint's share in the recursions over a mechanism, in the frames of
/// [`steps`](crate::steps). There `columns` are those of X̄, and pivots, loads and rates have one entry per speed. What solves a mechanism or
/// differentiates it is for [`Native`] numbers.
pub trait AnyJoint<T: Scalar<Mask = bool> = f64>: Debug + Send + Sync {
    /// The same joint in numbers of 106 bits.
    fn extended(self: Arc<Self>) -> Arc<dyn AnyJoint<Extended>>;

    /// Name of the spec.
    fn name(&self) -> &'static str;
    /// N, K, S and C.
    fn layout(&self) -> Layout;
    /// Names of the bodies that the joint carries, [`Joint::bodies`].
    fn bodies(&self) -> &'static [&'static str];
    /// Which of them this is the joint of, [`Joint::body`].
    fn body(&self) -> usize;
    /// The joint as each further body sees it, [`Joint::more`].
    fn more(&self) -> Vec<Shared>;
    /// Which kernels are trivial.
    fn structures(&self) -> Structures;
    /// Frame in which v is read.
    fn velocity_frame(&self) -> VelocityFrame;
    /// Names of the stored scalars of Q.
    fn coordinates(&self) -> &'static [&'static str];
    /// The declared relations, [`Joint::RELATIONS`].
    fn relations(&self) -> &'static [&'static str];
    /// Their units, [`Joint::RELATION_UNITS`].
    fn relation_units(&self) -> &'static [&'static str];
    /// What everything is measured in, [`Joint::units`].
    fn units(&self) -> Units;
    /// The ports, [`Joint::ports`].
    fn ports(&self) -> &'static [Port];
    /// The pins, [`Joint::PINS`].
    fn pins(&self) -> &'static [Pin];
    /// Names of the degrees of freedom.
    fn freedoms(&self) -> &'static [&'static str];
    /// Names of the speeds.
    fn speeds(&self) -> &'static [&'static str];
    /// Basis of the inertias that do not affect the joint, [`Joint::UNIDENTIFIABLE`].
    fn unidentifiable(&self) -> &'static [[f64; 10]];
    /// The functions whose zeros the joint must stay away from, [`Joint::SINGULARITIES`].
    fn singularities(&self) -> &'static [&'static str];
    /// Hands each parameter's name and value to `visit`.
    fn parameters(&self, visit: &mut dyn FnMut(&'static str, f64));

    /// [`Joint::home`] into `out` (N).
    fn home(&self, out: &mut [T]);
    /// [`Joint::configuration_rate`] into `out` (N).
    fn configuration_rate(&self, q: &[T], v: &[T], out: &mut [T]);
    /// [`Joint::retract`] into `out` (N).
    fn retract(&self, q: &[T], phi: &[T], out: &mut [T]);
    kernels!(declared);

    /// [`Joint::pose`].
    fn pose(&self, q: &[T]) -> Pose<T>;
    /// [`Joint::residual`].
    fn residual(&self, q: &[T]) -> T;
    /// [`Joint::singularity`].
    fn singularity(&self, q: &[T]) -> T;
    /// [`Joint::bias_acceleration`].
    fn bias_acceleration(&self, q: &[T], speeds: &[T]) -> Vector6<T>;
    /// [`Joint::local`] into `phi` (K).
    ///
    /// # Errors
    /// When ϕ is not finite: Newton's method did not converge, or a configuration is not finite.
    fn local(&self, q: &[T], target: &[T], phi: &mut [T]) -> Result<(), FiniteMapError>;
    /// [`Joint::project`] in place.
    ///
    /// # Errors
    /// When the result is not finite, as for [`AnyJoint::local`].
    fn project(&self, q: &mut [T]) -> Result<(), FiniteMapError>;
    /// `ϕ̇ = D⁻¹ S₀⁻¹ S̄ v̄` at `moved`, which is Φ(Q, ϕ), into `out` (K): D is the differential of Φ at (Q, ϕ), S₀ and S̄ are those at `moved`.
    fn local_rate(&self, q: &[T], phi: &[T], moved: &[T], speeds: &[T], out: &mut [T]);
    /// `S̄ᵀ τ` into `out` (S), for efforts τ (K).
    fn reduce_efforts(&self, q: &[T], efforts: &[T], out: &mut [T]);
    /// The value of one port, [`Joint::port_values`]; NaN of a port that is not there.
    fn port_value(&self, q: &[T], port: usize) -> T;
    /// The row of P of one port into `out` (K); NaN of a port that is not there.
    fn port_row(&self, q: &[T], port: usize, out: &mut [T]);
    /// How the row p̄ = P S̄ of one port changes with time at v̄, into `out` (S); NaN of a port that is not there.
    fn port_row_rate(&self, q: &[T], speeds: &[T], port: usize, out: &mut [T])
    where
        T: Native;
    /// How the row of P of one port changes with ϕ, into `out` (K×K: column k is its derivative along ϕ_k).
    fn port_row_gradient(&self, q: &[T], port: usize, out: &mut [T])
    where
        T: Native;
    /// The derivatives in ϕ (S×K) and in v̄ (S×S), at fixed x, of what a rotor of unit inertia at a port amounts to at the `state` (q, v̄, x).
    fn rotor_term_slopes(
        &self,
        state: (&[T], &[T], &[T]),
        port: usize,
        term: RotorTerm,
        by_local: &mut [T],
        by_speeds: &mut [T],
    ) where
        T: Native;
    /// Point and axes of one pin, [`Joint::pins`]; NaN of a pin that is not there.
    fn pin_place(&self, q: &[T], pin: usize) -> [T; 9];
    /// What one relation forbids the body, [`Joint::relation_twists`]; NaN of a relation that is not there.
    fn relation_twist(&self, q: &[T], relation: usize) -> Vector6<T>;
    /// What one relation forbids a port, [`Joint::relation_ports`]; NaN of one that is not there.
    fn relation_port(&self, q: &[T], relation: usize, port: usize) -> T;
    /// `∂τ/∂ϕ` into `out` (K×K) at fixed v of what acts on one port by a law.
    fn port_slope(&self, q: &[T], velocity: &[T], port: usize, law: &PortLaw<T>, out: &mut [T])
    where
        T: Native;
    /// The derivatives of Q′ and ϕ̇ at base point `base`, ϕ = `phi` and v̄ = `speeds`.
    fn differentiate(&self, base: &[T], phi: &[T], speeds: &[T], out: &mut ChartDerivatives<'_, T>)
    where
        T: Native;
    /// `∂τ/∂ϕ` into `out` (K×K) of a [`JointSpring`](crate::elements::JointSpring) with this rest configuration and stiffness (K×K, by rows).
    fn spring_slope(&self, q: &[T], rest: &[T], stiffness: &[T], out: &mut [T])
    where
        T: Native;
    /// `∂τ/∂ϕ` into `out` (K×K) of a [`RotationSpring`](crate::elements::RotationSpring) with this rest rotation and stiffness.
    fn turn_slope(&self, q: &[T], rest: &Matrix3<T>, stiffness: T, out: &mut [T])
    where
        T: Native;
    /// The derivatives in ϕ and in v (K×K each) of `Σ_k γ_k v_k (a v)`, the velocity term of rotors with inertias a.
    fn rotor_slopes(
        &self,
        q: &[T],
        velocity: &[T],
        inertia: &[T],
        by_local: &mut [T],
        by_velocity: &mut [T],
    ) where
        T: Native;

    /// Whether the velocity of a degree of freedom moves the body at some configuration: a steering angle does not.
    fn moves_body(&self, freedom: usize) -> bool;
    /// Whether any column of X̄ has an angular part, and whether any has a linear one.
    fn parts(&self) -> (bool, bool);
    /// [`AnyJoint::parts`] of the column of one speed; none of a speed that is not there.
    fn column_parts(&self, speed: usize) -> (bool, bool);
    /// The joint's child frame, given its joint frame in the parent's child frame and that of the parent in the world.
    fn place(&self, q: &[T], joint_frame: &Pose<T>, parent: &Placement<T>, own: &mut Placement<T>)
    where
        T: Native;
    /// [`AnyJoint::place`], and the columns of X̄ at the child frame's origin, in world axes.
    fn stand(
        &self,
        q: &[T],
        joint_frame: &Pose<T>,
        parent: &Placement<T>,
        own: &mut Placement<T>,
        columns: &mut [Vector6<T>],
    ) where
        T: Native;
    /// The columns of X̄ in child axes.
    fn speed_map(&self, q: &[T], columns: &mut [Vector6<T>])
    where
        T: Native;
    /// [`AnyJoint::stand`] at the `state` (q, v̄, v̄̇); `V = V_λ + X̄ v̄` and
    /// `V̇ = V̇_λ + X̄ v̄̇ + c + ad_V X̄ v̄`. An empty v̄̇ is zero.
    fn advance(
        &self,
        state: (&[T], &[T], &[T]),
        joint_frame: &Pose<T>,
        parent: &Motion<T>,
        own: &mut Motion<T>,
        columns: &mut [Vector6<T>],
    );
    /// Takes the joint's degrees of freedom out of `inertia`, which becomes what its parent feels; `armature` is added to the pivots. An empty one is zero.
    ///
    /// # Errors
    /// The first pivot that does not stand above its rounding; one of NaN where a size is another.
    fn articulate(
        &self,
        inertia: &mut ArticulatedInertia<T>,
        columns: &[Vector6<T>],
        armature: &[T],
        pivots: &mut [Pivot<T>],
    ) -> Result<(), PivotFailure<T>>
    where
        T: Native;
    /// Takes the joint's degrees of freedom out of `wrench`, which becomes what its parent feels, for generalised `forces` (momenta or
    /// efforts) of the joint; `loads` are kept for [`AnyJoint::resolve`].
    fn reduce(
        &self,
        wrench: &mut Vector6<T>,
        columns: &[Vector6<T>],
        pivots: &[Pivot<T>],
        forces: &[T],
        loads: &mut [T],
    ) where
        T: Native;
    /// [`AnyJoint::articulate`] and [`AnyJoint::reduce`] in one.
    ///
    /// # Errors
    /// As for [`AnyJoint::articulate`].
    fn eliminate(
        &self,
        carried: (&mut ArticulatedInertia<T>, &mut Vector6<T>),
        columns: &[Vector6<T>],
        armature_and_forces: (&[T], &[T]),
        pivots: &mut [Pivot<T>],
        loads: &mut [T],
    ) -> Result<(), PivotFailure<T>>
    where
        T: Native,
    {
        self.articulate(carried.0, columns, armature_and_forces.0, pivots)?;
        self.reduce(carried.1, columns, pivots, armature_and_forces.1, loads);
        Ok(())
    }
    /// The joint's `rates` (speeds or accelerations), added to the `motion` that its parent carries it along with.
    fn resolve(
        &self,
        motion: &mut Vector6<T>,
        columns: &[Vector6<T>],
        pivots: &[Pivot<T>],
        loads: &[T],
        rates: &mut [T],
    ) where
        T: Native;
    /// `N X̄` of a rigid inertia into `out`, one momentum a speed.
    fn momenta(&self, inertia: &SpatialInertia<T>, columns: &[Vector6<T>], out: &mut [Vector6<T>])
    where
        T: Native;
    /// `X̄ᵀ F` into `out`, one entry per speed.
    fn gather(&self, wrench: &Vector6<T>, columns: &[Vector6<T>], out: &mut [T]);
    /// What one unit of each ϕ and speed changes at the `state` (q, v̄, v̄̇), one entry per degree of freedom; `motions` are those of the child frames of
    /// this joint and of its parent. An empty v̄̇ is zero.
    fn vary(
        &self,
        state: (&[T], &[T], &[T]),
        motions: (&Motion<T>, &Motion<T>),
        columns: &[Vector6<T>],
        out: &mut [Variation<T>],
    ) where
        T: Native;
}
