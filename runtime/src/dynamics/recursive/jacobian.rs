//! Geometric Jacobians, speeds to twists, and their products with vectors; the map from speeds to the momentum about the centre of mass.

use super::Recursive;
use super::readings::{Frame, Readings, read};
use crate::mechanism::{StateError, WHOLE, check_size};
use crate::spatial::fused::{apply, dot};
use crate::spatial::{join, shift_wrench, split};
use nalgebra::{Vector3, Vector6};

impl Readings<'_> {
    /// The 6×S̄ matrix that takes v̄ to the twist of `body` into `out`, column by column, one a speed.
    ///
    /// # Errors
    /// When there is no such body; when `out` has not six entries a speed.
    pub fn jacobian(&self, body: usize, frame: Frame, out: &mut [f64]) -> Result<(), StateError> {
        let speeds = self.recursive.mechanism.layout().speeds;
        check_size(WHOLE, "Jacobian", 6 * speeds, out.len())?;
        let pose = self.pose(body)?;
        out.fill(0.0);
        self.climb(body, |speed, arm, column| {
            let seen = read(frame, &pose, arm, column);
            out[6 * speed..6 * speed + 6].copy_from_slice(seen.as_slice());
        })
    }

    /// The Jacobian of `body` times `weights`, one a speed: the twist under these speeds.
    ///
    /// # Errors
    /// When there is no such body; when `weights` has the wrong size.
    pub fn jacobian_product(
        &self,
        body: usize,
        frame: Frame,
        weights: &[f64],
    ) -> Result<Vector6<f64>, StateError> {
        let speeds = self.recursive.mechanism.layout().speeds;
        check_size(WHOLE, "speeds", speeds, weights.len())?;
        let pose = self.pose(body)?;
        let mut twist = Vector6::zeros();
        self.climb(body, |speed, arm, column| {
            twist += read(frame, &pose, arm, column) * weights[speed];
        })?;
        Ok(twist)
    }

    /// The transposed Jacobian of `body` times a `wrench` on it into `efforts`, one a speed: what the wrench does to the speeds.
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
        let speeds = self.recursive.mechanism.layout().speeds;
        check_size(WHOLE, "efforts", speeds, efforts.len())?;
        let (moment, force) = split(&self.at_body_origin(body, frame, wrench)?);
        efforts.fill(0.0);
        self.climb(body, |speed, arm, column| {
            let (turn, slide) = split(column);
            // Power at the body's origin: its velocity is `slide + turn × arm`.
            let velocity = slide + turn.cross(arm);
            efforts[speed] = dot(&turn, &moment) + dot(&velocity, &force);
        })
    }

    /// A wrench on `body` in world axes, about the origin of the body frame.
    fn at_body_origin(
        &self,
        body: usize,
        frame: Frame,
        wrench: &Vector6<f64>,
    ) -> Result<Vector6<f64>, StateError> {
        let pose = self.pose(body)?;
        let (moment, force) = split(wrench);
        Ok(match frame {
            Frame::WorldAligned => *wrench,
            Frame::World => shift_wrench(wrench, &-pose.translation),
            Frame::Body => join(
                &apply(&pose.rotation, &moment),
                &apply(&pose.rotation, &force),
            ),
        })
    }

    /// Hands every speed between `body` and the root to `visit`, with its column of X̄ and the way from that column's origin to
    /// the body's.
    fn climb(
        &self,
        body: usize,
        mut visit: impl FnMut(usize, &Vector3<f64>, &Vector6<f64>),
    ) -> Result<(), StateError> {
        let recursive = self.recursive;
        let mut arm = self.arm(body)?;
        let mut next = Some(body);
        while let Some(index) = next {
            let link = &recursive.links[index];
            for speed in link.speeds.clone() {
                visit(speed, &arm, &recursive.columns[speed]);
            }
            arm += recursive.nodes[index].motion.placement.offset;
            next = link.parent;
        }
        Ok(())
    }
}

impl Recursive {
    /// The 6×S̄ matrix that takes v̄ to the momentum of all bodies about their common centre of mass into `out`, column by column,
    /// world axes, (angular; linear).
    ///
    /// # Errors
    /// When `q` has the wrong size; when `out` has not six entries a speed.
    pub fn centroidal_map(&mut self, q: &[f64], out: &mut [f64]) -> Result<(), StateError> {
        self.check(q, &[])?;
        let speeds = self.mechanism.layout().speeds;
        check_size(WHOLE, "centroidal map", 6 * speeds, out.len())?;
        self.weigh(q);
        let center = Readings { recursive: self }.center_of_mass();
        self.compose();
        for (link, node) in self.links.iter().zip(&self.nodes) {
            let speeds = link.speeds.clone();
            let (columns, momenta) = (
                &self.columns[speeds.clone()],
                &mut self.momenta[speeds.clone()],
            );
            link.joint.momenta(&node.rigid, columns, momenta);
            let out = out[6 * speeds.start..6 * speeds.end].chunks_exact_mut(6);
            for (out, momentum) in out.zip(momenta) {
                let seen = shift_wrench(momentum, &(node.motion.placement.origin - center));
                out.copy_from_slice(seen.as_slice());
            }
        }
        Ok(())
    }
}
