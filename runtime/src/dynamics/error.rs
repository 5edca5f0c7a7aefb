//! Why equations of motion cannot be evaluated.

use crate::mechanism::{Mechanism, Space, StateError};
use alloc::string::String;

/// Why equations of motion cannot be evaluated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DynamicsError {
    /// Some motion carries no inertia.
    #[error(
        "the mass matrix is singular at joint `{joint}`, speed `{speed}`: its pivot {pivot:e} is not above {limit:e}; give \
         mass or inertia to the bodies that this joint moves, an armature to the joint, or a prescribed motion"
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
    /// A constraint that couples joints no longer determines the speed that depends on it.
    #[error(
        "constraint `{constraint}`: at this configuration it does not determine the speeds that depend on the others: a pivot is \
         {ratio:e} of the largest, the limit is {limit:e}"
    )]
    Coupling {
        /// The constraint.
        constraint: String,
        /// Pivot over largest entry.
        ratio: f64,
        /// Smallest ratio allowed.
        limit: f64,
    },
    /// Speeds violate a constraint that couples joints.
    #[error("constraint `{constraint}`: the speeds violate it by {value:e}, more than {limit:e}")]
    ConstraintViolated {
        /// The constraint.
        constraint: String,
        /// The forbidden velocity.
        value: f64,
        /// How much of it is taken for rounding.
        limit: f64,
    },
    /// Derivatives of this mechanism are not covered.
    #[error("derivatives of the dynamics do not cover {what}: `{name}`")]
    NotDifferentiable {
        /// What stands in the way.
        what: &'static str,
        /// Its name.
        name: String,
    },
    /// What an element exerts has no derivative at this state.
    #[error("element `{name}` has no derivative at this state: {what}")]
    NoDerivative {
        /// The element.
        name: String,
        /// Why.
        what: &'static str,
    },
    /// Second derivatives of this mechanism are not covered.
    #[error("second derivatives of the dynamics do not cover {what}: `{name}`")]
    NotTwiceDifferentiable {
        /// What stands in the way.
        what: &'static str,
        /// Its name.
        name: String,
    },
    /// A frame that cannot move in all six ways has no operational-space inertia.
    #[error(
        "frame `{frame}` has no operational-space inertia: its motion in direction `{direction}` depends on the directions before it, the \
         scaled pivot {pivot:e} is not above {limit:e}"
    )]
    SingularFrame {
        /// The frame.
        frame: String,
        /// The first direction that depends on those before it.
        direction: &'static str,
        /// Its pivot, the diagonal scaled to ones.
        pivot: f64,
        /// What a pivot must stand above.
        limit: f64,
    },
    /// Operational-space inertia where constraints couple joints.
    #[error(
        "frame `{frame}`: operational-space inertia does not cover constraints that couple joints, such as `{constraint}`"
    )]
    CoupledFrame {
        /// The frame.
        frame: String,
        /// One of the constraints.
        constraint: String,
    },
    /// Results were handed over that another mechanism's sizes were used for.
    #[error("the derivatives are to be put into results that were made for another mechanism")]
    ForeignResults,
    /// A vector has the wrong size or holds a number that is not finite.
    #[error(transparent)]
    State(#[from] StateError),
}

/// What a pivot is of.
const CARRIED: &str = "inertia that moves with a speed";

impl DynamicsError {
    /// Whether something that is not finite made it.
    fn is_of_no_value(&self) -> bool {
        match self {
            Self::State(StateError::NoValue { .. } | StateError::NotFinite { .. }) => true,
            Self::Coupling { ratio, .. } => !ratio.is_finite(),
            Self::ConstraintViolated { value, .. } => !value.is_finite(),
            _ => false,
        }
    }
}

impl Mechanism {
    /// The error itself; where something that is not finite made it, the first joint with a kernel that is not at (q, v̄).
    pub fn first_cause(&self, error: DynamicsError, q: &[f64], speeds: &[f64]) -> DynamicsError {
        if !error.is_of_no_value() {
            return error;
        }
        match self.check_vector("configuration", Space::Configuration, q) {
            Ok(()) => self.no_value(q, speeds).map_or(error, DynamicsError::State),
            Err(cause) => cause.into(),
        }
    }

    /// The joint and the degree of freedom or speed behind a row of a mass matrix whose pivot is not above its limit: singular, or not finite.
    pub(super) fn singular_mass(
        &self,
        space: Space,
        row: usize,
        pivot: f64,
        limit: f64,
    ) -> DynamicsError {
        let owner = self.bodies().iter().find_map(|body| {
            let (range, names) = (space.range(body.ranges()), space.names(body.joint()));
            let name = range
                .contains(&row)
                .then(|| names.get(row - range.start))??;
            Some((body.joint_name(), *name))
        });
        let (joint, speed) = owner.unwrap_or(("", ""));
        if !pivot.is_finite() || !limit.is_finite() {
            return DynamicsError::State(StateError::NoValue {
                joint: joint.into(),
                what: CARRIED,
            });
        }
        DynamicsError::SingularMass {
            joint: joint.into(),
            speed,
            pivot,
            limit,
        }
    }
}
