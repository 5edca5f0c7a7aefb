//! Why a function is not written.

use super::in_lanes::{LONGEST_IN_LANES, WIDEST_IN_LANES};
use super::{Kind, LONGEST};

/// A function that would be too long.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TooLong {
    /// The function.
    pub kind: Kind,
    /// Whether it is left out in lanes alone.
    pub in_lanes: bool,
    /// At least so many operations would be written.
    pub operations: usize,
    /// Numbers that it would have in memory for each of eight states, where it is these that are too many.
    pub numbers: Option<usize>,
}

impl std::fmt::Display for TooLong {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { operations, .. } = self;
        let name = self.kind.name();
        let one_by_one = "states are computed one by one";
        match (self.in_lanes, self.numbers) {
            (false, _) => write!(
                f,
                "{name} would have {operations} operations, more than {LONGEST}: the tree computes it"
            ),
            (true, None) => write!(
                f,
                "{name} in lanes would have {operations} operations, more than {LONGEST_IN_LANES}: {one_by_one}"
            ),
            (true, Some(numbers)) => write!(
                f,
                "{name} in lanes would have {numbers} numbers in memory, more than {WIDEST_IN_LANES}: {one_by_one}"
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
