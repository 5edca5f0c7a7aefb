//! What an element sees of a mechanism, and how it acts on it.

use crate::erased::AnyJoint;
use crate::mechanism::Mechanism;
use crate::spatial::fused::{add_cross, apply, cross};
use crate::spatial::{Pose, split};
use crate::steps::Placement;
use alloc::vec::Vec;
use core::fmt::Debug;
use nalgebra::{Vector3, Vector6};

/// Placements and twists of the joints' child frames, by body; twists at those frames' origins, in world axes.
pub trait Motions {
    /// Placement of a body's joint-child frame.
    fn placement(&self, body: usize) -> &Placement<f64>;
    /// Its twist.
    fn twist(&self, body: usize) -> &Vector6<f64>;
}

/// Placements and twists in a list of their own.
#[derive(Clone, Debug)]
pub(crate) struct MotionList(pub(crate) Vec<(Placement<f64>, Vector6<f64>)>);

impl Motions for MotionList {
    fn placement(&self, body: usize) -> &Placement<f64> {
        &self.0[body].0
    }

    fn twist(&self, body: usize) -> &Vector6<f64> {
        &self.0[body].1
    }
}

/// A mechanism at one state.
pub struct View<'a> {
    /// The mechanism.
    pub mechanism: &'a Mechanism,
    /// Q of all joints.
    pub configuration: &'a [f64],
    /// v̄ of all joints.
    pub speeds: &'a [f64],
    /// Where the bodies are and how they move.
    pub motions: &'a dyn Motions,
}

impl Debug for View<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("View")
            .field("configuration", &self.configuration)
            .field("speeds", &self.speeds)
            .finish_non_exhaustive()
    }
}

impl<'a> View<'a> {
    /// The joint under a body.
    pub fn joint(&self, body: usize) -> &'a dyn AnyJoint {
        self.mechanism.bodies()[body].joint()
    }

    /// Its Q.
    pub fn joint_configuration(&self, body: usize) -> &'a [f64] {
        self.mechanism.bodies()[body].configuration(self.configuration)
    }

    /// Its velocity `v = S̄ v̄`, in the first entries of `buffer`.
    pub fn joint_velocity<'b>(&self, body: usize, buffer: &'b mut [f64; 6]) -> &'b [f64] {
        let ranges = self.mechanism.bodies()[body].ranges();
        let speeds = &self.speeds[ranges.speeds.clone()];
        let joint = self.joint(body);
        let velocity = &mut buffer[..ranges.freedoms.len()];
        if joint.structures().speed_basis.is_identity() {
            velocity.copy_from_slice(speeds);
            return velocity;
        }
        let mut basis = [0.0; 36];
        let basis = &mut basis[..velocity.len() * speeds.len()];
        joint.speed_basis(self.joint_configuration(body), basis);
        for (i, entry) in velocity.iter_mut().enumerate() {
            let row = basis.iter().skip(i).step_by(ranges.freedoms.len());
            *entry = row.zip(speeds).map(|(b, v)| b * v).sum();
        }
        velocity
    }

    /// The body frame in the world; the world itself for `None`.
    pub fn pose(&self, body: Option<usize>) -> Pose<f64> {
        let Some(body) = body else {
            return Pose::identity();
        };
        let placement = self.motions.placement(body).pose();
        placement.compose(self.mechanism.bodies()[body].child_placement())
    }

    /// From the origin of the joint-child frame to a point given in the body frame, world axes, m.
    pub fn arm(&self, body: usize, point: &Vector3<f64>) -> Vector3<f64> {
        let fixed = self.mechanism.bodies()[body].child_placement();
        apply(
            &self.motions.placement(body).rotation,
            &fixed.transform_point(point),
        )
    }

    /// Position and velocity of a point given in the body frame (in the world for `None`), world axes, m and m/s.
    pub fn point(&self, body: Option<usize>, point: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let Some(body) = body else {
            return (*point, Vector3::zeros());
        };
        let arm = self.arm(body, point);
        let (angular, linear) = split(self.motions.twist(body));
        let position = self.motions.placement(body).origin + arm;
        (position, add_cross(&linear, &angular, &arm))
    }
}

/// Where elements put what they exert.
#[derive(Debug)]
pub struct Action<'a> {
    /// Wrench on each body at the origin of its joint-child frame, world axes.
    pub(crate) wrenches: &'a mut [Vector6<f64>],
    /// τ, one entry a freedom.
    pub(crate) efforts: &'a mut [f64],
}

impl Action<'_> {
    /// Adds efforts of the joint under a body, one entry a freedom.
    pub fn add_effort(&mut self, view: &View<'_>, body: usize, effort: &[f64]) {
        let range = view.mechanism.bodies()[body].ranges().freedoms.clone();
        for (sum, value) in self.efforts[range].iter_mut().zip(effort) {
            *sum += value;
        }
    }

    /// Adds a force (world axes, N) on a body, at the end of an `arm` of [`View::arm`].
    pub fn add_force(&mut self, body: usize, arm: &Vector3<f64>, force: &Vector3<f64>) {
        self.add_wrench(body, &cross(arm, force), force);
    }

    /// Adds a wrench on a body at the origin of its joint-child frame, world axes.
    pub fn add_wrench(&mut self, body: usize, moment: &Vector3<f64>, force: &Vector3<f64>) {
        self.wrenches[body] += crate::spatial::join(moment, force);
    }
}
