//! Mechanisms and states in the plain-text format of the peer harness (`tests/peers`), in Pinocchio's conventions.
//!
//! A free-flyer (`FF`) has q = x y z and a quaternion x y z w, v = linear then angular velocity in body axes; a spherical joint (`S`) has a
//! quaternion and its velocity in body axes; `R` and `P` turn about and slide along an axis. Joints of the library act
//! about z: placements turn them.

mod mechanism;
mod model;
mod reference;
mod states;

pub use model::{JointKind, JointLine, Model, ModelError};
pub use reference::{Reference, numbers};
pub use states::{States, convert};
