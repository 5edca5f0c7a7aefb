//! Why a controller cannot be made, or cannot go on.

use super::stabilizability::Motion;
use alloc::string::String;
use hamel_integrate::StepFailure;
use hamel_runtime::dynamics::DynamicsError;
use hamel_runtime::elements::ElementError;
use hamel_runtime::mechanism::StateError;
use hamel_runtime::shown::Number;

/// Why a controller cannot be made, or cannot go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ControlError {
    /// A number out of range.
    #[error("{quantity} is {value}: it must be {requirement}", value = Number(*.value))]
    Value {
        /// What it is.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        requirement: &'static str,
    },
    /// A list of the wrong size.
    #[error("{quantity} has {found} entries, it must have {expected}")]
    Size {
        /// Which list.
        quantity: &'static str,
        /// Size it must have.
        expected: usize,
        /// Size given.
        found: usize,
    },
    /// A joint that the law is not made for.
    #[error("joint `{joint}` {reason}")]
    Joint {
        /// The joint.
        joint: String,
        /// What stands against it.
        reason: &'static str,
    },
    /// A mechanism that the law is not made for.
    #[error("{0}")]
    Mechanism(&'static str),
    /// The goal is not an equilibrium under the efforts that the law has.
    #[error(
        "joint `{joint}` does not rest at the goal: its speed `{speed}` feels {force:e} N m or N there, no input acts on it, and the mechanism accelerates by {acceleration:e} rad/s² or m/s², more than {limit:e}"
    )]
    NotAtRest {
        /// The joint.
        joint: String,
        /// The speed.
        speed: &'static str,
        /// The force.
        force: f64,
        /// The largest entry of v̄̇.
        acceleration: f64,
        /// What passes for rounding.
        limit: f64,
    },
    /// An input too weak to hold the goal.
    #[error(
        "joint `{joint}` needs the effort {effort:e} N m or N to rest at the goal, and its limit is {limit:e}"
    )]
    Weak {
        /// The joint.
        joint: String,
        /// What it needs.
        effort: f64,
        /// The limit.
        limit: f64,
    },
    /// A motion that does not decay by itself is reached by no input: no feedback is stable.
    #[error("not stabilizable: no input reaches the mode with {0}, which does not decay by itself")]
    BeyondReach(Motion),
    /// A motion that does not decay by itself is seen by no weight: the least cost leaves it alone.
    #[error("not detectable: no weight sees the mode with {0}, which does not decay by itself")]
    Unseen(Motion),
    /// One of these two, of a mechanism about its goal.
    #[error("about the goal, most of all at joint `{joint}`: {cause}")]
    AboutGoal {
        /// The joint with the largest part in the motion.
        joint: String,
        /// Which of the two.
        cause: alloc::boxed::Box<ControlError>,
    },
    /// No feedback was found that is stable.
    #[error(
        "no solution of the Riccati equation is found: inputs or weights are too small, or too large, beside the others"
    )]
    NotStabilizable,
    /// The commanded speeds do not answer to the efforts.
    #[error("at {time} s: efforts of joint `{joint}` do not determine its accelerations", time = Number(*.time))]
    Unresponsive {
        /// The joint.
        joint: String,
        /// When, s.
        time: f64,
    },
    /// A law that this build leaves out.
    #[error(
        "this program was built without model predictive control: build it with the feature `predictive`"
    )]
    NoPrediction,
    /// A path on which the point stands still has no direction.
    #[error(
        "at {time} s the path has the speed {speed:e} m/s, and so no direction: it must be at least {limit:e} m/s", time = Number(*.time))]
    PathStands {
        /// When, s.
        time: f64,
        /// Its speed, m/s.
        speed: f64,
        /// The least speed, m/s.
        limit: f64,
    },
    /// A reference by speeds that a joint cannot follow to its end.
    #[error(
        "the reference leads joint `{joint}` beyond where its motion ends, as a dead point: after {time} s its relations have no solution", time = Number(*.time))]
    ReferenceEnds {
        /// The joint.
        joint: String,
        /// Until when it can be followed, s.
        time: f64,
    },
    /// Steps of one period are too long to foresee a fast motion.
    #[error(
        "the period of {period} s is too long: times {rate:.3e} 1/s, the rate of the fastest mode about the goal, most of all of joint `{joint}`, it is {:.3e}, and the steps of order 4 that predict the motion are stable up to {limit}. Make the period at most {:.1e} s, or the springs and dampers of that mode weaker",
        period * rate, limit / rate, period = Number(*.period), limit = Number(*.limit))]
    PeriodTooLong {
        /// The joint that moves fastest in it.
        joint: String,
        /// The period, s.
        period: f64,
        /// |λ|, 1/s.
        rate: f64,
        /// What their product may be.
        limit: f64,
    },
    /// Efforts that are held over a period make deviations grow.
    #[error(
        "the period of {} s is too long: with efforts held over it, deviations grow from one period to the next. Make it less than {longest:.1e} s, or the gains smaller", Number(*.period))]
    HeldTooLong {
        /// The period, s.
        period: f64,
        /// The longest at which they do not grow, to first order, s.
        longest: f64,
    },
    /// The optimiser refuses the problem itself.
    #[error("the optimiser cannot be set up: {0}")]
    Optimizer(String),
    /// No inputs within the limits whose motion can be foreseen, or none that the optimiser finds.
    #[error("no plan of inputs within the limits is found: {cause}; {binding}")]
    NoPlan {
        /// What stands against it.
        cause: String,
        /// Which inputs are at their limits.
        binding: String,
    },
    /// A virtual spring or damper is refused.
    #[error(transparent)]
    Element(#[from] ElementError),
    /// A step that cannot be linearised.
    #[error(transparent)]
    Step(#[from] StepFailure),
    /// A state of the wrong size, or a local coordinate that cannot be found.
    #[error(transparent)]
    State(#[from] StateError),
    /// The equations of motion cannot be evaluated.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
}

/// A number that must hold a requirement.
pub(super) fn require(
    quantity: &'static str,
    value: f64,
    holds: bool,
    requirement: &'static str,
) -> Result<(), ControlError> {
    match holds && value.is_finite() {
        true => Ok(()),
        false => Err(ControlError::Value {
            quantity,
            value,
            requirement,
        }),
    }
}

/// A number that must be positive.
pub(super) fn positive(quantity: &'static str, value: f64) -> Result<(), ControlError> {
    require(quantity, value, value > 0.0, "positive and finite")
}

/// A list that must have a size.
pub(super) fn size(
    quantity: &'static str,
    expected: usize,
    found: usize,
) -> Result<(), ControlError> {
    match expected == found {
        true => Ok(()),
        false => Err(ControlError::Size {
            quantity,
            expected,
            found,
        }),
    }
}
