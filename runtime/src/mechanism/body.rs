//! Bodies of a mechanism, each with the joint that it hangs on.

use crate::erased::{AnyJoint, Layout};
use crate::spatial::{MassProperties, Pose, SpatialInertia};
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

/// What a body is made from; input of [`Mechanism::new`](super::Mechanism::new).
///
/// The pose of the body in its parent is `placement · H(Q) · child_placement`.
#[derive(Clone, Debug)]
pub struct BodySpec {
    /// Name of the body, unique in its mechanism.
    pub name: String,
    /// Name of the joint, for messages.
    pub joint_name: String,
    /// Index of the parent body, smaller than this body's own; `None` is the world.
    pub parent: Option<usize>,
    /// The joint between parent and body.
    pub joint: Arc<dyn AnyJoint>,
    /// The joint's parent frame in the parent's body frame.
    pub placement: Pose<f64>,
    /// The body frame in the joint's child frame.
    pub child_placement: Pose<f64>,
    /// Mass properties in the body frame.
    pub mass: MassProperties,
}

/// Where a body's share lies in the vectors of its mechanism.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ranges {
    /// In the configuration Q.
    pub configuration: Range<usize>,
    /// In v, ϕ, p and τ.
    pub freedoms: Range<usize>,
    /// In v̄ and p̄.
    pub speeds: Range<usize>,
    /// In λ.
    pub constraints: Range<usize>,
    /// In vectors with an entry for each body and each degree of freedom of its joint.
    pub variations: Range<usize>,
    /// In vectors with an entry for each body and each speed of its joint: the columns of its X̄.
    pub columns: Range<usize>,
}

impl Ranges {
    /// The ranges of the first body, or of the only one, of a joint of the given sizes that begins where `offset` ends.
    pub(super) fn new(offset: &Layout, size: &Layout, before: Option<&Self>) -> Self {
        let (variations, columns) = Self::ends(before);
        Self {
            variations: variations..variations + size.freedoms,
            columns: columns..columns + size.speeds,
            configuration: offset.configuration..offset.configuration + size.configuration,
            freedoms: offset.freedoms..offset.freedoms + size.freedoms,
            speeds: offset.speeds..offset.speeds + size.speeds,
            constraints: offset.constraints..offset.constraints + size.constraints,
        }
    }

    /// The ranges of the next body of the same joint.
    pub(super) fn next(&self) -> Self {
        let (variations, columns) = Self::ends(Some(self));
        Self {
            variations: variations..variations + self.freedoms.len(),
            columns: columns..columns + self.speeds.len(),
            ..self.clone()
        }
    }

    /// Where the entries of bodies end.
    fn ends(before: Option<&Self>) -> (usize, usize) {
        before.map_or((0, 0), |last| (last.variations.end, last.columns.end))
    }
}

/// A body of a [`Mechanism`](super::Mechanism).
#[derive(Clone, Debug)]
pub struct Body {
    pub(super) spec: BodySpec,
    pub(super) ranges: Ranges,
    pub(super) joint_frame: Pose<f64>,
    pub(super) joint_inertia: SpatialInertia<f64>,
}

impl Body {
    pub(super) fn new(
        spec: BodySpec,
        ranges: Ranges,
        joint_frame: Pose<f64>,
        joint_inertia: SpatialInertia<f64>,
    ) -> Self {
        Self {
            spec,
            ranges,
            joint_frame,
            joint_inertia,
        }
    }

    /// Name of the body.
    pub fn name(&self) -> &str {
        &self.spec.name
    }

    /// Name of its joint.
    pub fn joint_name(&self) -> &str {
        &self.spec.joint_name
    }

    /// Index of its parent; `None` is the world.
    pub const fn parent(&self) -> Option<usize> {
        self.spec.parent
    }

    /// Its joint.
    pub fn joint(&self) -> &dyn AnyJoint {
        &*self.spec.joint
    }

    /// Its joint, shared.
    pub fn shared_joint(&self) -> Arc<dyn AnyJoint> {
        Arc::clone(&self.spec.joint)
    }

    /// The joint's parent frame in the parent's body frame.
    pub const fn placement(&self) -> &Pose<f64> {
        &self.spec.placement
    }

    /// The body frame in the joint's child frame.
    pub const fn child_placement(&self) -> &Pose<f64> {
        &self.spec.child_placement
    }

    /// Mass properties in the body frame.
    pub const fn mass(&self) -> &MassProperties {
        &self.spec.mass
    }

    /// Where this body's share lies in the vectors of the mechanism.
    pub const fn ranges(&self) -> &Ranges {
        &self.ranges
    }

    /// The joint's parent frame in the child frame of the parent's own joint (in the world for a root).
    ///
    /// Dynamics work in these frames, one for each joint, so that body frames do not appear in them.
    pub const fn joint_frame(&self) -> &Pose<f64> {
        &self.joint_frame
    }

    /// Inertia in the joint's child frame, about its origin.
    pub const fn joint_inertia(&self) -> &SpatialInertia<f64> {
        &self.joint_inertia
    }

    /// This body's entries of a configuration vector; none of one that is too short.
    pub fn configuration<'a>(&self, q: &'a [f64]) -> &'a [f64] {
        q.get(self.ranges.configuration.clone()).unwrap_or(&[])
    }

    /// The least of the functions of [`AnyJoint::singularities`] at this joint's own `q`, where it is 0 or not finite.
    pub(super) fn singular_value(&self, q: &[f64]) -> Option<f64> {
        singular_value(self.joint(), q)
    }

    /// The configuration that the joint calls home.
    pub fn home(&self) -> Vec<f64> {
        let mut q = vec![0.0; self.ranges.configuration.len()];
        self.joint().home(&mut q);
        q
    }
}

/// The least of the functions of [`AnyJoint::singularities`] at `q`, where it is 0 or not finite.
pub(super) fn singular_value(joint: &dyn AnyJoint, q: &[f64]) -> Option<f64> {
    if joint.singularities().is_empty() {
        return None;
    }
    let value = joint.singularity(q);
    (value == 0.0 || !value.is_finite()).then_some(value)
}
