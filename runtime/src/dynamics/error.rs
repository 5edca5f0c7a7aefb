//! Why equations of motion cannot be evaluated.

use crate::mechanism::StateError;
use alloc::string::String;

/// Why equations of motion cannot be evaluated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DynamicsError {
    /// Some motion carries no inertia.
    #[error(
        "the mass matrix is singular at joint `{joint}`, speed `{speed}`: its pivot {pivot:e} is not above {limit:e}; give \
         mass or inertia to the bodies that this joint moves"
    )]
    SingularMass {
        /// The joint.
        joint: String,
        /// The speed.
        speed: &'static str,
        /// The pivot.
        pivot: f64,
        /// What the rounding of the matrix amounts to.
        limit: f64,
    },
    /// The constraint matrix A has lost rank.
    #[error(
        "the nonholonomic constraints are dependent, so that λ is not determined: A has lost rank"
    )]
    DependentConstraints,
    /// A vector has the wrong size or holds a number that is not finite.
    #[error(transparent)]
    State(#[from] StateError),
}
