//! Why a function is not written.

use super::{Kind, LONGEST, LONGEST_IN_LANES};

/// A function that would be too long.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TooLong {
    /// The function.
    pub kind: Kind,
    /// Whether it is left out in lanes alone.
    pub in_lanes: bool,
    /// At least so many operations would be written.
    pub operations: usize,
}

impl std::fmt::Display for TooLong {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { operations, .. } = self;
        let name = self.kind.name();
        match self.in_lanes {
            false => write!(
                f,
                "{name} would have {operations} operations, more than {LONGEST}: the tree computes it"
            ),
            true => write!(
                f,
                "{name} in lanes would have {operations} operations, more than {LONGEST_IN_LANES}: states are computed one by one"
            ),
        }
    }
}

/// Why a function is not written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotWritten {
    /// It would be too long.
    TooLong(TooLong),
    /// Second derivatives of forward dynamics where a constraint couples joints: the tree has none either.
    Coupled {
        /// The function.
        kind: Kind,
        /// Name of the first constraint.
        constraint: String,
    },
}

impl std::fmt::Display for NotWritten {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::TooLong(long) => write!(f, "{long}"),
            Self::Coupled { kind, constraint } => write!(
                f,
                "{}: second derivatives of the dynamics do not cover forward dynamics under a constraint that couples joints: `{constraint}`",
                kind.name()
            ),
        }
    }
}
