//! What can be read off a mechanism at one state: poses, twists, energies, momenta, and the Jacobians of [`Frame`]s.
//!
//! [`Readings`] borrow the workspace in which the state has been placed, so that nothing is read of a state that has gone.

use super::Recursive;
use crate::mechanism::StateError;
use crate::spatial::fused::dot;
use crate::spatial::{Pose, shift_wrench, split};
use nalgebra::{Vector3, Vector6};

/// Where and in which axes the twist, wrench or Jacobian of a frame is read: of the frame of a body, or of a named one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// At the frame's origin, in its own axes; elsewhere called local.
    Body,
    /// At the world's origin, in world axes.
    World,
    /// At the frame's origin, in world axes.
    WorldAligned,
}

/// A mechanism at one state; nothing here allocates.
#[derive(Clone, Copy, Debug)]
pub struct Readings<'a> {
    pub(super) recursive: &'a Recursive,
    /// Q of all joints.
    pub(super) q: &'a [f64],
    /// v̄ of all joints.
    pub(super) speeds: &'a [f64],
}

impl Recursive {
    /// Places all bodies at `q`, moving with v̄ = `speeds`, for reading.
    ///
    /// # Errors
    /// When a vector has the wrong size, or is not finite.
    pub fn readings<'a>(
        &'a mut self,
        q: &'a [f64],
        speeds: &'a [f64],
    ) -> Result<Readings<'a>, StateError> {
        self.check(q, &[("speeds", speeds)])?;
        self.weigh(q);
        self.set_twists(speeds);
        Ok(Readings {
            recursive: self,
            q,
            speeds,
        })
    }
}

impl Readings<'_> {
    /// The body frame of `body` in the world.
    ///
    /// # Errors
    /// When there is no such body.
    pub fn pose(&self, body: usize) -> Result<Pose<f64>, StateError> {
        Ok(self.body_frame(body)?.pose())
    }

    /// The twist of `body` relative to the world.
    ///
    /// # Errors
    /// When there is no such body.
    pub fn twist(&self, body: usize, frame: Frame) -> Result<Vector6<f64>, StateError> {
        Ok(self.body_frame(body)?.twist(frame))
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
