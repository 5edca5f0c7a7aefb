//! Joints that carry several bodies, in a mechanism: their bodies follow one another, in the order in which the joint names them.
//!
//! All of them have the same parent, and share the joint's coordinates, degrees of freedom and speeds. The first of them stands for the joint. Each
//! may have a placement of its own in the parent, as the rotor of a gear beside its shaft, unless the coordinates obey relations: those of a loop are
//! written for one frame.

use super::{Body, BodySpec, Mechanism, MechanismError};
use alloc::string::String;
use alloc::vec::Vec;
use core::ops::Range;

/// What is wrong with a body of a joint that carries several.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SeveralFault {
    /// It stands where its joint does not begin, and not behind those before it.
    #[error(
        "it is body `{name}` of joint `{joint}`, and must follow body `{before}` of the same joint"
    )]
    Order {
        /// The joint.
        joint: String,
        /// What the joint calls the body.
        name: &'static str,
        /// What the joint calls the body before it.
        before: &'static str,
    },
    /// A body of its joint is missing.
    #[error("its joint `{joint}` carries body `{name}` too, which must follow body `{before}`")]
    Missing {
        /// The joint.
        joint: String,
        /// What the joint calls the body that is missing.
        name: &'static str,
        /// What the joint calls the body before it.
        before: &'static str,
    },
    /// Its parent, its placement or a parameter of its joint is not that of the first body.
    #[error("its {what} is not that of `{first}`, the first body of its joint `{joint}`")]
    Differs {
        /// The joint.
        joint: String,
        /// The first body of the joint.
        first: String,
        /// `parent`, `placement` or `value of a parameter`.
        what: &'static str,
    },
}

/// How many bodies a joint carries.
pub(super) fn count(spec: &BodySpec) -> usize {
    spec.joint.bodies().len().max(1)
}

/// What a joint calls its bodies.
fn name(spec: &BodySpec, body: usize) -> &'static str {
    spec.joint.bodies().get(body).copied().unwrap_or("")
}

/// Everything that is wrong with the order of bodies whose joints carry several.
pub(super) fn check(bodies: &[BodySpec]) -> Vec<MechanismError> {
    let mut errors = Vec::new();
    let mut refuse = |spec: &BodySpec, fault: SeveralFault| {
        let body = spec.name.clone();
        errors.push(MechanismError::Several { body, fault });
    };
    let mut index = 0;
    while index < bodies.len() {
        let first = &bodies[index];
        let joint = || first.joint_name.clone();
        let own = first.joint.body();
        if own > 0 {
            let (name, before) = (name(first, own), name(first, own - 1));
            let joint = joint();
            refuse(
                first,
                SeveralFault::Order {
                    joint,
                    name,
                    before,
                },
            );
            index += 1;
            continue;
        }
        let mut found = 1;
        while found < count(first) {
            let next = bodies.get(index + found);
            let Some(next) = next.filter(|next| follows(first, next, found)) else {
                let (name, before) = (name(first, found), name(first, found - 1));
                let joint = joint();
                refuse(
                    first,
                    SeveralFault::Missing {
                        joint,
                        name,
                        before,
                    },
                );
                break;
            };
            if let Some(what) = difference(first, next) {
                let (joint, first) = (joint(), first.name.clone());
                refuse(next, SeveralFault::Differs { joint, first, what });
            }
            found += 1;
        }
        index += found;
    }
    errors
}

/// Whether `next` is body `number` of the joint of which `first` is the first body.
fn follows(first: &BodySpec, next: &BodySpec, number: usize) -> bool {
    next.joint.body() == number && next.joint.name() == first.joint.name()
}

/// Whether the coordinates of its joint obey relations.
fn obeys_relations(spec: &BodySpec) -> bool {
    !spec.joint.structures().residual.is_zero()
}

/// In what a body differs from the first one of its joint where it must not.
fn difference(first: &BodySpec, other: &BodySpec) -> Option<&'static str> {
    let parameters = |spec: &BodySpec| {
        let mut values = Vec::new();
        spec.joint
            .parameters(&mut |_, value| values.push(value.to_bits()));
        values
    };
    if first.parent != other.parent {
        Some("parent")
    } else if first.placement != other.placement && obeys_relations(first) {
        Some("placement")
    } else if parameters(first) != parameters(other) {
        Some("value of a parameter")
    } else {
        None
    }
}

impl Body {
    /// Whether it stands for its joint: the joint carries it alone, or it is the first of the joint's bodies.
    pub fn leads(&self) -> bool {
        self.joint().body() == 0
    }
}

impl Mechanism {
    /// The joints, each with the index of the body that stands for it: the only one, or the first of several.
    pub fn joints(&self) -> impl DoubleEndedIterator<Item = (usize, &Body)> + Clone {
        let bodies = self.bodies().iter().enumerate();
        bodies.filter(|(_, body)| body.leads())
    }

    /// How many variations all bodies have: one for each body and each degree of freedom of its joint.
    pub fn variations(&self) -> usize {
        self.bodies()
            .last()
            .map_or(0, |last| last.ranges().variations.end)
    }

    /// How many columns the X̄ of all bodies have: one for each body and each speed of its joint.
    pub fn columns(&self) -> usize {
        self.bodies()
            .last()
            .map_or(0, |last| last.ranges().columns.end)
    }

    /// Index of the body that stands for the joint under `body`; `body` itself where there is no such body.
    pub fn leader(&self, body: usize) -> usize {
        let number = self.bodies().get(body).map(|own| own.joint().body());
        body - number.unwrap_or(0)
    }

    /// The bodies that the joint under `body` carries: one, or several that follow each other.
    pub fn carried(&self, body: usize) -> Range<usize> {
        let first = self.leader(body);
        let count = self
            .bodies()
            .get(first)
            .map_or(1, |own| own.joint().bodies().len());
        first..first + count.max(1)
    }
}
