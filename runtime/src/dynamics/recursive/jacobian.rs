//! Geometric Jacobians, speeds to twists, and their products with vectors; the map from speeds to the momentum about the centre of mass.

use super::Recursive;
use super::frames::{FrameReadings, read};
use super::readings::{Frame, Readings};
use crate::mechanism::{StateError, WHOLE, check_size};
use crate::spatial::fused::dot;
use crate::spatial::{shift_wrench, split};
use nalgebra::Vector6;

impl Readings<'_> {
    /// The 6×S̄ matrix that takes v̄ to the twist of `body` into `out`, column by column, one per speed.
    ///
    /// # Errors
    /// When there is no such body; when `out` has not six entries per speed.
    pub fn jacobian(&self, body: usize, frame: Frame, out: &mut [f64]) -> Result<(), StateError> {
        self.body_frame(body)?.jacobian(frame, out)
    }

    /// The Jacobian of `body` times `weights`, one per speed: the twist under these speeds.
    ///
    /// # Errors
    /// When there is no such body; when `weights` has the wrong size.
    pub fn jacobian_product(
        &self,
        body: usize,
        frame: Frame,
        weights: &[f64],
    ) -> Result<Vector6<f64>, StateError> {
        self.body_frame(body)?.jacobian_product(frame, weights)
    }

    /// The transposed Jacobian of `body` times a `wrench` on it into `efforts`, one per speed: what the wrench does to the speeds.
    ///
    /// # Errors
    /// When there is no such body; when `efforts` has the wrong size.
    pub fn jacobian_transpose_product(
        &self,
        body: usize,
        frame: Frame,
        wrench: &Vector6<f64>,
        efforts: &mut [f64],
    ) -> Result<(), StateError> {
        self.body_frame(body)?
            .jacobian_transpose_product(frame, wrench, efforts)
    }
}

impl FrameReadings<'_> {
    /// The 6×S̄ matrix J that takes v̄ to the frame's twist into `out`, column by column, one per speed.
    ///
    /// # Errors
    /// When `out` has not six entries per speed.
    pub fn jacobian(&self, axes: Frame, out: &mut [f64]) -> Result<(), StateError> {
        let speeds = self.recursive.mechanism.layout().speeds;
        check_size(WHOLE, "Jacobian", 6 * speeds, out.len())?;
        let pose = self.pose();
        out.fill(0.0);
        for (index, arm) in self.path() {
            for (speed, column) in self.recursive.columns_of(index) {
                let seen = read(axes, &pose, &arm, column);
                out[6 * speed..6 * speed + 6].copy_from_slice(seen.as_slice());
            }
        }
        Ok(())
    }

    /// `J w` for `weights` w, one per speed: the frame's twist under these speeds.
    ///
    /// # Errors
    /// When `weights` has the wrong size.
    pub fn jacobian_product(
        &self,
        axes: Frame,
        weights: &[f64],
    ) -> Result<Vector6<f64>, StateError> {
        let speeds = self.recursive.mechanism.layout().speeds;
        check_size(WHOLE, "speeds", speeds, weights.len())?;
        let pose = self.pose();
        let mut twist = Vector6::zeros();
        for (index, arm) in self.path() {
            for (speed, column) in self.recursive.columns_of(index) {
                twist += read(axes, &pose, &arm, column) * weights[speed];
            }
        }
        Ok(twist)
    }

    /// `Jᵀ W` for a `wrench` W on the frame's body into `efforts`, one per speed: what the wrench does to the speeds.
    ///
    /// # Errors
    /// When `efforts` has the wrong size.
    pub fn jacobian_transpose_product(
        &self,
        axes: Frame,
        wrench: &Vector6<f64>,
        efforts: &mut [f64],
    ) -> Result<(), StateError> {
        let speeds = self.recursive.mechanism.layout().speeds;
        check_size(WHOLE, "efforts", speeds, efforts.len())?;
        let (moment, force) = split(&self.at_origin(axes, wrench));
        efforts.fill(0.0);
        for (index, arm) in self.path() {
            for (speed, column) in self.recursive.columns_of(index) {
                let (turn, slide) = split(column);
                // Power at the frame's origin: its velocity is `slide + turn × arm`.
                let velocity = slide + turn.cross(&arm);
                efforts[speed] = dot(&turn, &moment) + dot(&velocity, &force);
            }
        }
        Ok(())
    }
}

impl Recursive {
    /// The speeds of the joint under a body, each with its column of the body's X̄.
    pub(super) fn columns_of(&self, body: usize) -> impl Iterator<Item = (usize, &Vector6<f64>)> {
        let link = &self.links[body];
        link.speeds.clone().zip(&self.columns[link.columns.clone()])
    }

    /// The 6×S̄ matrix that takes v̄ to the momentum of all bodies about their common centre of mass into `out`, column by column,
    /// world axes, (angular; linear).
    ///
    /// # Errors
    /// When `q` has the wrong size; when `out` has not six entries per speed.
    pub fn centroidal_map(&mut self, q: &[f64], out: &mut [f64]) -> Result<(), StateError> {
        self.check(q, &[])?;
        let speeds = self.mechanism.layout().speeds;
        check_size(WHOLE, "centroidal map", 6 * speeds, out.len())?;
        self.weigh(q);
        let readings = Readings {
            recursive: self,
            q,
            speeds: &[],
        };
        let center = readings.center_of_mass();
        self.compose();
        out.fill(0.0);
        for (link, node) in self.links.iter().zip(&self.nodes) {
            let speeds = link.speeds.clone();
            let out = out[6 * speeds.start..6 * speeds.end].chunks_exact_mut(6);
            for (out, momentum) in out.zip(&self.momenta[link.columns.clone()]) {
                let seen = shift_wrench(momentum, &(node.motion.placement.origin - center));
                for (sum, entry) in out.iter_mut().zip(&seen) {
                    *sum += entry;
                }
            }
        }
        Ok(())
    }
}
