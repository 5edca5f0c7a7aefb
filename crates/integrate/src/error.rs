//! Why an integration ends before its time.

use super::{Approach, Near};
use alloc::boxed::Box;
use alloc::format;
use alloc::string::String;
use hamel_runtime::dynamics::DynamicsError;
use hamel_runtime::mechanism::{Loci, Mechanism, StateError};
use hamel_runtime::shown::Number;
use hamel_runtime::time_function::KinkError;

/// Why a step cannot be taken, or is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepFailure {
    /// The length of a step that is asked for.
    #[error("the step is {step} s long: it must be positive and finite", step = Number(*.step))]
    Length {
        /// The length, s.
        step: f64,
    },
    /// The embedded error estimate exceeds the tolerance.
    #[error("the error of joint `{joint}` is {ratio:e} times the tolerance")]
    Inaccurate {
        /// The joint with the largest error.
        joint: String,
        /// Its error over the tolerance.
        ratio: f64,
    },
    /// A joint turns too far for one step.
    #[error("joint `{joint}` turns by {angle} rad within the step, more than pi", angle = Number(*.angle))]
    Turn {
        /// The joint.
        joint: String,
        /// Its rotation.
        angle: f64,
    },
    /// The equations of an implicit step are not solved.
    #[error(
        "the iteration of the implicit step does not converge: joint `{joint}` still changes by {change:e}, each change is {contraction:.2} times the last"
    )]
    NoConvergence {
        /// The joint that changes most.
        joint: String,
        /// Its last change: rad or m, or a speed's as a part of max(1, |v̄|).
        change: f64,
        /// The last change over the one before.
        contraction: f64,
    },
    /// The matrix of the iteration of an implicit step is singular.
    #[error("the matrix of the implicit step is singular or not finite at joint `{joint}`")]
    SingularIteration {
        /// The joint.
        joint: String,
    },
    /// The relations of a joint have no solution at a point of the step, or none on the branch on which it begins.
    #[error(
        "the relations of joint `{joint}` have no solution within the step, on the branch on which it begins"
    )]
    NotClosed {
        /// The joint.
        joint: String,
    },
    /// A joint comes too near to a configuration that its spec excludes, or passes it.
    #[error(
        "within the step joint `{joint}` comes to or near where {loci} is 0, which its spec excludes"
    )]
    Excluded {
        /// The joint.
        joint: String,
        /// The functions that vanish there, as the spec writes them.
        loci: Loci,
    },
    /// The function of an event is NaN or infinite.
    #[error("the function of event `{event}` is {value}: it must be finite", value = Number(*.value))]
    Event {
        /// The event.
        event: String,
        /// Its value.
        value: f64,
    },
    /// The kinks of a function of time cannot be followed.
    #[error(transparent)]
    Kinks(#[from] KinkError),
    /// The coefficients of an explicit method are none.
    #[error("the method {reason}")]
    Tableau {
        /// What is wrong with them.
        reason: String,
    },
    /// The state reached is not finite, or cannot be brought back to its manifold.
    #[error(transparent)]
    State(#[from] StateError),
    /// The equations of motion cannot be evaluated.
    #[error(transparent)]
    Dynamics(DynamicsError),
}

impl From<DynamicsError> for StepFailure {
    fn from(cause: DynamicsError) -> Self {
        match cause {
            DynamicsError::State(cause) => Self::State(cause),
            cause => Self::Dynamics(cause),
        }
    }
}

impl StepFailure {
    /// Whether a shorter step may not fail.
    pub(crate) const fn is_of_length(&self) -> bool {
        match self {
            Self::Turn { .. }
            | Self::NoConvergence { .. }
            | Self::SingularIteration { .. }
            | Self::NotClosed { .. }
            | Self::Excluded { .. }
            | Self::State(_) => true,
            Self::Length { .. }
            | Self::Inaccurate { .. }
            | Self::Event { .. }
            | Self::Kinks(_)
            | Self::Tableau { .. }
            | Self::Dynamics(_) => false,
        }
    }

    /// The same cause; a configuration that is not finite, or a finite map without a value, becomes [`StepFailure::NotClosed`] where relations determine the configuration.
    pub(crate) fn of_relations(self, mechanism: &Mechanism) -> Self {
        let Self::State(
            StateError::NotFinite {
                joint,
                quantity: "configuration",
                ..
            }
            | StateError::FiniteMap { joint, .. },
        ) = &self
        else {
            return self;
        };
        let mut joints = mechanism.joints();
        let closes = joints
            .any(|(_, body)| body.joint_name() == joint && !body.joint().relations().is_empty());
        match closes {
            true => Self::NotClosed {
                joint: joint.clone(),
            },
            false => self,
        }
    }
}

/// Advice as the end of a sentence.
fn after(advice: &str) -> String {
    match advice {
        "" => String::new(),
        advice => format!("; {advice}"),
    }
}

/// Why an integration ends before its time.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IntegrateError {
    /// An option out of range.
    #[error("{option} is {value}: it must be {requirement}", value = Number(*.value))]
    Option {
        /// The option.
        option: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        requirement: &'static str,
    },
    /// Step control for a scheme that cannot tell its error.
    #[error(
        "the method `{scheme}` does not estimate its error: give it a step dt instead of a tolerance"
    )]
    NoEstimate {
        /// The scheme.
        scheme: &'static str,
    },
    /// A scheme that the mechanism or the form is not made for.
    #[error("the method `{scheme}` {reason}")]
    Scheme {
        /// The scheme.
        scheme: &'static str,
        /// What it takes, and what it was given.
        reason: String,
    },
    /// The end lies before the start.
    #[error("t_end is {} s: it lies before the initial time {} s", Number(*.end), Number(*.start))]
    TimeOrder {
        /// Initial time.
        start: f64,
        /// Time at which to end.
        end: f64,
    },
    /// A sample time out of order or out of range.
    #[error(
        "sample {index} is at {} s: sample times ascend, and this one must lie between {} s and {} s",
        Number(*.time), Number(*.earliest), Number(*.end)
    )]
    Sample {
        /// Its index.
        index: usize,
        /// The time.
        time: f64,
        /// Initial time, or the sample before.
        earliest: f64,
        /// Time at which to end.
        end: f64,
    },
    /// The initial state is refused.
    #[error("initial state: {0}")]
    Initial(#[from] StateError),
    /// The equations of motion fail at a state that was reached, so that no step size can mend it.
    #[error("at {} s: {cause}{near}", Number(*.time))]
    AtState {
        /// When.
        time: f64,
        /// Why.
        cause: Box<StepFailure>,
        /// The joint that is nearest to a singular set of its own there, if one has any.
        near: Near,
    },
    /// A joint whose motion has ever shorter pieces.
    #[error(
        "at {} s: joint `{joint}` chatters: {count} impacts, stops and starts have followed each other at once",
        Number(*.time)
    )]
    Chatter {
        /// The joint.
        joint: String,
        /// How many there were.
        count: usize,
        /// When, s.
        time: f64,
    },
    /// A joint has come to a configuration that its spec excludes, where its relations do not determine how the motion goes on.
    #[error(
        "at {} s: joint `{}` comes to a configuration that its spec excludes, where {} is 0 (it is {:.1e} here and was {:.1e}): its relations do not say there how it moves on; other independent coordinates, `independent` of a loop in a scene or `basis` of a spec, may pass it",
        Number(.0.time), .0.joint, .0.loci, .0.value, .0.most
    )]
    Excluded(Approach),
    /// What friction or limits do that is not determined.
    #[error("at {} s: {what} of joints {joints}: {reason}", Number(*.time))]
    Undecided {
        /// When, s.
        time: f64,
        /// `friction`, `limit` or `impact`.
        what: &'static str,
        /// The joints.
        joints: String,
        /// Why not.
        reason: String,
    },
    /// A step of fixed size fails.
    #[error("the step of {step:e} s at {} s fails: {cause}{near}{}", Number(*.time), after(.advice))]
    Step {
        /// When.
        time: f64,
        /// The step.
        step: f64,
        /// Why.
        cause: Box<StepFailure>,
        /// The joint that is nearest to a singular set of its own there, if one has any.
        near: Near,
        /// What to do about it; empty where nothing helps.
        advice: String,
    },
    /// Steps are so short that the motion would take a night or more.
    #[error(
        "at {} s, after {steps} steps, a step is {step:.1e} s long, and {to_go:.1e} more would lead to the end: {advice}", Number(*.time)
    )]
    Hopeless {
        /// When.
        time: f64,
        /// Steps taken by then.
        steps: usize,
        /// The mean of the last ones, s.
        step: f64,
        /// Steps that would be left.
        to_go: f64,
        /// What makes them so short, where that is known, and what to do about it.
        advice: String,
    },
    /// Rounding keeps the iteration of implicit steps from converging.
    #[error(
        "at {} s, rounding in doubles keeps the iteration of the implicit step from converging, in {count} of {attempts} attempts: at joint `{joint}` it comes to {ratio:.1e} times what a step may leave unsolved: take refined arithmetic, or an explicit method", Number(*.time)
    )]
    Unsolved {
        /// When.
        time: f64,
        /// The joint whose rates scatter most.
        joint: String,
        /// What it changes in a step at most, over what a step may leave unsolved.
        ratio: f64,
        /// Attempts without convergence.
        count: usize,
        /// All attempts by then.
        attempts: usize,
    },
    /// Step control has come to steps that time cannot resolve.
    #[error("the step has shrunk to {step:e} s at {} s, the limit is {limit:e} s: {cause}{near}{advice}", Number(*.time))]
    StepUnderflow {
        /// When.
        time: f64,
        /// The step.
        step: f64,
        /// Smallest step.
        limit: f64,
        /// Why the last attempt was refused.
        cause: Box<StepFailure>,
        /// The joint that is nearest to a singular set of its own there, if one has any.
        near: Near,
        /// The method that such a state calls for, and why, where it is another one; empty otherwise.
        advice: String,
    },
}
