//! The trait [`AnyJoint`]: what a mechanism knows of a joint.

use super::kernels::{declared, kernels};
use super::{ExtendedJoint, FiniteMapError, Layout, Shared};
#[cfg(doc)]
use crate::joint::{Joint, Products};
use crate::joint::{Pin, Port, PortLaw, Structures, Units, VelocityFrame};
use crate::spatial::{ArticulatedInertia, Pose, SpatialInertia};
use crate::steps::{
    Carrying, ChartDerivatives, EffortLaw, Motion, MotionGradient, Pivot, PivotFailure, Placement,
    RotorTerm, Variation,
};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::fmt::Debug;
use nalgebra::{Matrix3, Vector6};

/// A joint of any type, in doubles.
///
/// With (N, K, S, C) of [`AnyJoint::layout`], shapes, units and frames are as in [`Joint`]. The caller hands over slices of exactly these
/// sizes; of any other every result is NaN, or an error where there can be one. What does not depend on an argument does not look at it.
///
/// The methods from [`AnyJoint::parts`] on are the joint's share in the recursions over a mechanism, in the frames of
/// [`steps`](crate::steps). There `columns` are those of X̄, and pivots, loads and rates have one entry per speed.
pub trait AnyJoint: Debug + Send + Sync {
    /// The same joint in numbers of 106 bits.
    fn extended(self: Arc<Self>) -> Arc<dyn ExtendedJoint>;

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
    fn home(&self, out: &mut [f64]);
    /// [`Joint::configuration_rate`] into `out` (N).
    fn configuration_rate(&self, q: &[f64], v: &[f64], out: &mut [f64]);
    /// [`Joint::retract`] into `out` (N).
    fn retract(&self, q: &[f64], phi: &[f64], out: &mut [f64]);
    kernels!(declared);

    /// [`Joint::pose`].
    fn pose(&self, q: &[f64]) -> Pose<f64>;
    /// [`Joint::residual`].
    fn residual(&self, q: &[f64]) -> f64;
    /// [`Joint::singularity`].
    fn singularity(&self, q: &[f64]) -> f64;
    /// [`Joint::bias_acceleration`].
    fn bias_acceleration(&self, q: &[f64], speeds: &[f64]) -> Vector6<f64>;
    /// [`Joint::local`] into `phi` (K).
    ///
    /// # Errors
    /// When ϕ is not finite: Newton's method did not converge, or a configuration is not finite.
    fn local(&self, q: &[f64], target: &[f64], phi: &mut [f64]) -> Result<(), FiniteMapError>;
    /// [`Joint::project`] in place.
    ///
    /// # Errors
    /// When the result is not finite, as for [`AnyJoint::local`].
    fn project(&self, q: &mut [f64]) -> Result<(), FiniteMapError>;
    /// `ϕ̇ = D⁻¹ S₀⁻¹ S̄ v̄` at `moved`, which is Φ(Q, ϕ), into `out` (K): D is the differential of Φ at (Q, ϕ), S₀ and S̄ are those at `moved`.
    fn local_rate(&self, q: &[f64], phi: &[f64], moved: &[f64], speeds: &[f64], out: &mut [f64]);
    /// `S̄ᵀ τ` into `out` (S), for efforts τ (K).
    fn reduce_efforts(&self, q: &[f64], efforts: &[f64], out: &mut [f64]);
    /// The value of one port, [`Joint::port_values`]; NaN of a port that is not there.
    fn port_value(&self, q: &[f64], port: usize) -> f64;
    /// The row of P of one port into `out` (K); NaN of a port that is not there.
    fn port_row(&self, q: &[f64], port: usize, out: &mut [f64]);
    /// How the row p̄ = P S̄ of one port changes with time at v̄, into `out` (S); NaN of a port that is not there.
    fn port_row_rate(&self, q: &[f64], speeds: &[f64], port: usize, out: &mut [f64]);
    /// How the row of P of one port changes with ϕ, into `out` (K×K: column k is its derivative along ϕ_k).
    fn port_row_gradient(&self, q: &[f64], port: usize, out: &mut [f64]);
    /// The derivatives in ϕ (S×K) and in v̄ (S×S), at fixed x, of what a rotor of unit inertia at a port amounts to at the `state` (q, v̄, x).
    fn rotor_term_slopes(
        &self,
        state: (&[f64], &[f64], &[f64]),
        port: usize,
        term: RotorTerm,
        by_local: &mut [f64],
        by_speeds: &mut [f64],
    );
    /// Point and axes of one pin, [`Joint::pins`]; NaN of a pin that is not there.
    fn pin_place(&self, q: &[f64], pin: usize) -> [f64; 9];
    /// What one relation forbids the body, [`Joint::relation_twists`]; NaN of a relation that is not there.
    fn relation_twist(&self, q: &[f64], relation: usize) -> Vector6<f64>;
    /// What one relation forbids a port, [`Joint::relation_ports`]; NaN of one that is not there.
    fn relation_port(&self, q: &[f64], relation: usize, port: usize) -> f64;
    /// `∂τ/∂ϕ` into `out` (K×K) at fixed v of what acts on one port by a law.
    fn port_slope(
        &self,
        q: &[f64],
        velocity: &[f64],
        port: usize,
        law: &PortLaw<f64>,
        out: &mut [f64],
    );
    /// The derivatives of Q′ and ϕ̇ at base point `base`, ϕ = `phi` and v̄ = `speeds`.
    fn differentiate(
        &self,
        base: &[f64],
        phi: &[f64],
        speeds: &[f64],
        out: &mut ChartDerivatives<'_, f64>,
    );
    /// `∂τ/∂ϕ` into `out` (K×K) of a [`JointSpring`](crate::elements::JointSpring) with this rest configuration and stiffness (K×K, by rows).
    fn spring_slope(&self, q: &[f64], rest: &[f64], stiffness: &[f64], out: &mut [f64]);
    /// `∂τ/∂ϕ` into `out` (K×K) of a [`RotationSpring`](crate::elements::RotationSpring) with this rest rotation and stiffness.
    fn turn_slope(&self, q: &[f64], rest: &Matrix3<f64>, stiffness: f64, out: &mut [f64]);
    /// The derivatives in ϕ and in v (K×K each) of `Σ_k γ_k v_k (a v)`, the velocity term of rotors with inertias a.
    fn rotor_slopes(
        &self,
        q: &[f64],
        velocity: &[f64],
        inertia: &[f64],
        by_local: &mut [f64],
        by_velocity: &mut [f64],
    );

    /// Whether the velocity of a degree of freedom moves the body at some configuration: a steering angle does not.
    fn moves_body(&self, freedom: usize) -> bool;
    /// Whether any column of X̄ has an angular part, and whether any has a linear one.
    fn parts(&self) -> (bool, bool);
    /// [`AnyJoint::parts`] of the column of one speed; none of a speed that is not there.
    fn column_parts(&self, speed: usize) -> (bool, bool);
    /// The joint's child frame, given its joint frame in the parent's child frame and that of the parent in the world.
    fn place(
        &self,
        q: &[f64],
        joint_frame: &Pose<f64>,
        parent: &Placement<f64>,
        own: &mut Placement<f64>,
    );
    /// [`AnyJoint::place`], and the columns of X̄ at the child frame's origin, in world axes.
    fn stand(
        &self,
        q: &[f64],
        joint_frame: &Pose<f64>,
        parent: &Placement<f64>,
        own: &mut Placement<f64>,
        columns: &mut [Vector6<f64>],
    );
    /// The columns of X̄ in child axes.
    fn speed_map(&self, q: &[f64], columns: &mut [Vector6<f64>]);
    /// [`AnyJoint::stand`] at the `state` (q, v̄, v̄̇); `V = V_λ + X̄ v̄` and
    /// `V̇ = V̇_λ + X̄ v̄̇ + c + ad_V X̄ v̄`. An empty v̄̇ is zero.
    fn advance(
        &self,
        state: (&[f64], &[f64], &[f64]),
        joint_frame: &Pose<f64>,
        parent: &Motion<f64>,
        own: &mut Motion<f64>,
        columns: &mut [Vector6<f64>],
    );
    /// Takes the joint's degrees of freedom out of `inertia`, which becomes what its parent feels; `armature` is added to the pivots. An empty one is zero.
    ///
    /// # Errors
    /// The first pivot that does not stand above its rounding; one of NaN where a size is another.
    fn articulate(
        &self,
        inertia: &mut ArticulatedInertia<f64>,
        columns: &[Vector6<f64>],
        armature: &[f64],
        pivots: &mut [Pivot<f64>],
    ) -> Result<(), PivotFailure<f64>>;
    /// Takes the joint's degrees of freedom out of `wrench`, which becomes what its parent feels, for generalised `forces` (momenta or
    /// efforts) of the joint; `loads` are kept for [`AnyJoint::resolve`].
    fn reduce(
        &self,
        wrench: &mut Vector6<f64>,
        columns: &[Vector6<f64>],
        pivots: &[Pivot<f64>],
        forces: &[f64],
        loads: &mut [f64],
    );
    /// [`AnyJoint::articulate`] and [`AnyJoint::reduce`] in one.
    ///
    /// # Errors
    /// As for [`AnyJoint::articulate`].
    fn eliminate(
        &self,
        carried: (&mut ArticulatedInertia<f64>, &mut Vector6<f64>),
        columns: &[Vector6<f64>],
        armature_and_forces: (&[f64], &[f64]),
        pivots: &mut [Pivot<f64>],
        loads: &mut [f64],
    ) -> Result<(), PivotFailure<f64>> {
        self.articulate(carried.0, columns, armature_and_forces.0, pivots)?;
        self.reduce(carried.1, columns, pivots, armature_and_forces.1, loads);
        Ok(())
    }
    /// The joint's `rates` (speeds or accelerations), added to the `motion` that its parent carries it along with.
    fn resolve(
        &self,
        motion: &mut Vector6<f64>,
        columns: &[Vector6<f64>],
        pivots: &[Pivot<f64>],
        loads: &[f64],
        rates: &mut [f64],
    );
    /// `N X̄` of a rigid inertia into `out`, one momentum a speed.
    fn momenta(
        &self,
        inertia: &SpatialInertia<f64>,
        columns: &[Vector6<f64>],
        out: &mut [Vector6<f64>],
    );
    /// `X̄ᵀ F` into `out`, one entry per speed.
    fn gather(&self, wrench: &Vector6<f64>, columns: &[Vector6<f64>], out: &mut [f64]);
    /// What one unit of each ϕ and speed changes at the `state` (q, v̄, v̄̇), one entry per degree of freedom; `motions` are those of the child frames of
    /// this joint and of its parent. An empty v̄̇ is zero.
    fn vary(
        &self,
        state: (&[f64], &[f64], &[f64]),
        motions: (&Motion<f64>, &Motion<f64>),
        columns: &[Vector6<f64>],
        out: &mut [Variation<f64>],
    );
    /// Second derivatives, along the joint's own ϕ and v̄ at the `state` (q, v̄, v̄̇), of a scalar function of a mechanism's motion whose `gradient` by the
    /// motion of the child frame is held fixed there: `E_l` of the products of the gradient with the variations, into `out`: by ϕ (K×K, row l, column k), by
    /// ϕ and v̄ (K×S), and by v̄ (S×S). `virtual_speeds` are μ; `carrying` is what the parent does; it and the gradient are in child axes.
    fn second_variations(
        &self,
        state: (&[f64], &[f64], &[f64]),
        virtual_speeds: &[f64],
        carrying: &Carrying<f64>,
        gradient: &MotionGradient<f64>,
        out: [&mut [f64]; 3],
    );
    /// `Σ_m g_m [S₀⁻¹ (∂S_l − E_l S₀)]_mk` into `out` (K×K, row l, column k), for g with K entries: what `E_l E_k f` lacks to be the Hessian of f(Φ(Q, ϕ))
    /// at ϕ = 0, where g_k is `E_k f`.
    fn chart_terms(&self, q: &[f64], gradient: &[f64], out: &mut [f64]);
    /// First and second derivatives at the `state` (q, v̄, v̄̇) of the power of efforts under `virtual_speeds`, into `out`: `E_k` (K), `E_l E_k` (K×K, row l,
    /// column k), by ϕ and v̄ (K×S), by v̄ (S×S), by ϕ and v̄̇ (K×S).
    fn power_hessian(
        &self,
        state: (&[f64], &[f64], &[f64]),
        virtual_speeds: &[f64],
        law: &EffortLaw<'_>,
        out: [&mut [f64]; 5],
    );
}
