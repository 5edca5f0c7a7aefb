//! What can be read off a mechanism at one state: poses, twists, energies, momenta, and the Jacobians of [`Frame`]s.
//!
//! [`Readings`] borrow the workspace in which the state has been placed, so that nothing is read of a state that has gone.

use super::Recursive;
use crate::mechanism::StateError;
use crate::spatial::fused::{apply, apply_transposed, dot};
use crate::spatial::{Pose, join, shift_twist, shift_wrench, split};
use nalgebra::{Vector3, Vector6};

/// Where and in which axes a body's twist, wrench or Jacobian is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// At the origin of the body frame, in body axes.
    Body,
    /// At the world's origin, in world axes.
    World,
    /// At the origin of the body frame, in world axes.
    WorldAligned,
}

/// A mechanism at one state; nothing here allocates.
#[derive(Clone, Copy, Debug)]
pub struct Readings<'a> {
    pub(super) recursive: &'a Recursive,
}

impl Recursive {
    /// Places all bodies at `q`, moving with v̄ = `speeds`, for reading.
    ///
    /// # Errors
    /// When a vector has the wrong size.
    pub fn readings(&mut self, q: &[f64], speeds: &[f64]) -> Result<Readings<'_>, StateError> {
        self.check(q, &[("speeds", speeds.len())])?;
        self.weigh(q);
        self.set_twists(speeds);
        Ok(Readings { recursive: self })
    }
}

impl Readings<'_> {
    /// The body frame of `body` in the world.
    ///
    /// # Errors
    /// When there is no such body.
    pub fn pose(&self, body: usize) -> Result<Pose<f64>, StateError> {
        let child_placement = self.recursive.mechanism.body(body)?.child_placement();
        Ok(self.recursive.nodes[body].motion.placement.pose() * *child_placement)
    }

    /// The twist of `body` relative to the world.
    ///
    /// # Errors
    /// When there is no such body.
    pub fn twist(&self, body: usize, frame: Frame) -> Result<Vector6<f64>, StateError> {
        let pose = self.pose(body)?;
        let twist = &self.recursive.nodes[body].motion.twist;
        Ok(read(frame, &pose, &self.arm(body)?, twist))
    }

    /// From the origin of the joint's child frame to that of the body frame, world axes.
    pub(super) fn arm(&self, body: usize) -> Result<Vector3<f64>, StateError> {
        let child_placement = self.recursive.mechanism.body(body)?.child_placement();
        let rotation = &self.recursive.nodes[body].motion.placement.rotation;
        Ok(apply(rotation, &child_placement.translation))
    }

    /// Kinetic energy, J.
    pub fn kinetic_energy(&self) -> f64 {
        let nodes = self.recursive.nodes.iter();
        let twice = nodes.map(|node| {
            let twist = &node.motion.twist;
            let ((turn, slide), (moment, force)) = (split(twist), split(&node.rigid.apply(twist)));
            dot(&turn, &moment) + dot(&slide, &force)
        });
        0.5 * twice.sum::<f64>()
    }

    /// Potential energy in gravity, zero at the world's origin, J.
    pub fn potential_energy(&self) -> f64 {
        self.recursive.potential_energy_here()
    }

    /// Mass of all bodies, kg.
    pub fn mass(&self) -> f64 {
        self.recursive
            .nodes
            .iter()
            .map(|node| node.rigid.mass)
            .sum()
    }

    /// Centre of mass of all bodies, world axes, m; the origin when nothing has mass.
    pub fn center_of_mass(&self) -> Vector3<f64> {
        let mass = self.mass();
        let nodes = self.recursive.nodes.iter();
        let moments = nodes
            .map(|node| node.rigid.first_moment + node.motion.placement.origin * node.rigid.mass);
        let moment: Vector3<f64> = moments.sum();
        if mass > 0.0 { moment / mass } else { moment }
    }

    /// Momentum of all bodies about their common centre of mass, world axes: (angular, kg m²/s; linear, kg m/s).
    pub fn momentum_com(&self) -> Vector6<f64> {
        let center = self.center_of_mass();
        let nodes = self.recursive.nodes.iter();
        let momenta = nodes.map(|node| {
            let momentum = node.rigid.apply(&node.motion.twist);
            shift_wrench(&momentum, &(node.motion.placement.origin - center))
        });
        momenta.sum()
    }
}

/// A twist in world axes, read at a point with the body's origin `arm` away, as `frame` has it.
pub(super) fn read(
    frame: Frame,
    pose: &Pose<f64>,
    arm: &Vector3<f64>,
    twist: &Vector6<f64>,
) -> Vector6<f64> {
    match frame {
        Frame::WorldAligned => shift_twist(twist, arm),
        Frame::World => shift_twist(twist, &(arm - pose.translation)),
        Frame::Body => {
            let (angular, linear) = split(&shift_twist(twist, arm));
            join(
                &apply_transposed(&pose.rotation, &angular),
                &apply_transposed(&pose.rotation, &linear),
            )
        }
    }
}
