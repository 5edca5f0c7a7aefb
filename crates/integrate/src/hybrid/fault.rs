//! Why a motion does not go on from one piece to the next.

use crate::{IntegrateError, Near, StepFailure};
use alloc::boxed::Box;
use alloc::string::String;

/// Why a transition is not made.
pub(super) enum Fault {
    Step(StepFailure),
    Undecided {
        what: &'static str,
        joints: String,
        reason: String,
    },
}

impl<E: Into<StepFailure>> From<E> for Fault {
    fn from(cause: E) -> Self {
        Self::Step(cause.into())
    }
}

impl Fault {
    /// As the integration tells it, at that time.
    pub(super) fn at(self, time: f64) -> IntegrateError {
        match self {
            Self::Step(cause) => IntegrateError::AtState {
                time,
                cause: Box::new(cause),
                near: Near::default(),
            },
            Self::Undecided {
                what,
                joints,
                reason,
            } => IntegrateError::Undecided {
                time,
                what,
                joints,
                reason,
            },
        }
    }
}
