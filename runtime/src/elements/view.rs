//! What an element sees of a mechanism, and how it acts on it.

use crate::erased::AnyJoint;
use crate::joint::MOST_FREEDOMS;
use crate::mechanism::{Body, Mechanism};
use crate::spatial::fused::{add_cross, apply, cross};
use crate::spatial::{Pose, split};
use crate::steps::Placement;
use crate::time_function::Moment;
use alloc::vec::Vec;
use core::fmt::Debug;
use nalgebra::{Matrix3, Vector3, Vector6};

/// Placements and twists of the joints' child frames, by body; twists at those frames' origins, in world axes. `None` for a body that is not there.
pub trait Motions {
    /// Placement of a body's joint-child frame.
    fn placement(&self, body: usize) -> Option<&Placement<f64>>;
    /// Its twist.
    fn twist(&self, body: usize) -> Option<&Vector6<f64>>;
}

/// Placements and twists in a list of their own.
#[derive(Clone, Debug)]
pub struct MotionList(pub Vec<(Placement<f64>, Vector6<f64>)>);

impl Motions for MotionList {
    fn placement(&self, body: usize) -> Option<&Placement<f64>> {
        self.0.get(body).map(|(placement, _)| placement)
    }

    fn twist(&self, body: usize) -> Option<&Vector6<f64>> {
        self.0.get(body).map(|(_, twist)| twist)
    }
}

/// A mechanism at one state.
///
/// Of a body that is not there it tells nothing: NaN where there is a number.
#[non_exhaustive]
pub struct View<'a> {
    /// The mechanism.
    pub mechanism: &'a Mechanism,
    /// Q of all joints.
    pub configuration: &'a [f64],
    /// v̄ of all joints.
    pub speeds: &'a [f64],
    /// Where the bodies are and how they move.
    pub motions: &'a dyn Motions,
    /// When it is so.
    pub moment: Moment,
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
    /// A mechanism at Q and v̄, with where its bodies are and how they move, at time 0.
    pub const fn new(
        mechanism: &'a Mechanism,
        configuration: &'a [f64],
        speeds: &'a [f64],
        motions: &'a dyn Motions,
    ) -> Self {
        Self {
            mechanism,
            configuration,
            speeds,
            motions,
            moment: Moment {
                time: 0.0,
                within: 0.0,
            },
        }
    }

    /// The same at another time.
    #[must_use]
    pub const fn at(self, moment: Moment) -> Self {
        Self { moment, ..self }
    }

    fn body(&self, body: usize) -> Option<&'a Body> {
        self.mechanism.bodies().get(body)
    }

    /// The joint under a body, and its Q.
    pub(super) fn joint_and_configuration(
        &self,
        body: usize,
    ) -> Option<(&'a dyn AnyJoint, &'a [f64])> {
        let body = self.body(body)?;
        Some((body.joint(), body.configuration(self.configuration)))
    }

    /// The joint under a body, if there is one of that index.
    pub fn joint(&self, body: usize) -> Option<&'a dyn AnyJoint> {
        Some(self.body(body)?.joint())
    }

    /// Its Q.
    pub fn joint_configuration(&self, body: usize) -> &'a [f64] {
        self.body(body)
            .map_or(&[], |body| body.configuration(self.configuration))
    }

    /// Its velocity `v = S̄ v̄`, in the first entries of `buffer`.
    pub fn joint_velocity<'b>(
        &self,
        body: usize,
        buffer: &'b mut [f64; MOST_FREEDOMS],
    ) -> &'b [f64] {
        let Some(own) = self.body(body) else {
            return &[];
        };
        let (joint, ranges) = (own.joint(), own.ranges());
        let speeds = &self.speeds[ranges.speeds.clone()];
        let velocity = &mut buffer[..ranges.freedoms.len()];
        if joint.structures().speed_basis.is_identity() {
            velocity.copy_from_slice(speeds);
            return velocity;
        }
        let mut basis = [0.0; MOST_FREEDOMS * MOST_FREEDOMS];
        let basis = &mut basis[..velocity.len() * speeds.len()];
        joint.speed_basis(self.joint_configuration(body), basis);
        for (i, entry) in velocity.iter_mut().enumerate() {
            let row = basis.iter().skip(i).step_by(ranges.freedoms.len());
            *entry = row.zip(speeds).map(|(b, v)| b * v).sum();
        }
        velocity
    }

    /// The value and the rate of a port of the joint under a body, rad or m and per second; NaN of one that is not there.
    pub fn port(&self, body: usize, port: usize) -> (f64, f64) {
        let Some((joint, q)) = self.joint_and_configuration(body) else {
            return (f64::NAN, f64::NAN);
        };
        let (mut velocity, mut row) = ([0.0; MOST_FREEDOMS], [0.0; MOST_FREEDOMS]);
        let velocity = self.joint_velocity(body, &mut velocity);
        let row = &mut row[..velocity.len()];
        joint.port_row(q, port, row);
        let rate = row.iter().zip(velocity).map(|(p, v)| p * v).sum();
        (joint.port_value(q, port), rate)
    }

    /// The value and the rate of a port of the joint under a body, or of the only coordinate of its Q and its v; NaN where there is none.
    pub fn axis(&self, body: usize, port: Option<usize>) -> (f64, f64) {
        if let Some(port) = port {
            return self.port(body, port);
        }
        let mut velocity = [0.0; MOST_FREEDOMS];
        let velocity = self.joint_velocity(body, &mut velocity);
        match (self.joint_configuration(body), velocity) {
            (&[q], &[v]) => (q, v),
            _ => (f64::NAN, f64::NAN),
        }
    }

    /// The body frame in the world; the world itself for `None`.
    pub fn pose(&self, body: Option<usize>) -> Pose<f64> {
        let Some(body) = body else {
            return Pose::identity();
        };
        let known = self.body(body).zip(self.motions.placement(body));
        known.map_or_else(nowhere, |(body, placement)| {
            placement.pose().compose(body.child_placement())
        })
    }

    /// From the origin of the joint-child frame to a point given in the body frame, world axes, m.
    pub fn arm(&self, body: usize, point: &Vector3<f64>) -> Vector3<f64> {
        let known = self.body(body).zip(self.motions.placement(body));
        known.map_or(nowhere().translation, |(body, placement)| {
            let fixed = body.child_placement();
            apply(&placement.rotation, &fixed.transform_point(point))
        })
    }

    /// Position and velocity of a point given in the body frame (in the world for `None`), world axes, m and m/s.
    pub fn point(&self, body: Option<usize>, point: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let Some(body) = body else {
            return (*point, Vector3::zeros());
        };
        let arm = self.arm(body, point);
        let known = self.motions.twist(body).zip(self.motions.placement(body));
        let Some((twist, placement)) = known else {
            return (nowhere().translation, nowhere().translation);
        };
        let (angular, linear) = split(twist);
        (placement.origin + arm, add_cross(&linear, &angular, &arm))
    }
}

/// The pose of a body that is not there.
fn nowhere() -> Pose<f64> {
    let nan = f64::NAN;
    Pose::new(Matrix3::repeat(nan), Vector3::repeat(nan))
}

/// Where elements put what they exert. What is put on a body that is not there makes all of it NaN, so that the motion ends with an error.
#[derive(Debug)]
pub struct Action<'a> {
    /// Wrench on each body at the origin of its joint-child frame, world axes.
    pub(crate) wrenches: &'a mut [Vector6<f64>],
    /// τ, one entry per degree of freedom.
    pub(crate) efforts: &'a mut [f64],
}

impl<'a> Action<'a> {
    /// Into a wrench for each body, and an entry of τ for each degree of freedom.
    pub const fn new(wrenches: &'a mut [Vector6<f64>], efforts: &'a mut [f64]) -> Self {
        Self { wrenches, efforts }
    }

    /// Adds efforts of the joint under a body, one entry per degree of freedom.
    pub fn add_effort(&mut self, view: &View<'_>, body: usize, effort: &[f64]) {
        let range = view.body(body).map(|body| body.ranges().freedoms.clone());
        let own = range.and_then(|range| self.efforts.get_mut(range));
        match own.filter(|own| own.len() == effort.len()) {
            Some(own) => {
                for (sum, value) in own.iter_mut().zip(effort) {
                    *sum += value;
                }
            }
            None => self.efforts.fill(f64::NAN),
        }
    }

    /// Adds `Pᵀ f` for an effort f at a port of the joint under a body, N·m or N.
    pub fn add_port_effort(&mut self, view: &View<'_>, body: usize, port: usize, effort: f64) {
        let Some((joint, q)) = view.joint_and_configuration(body) else {
            return self.efforts.fill(f64::NAN);
        };
        let mut row = [0.0; MOST_FREEDOMS];
        let row = &mut row[..joint.layout().freedoms];
        joint.port_row(q, port, row);
        row.iter_mut().for_each(|entry| *entry *= effort);
        self.add_effort(view, body, row);
    }

    /// Adds a force (world axes, N) on a body, at the end of an `arm` of [`View::arm`].
    pub fn add_force(&mut self, body: usize, arm: &Vector3<f64>, force: &Vector3<f64>) {
        self.add_wrench(body, &cross(arm, force), force);
    }

    /// Adds a wrench on a body at the origin of its joint-child frame, world axes.
    pub fn add_wrench(&mut self, body: usize, moment: &Vector3<f64>, force: &Vector3<f64>) {
        match self.wrenches.get_mut(body) {
            Some(sum) => *sum += crate::spatial::join(moment, force),
            None => self.wrenches.fill(Vector6::repeat(f64::NAN)),
        }
    }
}
