//! Operations of the runtime's group functions, as a test counts them on the runtime itself.

use super::factor::module;
use crate::formula::Counts;
use crate::manifold::Kind;

/// A function of a group, with its operations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GroupFunction {
    /// The module of the group in `hamel::group`.
    pub group: &'static str,
    /// The function.
    pub name: &'static str,
    /// Its operations.
    pub counts: Counts,
}

const fn row(
    group: &'static str,
    name: &'static str,
    [additions, multiplications, fused, divisions, calls]: [usize; 5],
) -> GroupFunction {
    GroupFunction {
        group,
        name,
        counts: Counts {
            additions,
            multiplications,
            fused,
            divisions,
            calls,
        },
    }
}

/// Additions, multiplications (each with the fused ones), fused, divisions and calls of functions that are no arithmetic. Real vectors are
/// counted by their size.
pub const FUNCTIONS: &[GroupFunction] = &[
    row("s1", "times_exp", [2, 4, 0, 0, 1]),
    row("s1", "rate", [0, 2, 0, 0, 0]),
    row("s1", "log_between", [2, 4, 1, 0, 1]),
    row("s1", "nearest", [1, 4, 1, 1, 1]),
    row("s1", "residual_squared", [2, 3, 1, 0, 0]),
    row("so2", "times_exp", [4, 8, 4, 0, 1]),
    row("so2", "rate", [0, 4, 0, 0, 0]),
    row("so2", "log_between", [2, 4, 2, 0, 1]),
    row("so2", "nearest", [3, 6, 1, 1, 1]),
    row("so2", "residual_squared", [6, 5, 3, 0, 0]),
    row("se2", "times_exp", [11, 20, 10, 0, 2]),
    row("se2", "rate", [2, 8, 2, 0, 0]),
    row("se2", "log_between", [9, 15, 6, 0, 2]),
    row("se2", "differential", [3, 8, 0, 0, 2]),
    row("se2", "differential_inverse", [6, 11, 4, 0, 1]),
    row("se2", "nearest", [3, 6, 1, 1, 1]),
    row("se2", "residual_squared", [6, 5, 3, 0, 0]),
    row("s2", "nearest", [2, 6, 2, 1, 1]),
    row("s2", "residual_squared", [3, 4, 2, 0, 0]),
    row("s3", "times_exp", [14, 24, 14, 0, 2]),
    row("s3", "rate", [8, 16, 5, 0, 0]),
    row("s3", "log_between", [12, 16, 12, 0, 1]),
    row("s3", "differential", [14, 17, 0, 0, 2]),
    row("s3", "differential_inverse", [14, 21, 2, 0, 1]),
    row("s3", "nearest", [3, 8, 3, 1, 1]),
    row("s3", "residual_squared", [4, 5, 3, 0, 0]),
    row("so3", "times_exp", [32, 44, 18, 0, 2]),
    row("so3", "rate", [9, 18, 0, 0, 0]),
    row("so3", "log_between", [18, 27, 18, 0, 1]),
    row("so3", "differential", [14, 17, 0, 0, 2]),
    row("so3", "differential_inverse", [14, 21, 2, 0, 1]),
    row("so3", "nearest", [108, 216, 0, 0, 0]),
    row("so3", "residual_squared", [27, 34, 18, 0, 0]),
    row("se3", "times_exp", [54, 72, 29, 0, 2]),
    row("se3", "rate", [15, 27, 6, 0, 0]),
    row("se3", "log_between", [41, 57, 26, 0, 2]),
    row("se3", "differential", [51, 70, 5, 0, 4]),
    row("se3", "differential_inverse", [43, 59, 2, 0, 2]),
    row("se3", "nearest", [108, 216, 0, 0, 0]),
    row("se3", "residual_squared", [27, 34, 18, 0, 0]),
];

/// The operations of a function.
pub fn of(kind: Kind, name: &str) -> Counts {
    if let Kind::Real(size) = kind {
        return Counts {
            additions: size,
            ..Counts::default()
        };
    }
    let group = module(kind);
    let row = FUNCTIONS
        .iter()
        .find(|row| row.group == group && row.name == name);
    row.map_or_else(Counts::default, |row| row.counts)
}
