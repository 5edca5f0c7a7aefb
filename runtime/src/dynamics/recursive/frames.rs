//! What can be read off one frame at one state: its pose and twist, the acceleration that its speeds give it, and how these change with ϕ.
//!
//! All of it is O(depth): a walk from the frame's body to the root.

use super::Recursive;
use super::inverse::MOST_FREEDOMS;
use super::readings::{Frame, Readings};
use crate::mechanism::{StateError, WHOLE, check_size};
use crate::spatial::fused::{apply, cross};
use crate::spatial::{
    Pose, bracket_product, join, shift_twist, shift_wrench, split, turn_back, turn_out,
};
use crate::steps::Variation;
use nalgebra::{Vector3, Vector6};

/// A frame of a mechanism at one state: that of a body ([`Readings::body_frame`]) or a named one ([`Readings::frame`]); nothing here allocates.
#[derive(Clone, Copy, Debug)]
pub struct FrameReadings<'a> {
    pub(super) recursive: &'a Recursive,
    pub(super) q: &'a [f64],
    pub(super) speeds: &'a [f64],
    /// The body that carries the frame; `None` is the world.
    pub(super) body: Option<usize>,
    /// The frame in the child frame of the body's joint, or in the world.
    pub(super) fixed: Pose<f64>,
}

impl<'a> Readings<'a> {
    /// The frame of `body`.
    ///
    /// # Errors
    /// When there is no such body.
    pub fn body_frame(&self, body: usize) -> Result<FrameReadings<'a>, StateError> {
        let fixed = *self.recursive.mechanism.body(body)?.child_placement();
        Ok(self.attached(Some(body), fixed))
    }

    /// The named frame of that index, [`Mechanism::frame_index`](crate::mechanism::Mechanism::frame_index).
    ///
    /// # Errors
    /// When there is no such frame.
    pub fn frame(&self, index: usize) -> Result<FrameReadings<'a>, StateError> {
        let (body, fixed) = self.recursive.attachment(index)?;
        Ok(self.attached(body, fixed))
    }

    fn attached(&self, body: Option<usize>, fixed: Pose<f64>) -> FrameReadings<'a> {
        FrameReadings {
            recursive: self.recursive,
            q: self.q,
            speeds: self.speeds,
            body,
            fixed,
        }
    }
}

impl Recursive {
    /// The body of a named frame, and its pose in the child frame of that body's joint.
    pub(super) fn attachment(
        &self,
        index: usize,
    ) -> Result<(Option<usize>, Pose<f64>), StateError> {
        let frames = self.mechanism.frames();
        let frame = frames.get(index).ok_or(StateError::UnknownFrame {
            index,
            count: frames.len(),
        })?;
        Ok(match frame.body {
            Some(body) => {
                let placement = self.mechanism.body(body)?.child_placement();
                (Some(body), *placement * frame.at)
            }
            None => (None, frame.at),
        })
    }
}

impl FrameReadings<'_> {
    /// The frame in the world.
    pub fn pose(&self) -> Pose<f64> {
        match self.body {
            Some(body) => self.recursive.nodes[body].motion.placement.pose() * self.fixed,
            None => self.fixed,
        }
    }

    /// The frame's twist relative to the world.
    pub fn twist(&self, axes: Frame) -> Vector6<f64> {
        match self.body {
            Some(body) => {
                let twist = &self.recursive.nodes[body].motion.twist;
                read(axes, &self.pose(), &self.arm(), twist)
            }
            None => Vector6::zeros(),
        }
    }

    /// `J̇ v̄`: the rate of the frame's twist, read in these axes, where v̄̇ = 0.
    ///
    /// In [`Frame::WorldAligned`] it holds the acceleration of the frame's origin; in [`Frame::World`] and [`Frame::Body`] rates of 6-vectors, whose
    /// linear parts are none of a point's.
    pub fn jacobian_rate_product(&self, axes: Frame) -> Vector6<f64> {
        let pose = self.pose();
        let mut rate = Vector6::zeros();
        for (index, arm) in self.path() {
            rate += read(axes, &pose, &arm, &self.own_bias(index));
        }
        if axes == Frame::WorldAligned {
            // The frame's origin moves through the field of velocities.
            let (turn, slide) = split(&self.twist(axes));
            rate += join(&Vector3::zeros(), &cross(&turn, &slide));
        }
        rate
    }

    /// `c + ad_V X̄ v̄` of one joint.
    fn own_bias(&self, index: usize) -> Vector6<f64> {
        let (link, node) = (&self.recursive.links[index], &self.recursive.nodes[index]);
        let speeds = &self.speeds[link.speeds.clone()];
        let columns = &self.recursive.columns[link.columns.clone()];
        let columns = columns.iter().zip(speeds);
        let relative = columns.fold(Vector6::zeros(), |sum, (x, v)| sum + x * *v);
        let mut bias = bracket_product(&node.motion.twist, &relative);
        if !link.joint.structures().bias_acceleration.is_zero() {
            let own = link
                .joint
                .bias_acceleration(&self.q[link.configuration.clone()], speeds);
            bias += turn_out(&node.motion.placement.rotation, &own);
        }
        bias
    }

    /// The 6×K matrix of the frame's displacements under a unit of each local coordinate ϕ (at ϕ = 0), twists as of J, into `out`: column by column,
    /// one per degree of freedom.
    ///
    /// # Errors
    /// When `out` has not six entries per degree of freedom.
    pub fn local_jacobian(&self, axes: Frame, out: &mut [f64]) -> Result<(), StateError> {
        let pose = self.pose();
        self.fill_locals(out, |variation, arm| {
            read(axes, &pose, arm, &variation.local)
        })
    }

    /// `∂(J v̄)/∂ϕ` at fixed v̄: the derivatives of [`FrameReadings::twist`] into `out`, column by column, one per degree of freedom.
    ///
    /// # Errors
    /// When `out` has not six entries per degree of freedom.
    pub fn twist_gradient(&self, axes: Frame, out: &mut [f64]) -> Result<(), StateError> {
        let (pose, twist) = (self.pose(), self.twist(axes));
        self.fill_locals(out, |variation, arm| {
            let drift = read(axes, &pose, arm, &variation.drift);
            let turned = match axes {
                // Axes and origin go along.
                Frame::Body => return drift,
                Frame::World => bracket_product(&read(axes, &pose, arm, &variation.local), &twist),
                Frame::WorldAligned => {
                    let (turn, _) = split(&variation.local);
                    let (angular, linear) = split(&twist);
                    join(&cross(&turn, &angular), &cross(&turn, &linear))
                }
            };
            drift + turned
        })
    }

    /// One column a degree of freedom of the joints on the way to the root, zero for the others.
    fn fill_locals(
        &self,
        out: &mut [f64],
        column: impl Fn(&Variation<f64>, &Vector3<f64>) -> Vector6<f64>,
    ) -> Result<(), StateError> {
        let freedoms = self.recursive.mechanism.layout().freedoms;
        check_size(WHOLE, "derivative in phi", 6 * freedoms, out.len())?;
        out.fill(0.0);
        for (index, arm) in self.path() {
            let own = self.recursive.links[index].freedoms.clone();
            let mut variations = [Variation::zero(); MOST_FREEDOMS];
            let variations = &mut variations[..own.len()];
            self.recursive
                .vary(index, (self.q, self.speeds, &[]), variations);
            for (freedom, variation) in own.zip(variations.iter()) {
                let column = column(variation, &arm);
                out[6 * freedom..6 * freedom + 6].copy_from_slice(column.as_slice());
            }
        }
        Ok(())
    }

    /// From the origin of the joint's child frame to that of the frame, world axes.
    fn arm(&self) -> Vector3<f64> {
        match self.body {
            Some(body) => {
                let rotation = &self.recursive.nodes[body].motion.placement.rotation;
                apply(rotation, &self.fixed.translation)
            }
            None => self.fixed.translation,
        }
    }

    /// The joints between the frame and the root, with the way from the origin of each one's child frame to the frame's.
    pub(super) fn path(&self) -> impl Iterator<Item = (usize, Vector3<f64>)> {
        let first = self.body.map(|body| (body, self.arm()));
        core::iter::successors(first, |(index, arm)| {
            let offset = &self.recursive.nodes[*index].motion.placement.offset;
            let parent = self.recursive.links[*index].parent?;
            Some((parent, arm + offset))
        })
    }

    /// A wrench in world axes, about the frame's origin.
    pub(super) fn at_origin(&self, axes: Frame, wrench: &Vector6<f64>) -> Vector6<f64> {
        let pose = self.pose();
        match axes {
            Frame::WorldAligned => *wrench,
            Frame::World => shift_wrench(wrench, &-pose.translation),
            Frame::Body => turn_out(&pose.rotation, wrench),
        }
    }
}

/// A twist in world axes, read at a point with the frame's origin `arm` away, as `axes` has it.
pub(super) fn read(
    axes: Frame,
    pose: &Pose<f64>,
    arm: &Vector3<f64>,
    twist: &Vector6<f64>,
) -> Vector6<f64> {
    match axes {
        Frame::WorldAligned => shift_twist(twist, arm),
        Frame::World => shift_twist(twist, &(arm - pose.translation)),
        Frame::Body => turn_back(&pose.rotation, &shift_twist(twist, arm)),
    }
}
