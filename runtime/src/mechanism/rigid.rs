//! Checks on bodies that do not depend on their joints. They run before equations of motion are built.

use super::{BodySpec, MechanismError};
use crate::spatial::{MassProperties, Pose, SpatialInertia};
use alloc::collections::BTreeMap;
use alloc::vec::Vec;
use nalgebra::Vector3;

/// A body, except for its joint; see [`BodySpec`].
#[derive(Clone, Copy, Debug)]
pub struct RigidBody<'a> {
    /// Name of the body, unique in its mechanism.
    pub name: &'a str,
    /// Index of the parent body, smaller than this body's own; `None` is the world.
    pub parent: Option<usize>,
    /// The joint's parent frame in the parent's body frame.
    pub placement: &'a Pose<f64>,
    /// The body frame in the joint's child frame.
    pub child_placement: &'a Pose<f64>,
    /// Mass properties in the body frame.
    pub mass: &'a MassProperties,
}

impl<'a> From<&'a BodySpec> for RigidBody<'a> {
    fn from(spec: &'a BodySpec) -> Self {
        Self {
            name: &spec.name,
            parent: spec.parent,
            placement: &spec.placement,
            child_placement: &spec.child_placement,
            mass: &spec.mass,
        }
    }
}

/// Everything that is wrong with bodies, parents first, in uniform gravity (world axes, m/s²), whatever their joints are: numbers that are not
/// finite, placements that are no poses, masses that no rigid body has, names that are taken, parents that do not come first; and frames and
/// inertias that leave the range of numbers.
pub fn check_bodies(gravity: &Vector3<f64>, bodies: &[RigidBody<'_>]) -> Vec<MechanismError> {
    let mut errors = Vec::new();
    for (axis, &value) in ['x', 'y', 'z'].into_iter().zip(gravity) {
        if !value.is_finite() {
            errors.push(MechanismError::Gravity { axis, value });
        }
    }
    check_names(bodies, &mut errors);
    for (index, body) in bodies.iter().enumerate() {
        let before = errors.len();
        check_body(index, body, &mut errors);
        if errors.len() == before {
            errors.extend(overflow(bodies, body));
        }
    }
    errors
}

fn check_names(bodies: &[RigidBody<'_>], errors: &mut Vec<MechanismError>) {
    let mut names = BTreeMap::new();
    for (index, body) in bodies.iter().enumerate() {
        let first = *names.entry(body.name).or_insert(index);
        if first != index {
            errors.push(MechanismError::DuplicateName {
                body: body.name.into(),
                index,
                first,
            });
        }
    }
}

fn check_body(index: usize, body: &RigidBody<'_>, errors: &mut Vec<MechanismError>) {
    if let Some(parent) = body.parent.filter(|&parent| parent >= index) {
        errors.push(MechanismError::Parent {
            body: body.name.into(),
            index,
            parent,
        });
    }
    let placements = [
        ("placement", body.placement),
        ("child placement", body.child_placement),
    ];
    for (which, pose) in placements {
        if let Err(cause) = pose.check() {
            errors.push(MechanismError::Placement {
                body: body.name.into(),
                which,
                cause,
            });
        }
    }
    if let Err(cause) = body.mass.check() {
        errors.push(MechanismError::Mass {
            body: body.name.into(),
            cause,
        });
    }
}

/// What of a body is not finite, though all that it is made of is.
fn overflow(bodies: &[RigidBody<'_>], body: &RigidBody<'_>) -> Option<MechanismError> {
    let parent = body.parent.and_then(|parent| bodies.get(parent));
    let frame = parent.map_or(*body.placement, |parent| {
        *parent.child_placement * *body.placement
    });
    let inertia = SpatialInertia::from(body.mass).transform(body.child_placement);
    let what = match (frame.is_finite(), inertia.is_finite()) {
        (true, true) => return None,
        (false, _) => "the placement of its joint, seen from the joint before,",
        (true, false) => "its inertia about its joint",
    };
    let body = body.name.into();
    Some(MechanismError::Overflow { body, what })
}
