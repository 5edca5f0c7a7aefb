//! Functions of many states side by side.

use super::choice::pair_by_pair;
use super::least::least;
use super::{Kind, Loops, TooLong, compile_with};
use crate::emit::Function;
use crate::model::Model;
use crate::pairs::Tables;
use crate::prune::{Pruning, prune};

/// Operations that a function in lanes may have: the Rust compiler takes them once for each level of instructions.
pub(super) const LONGEST_IN_LANES: usize = 50_000;

/// Numbers that a function in lanes may have in memory, of eight states: 0.75 MB of the stack, besides what its loops keep for each other. Threads have 2 MB by default.
pub(super) const WIDEST_IN_LANES: usize = 12_000;

/// The function for many states side by side, which has no loops over like bodies. Long ones leave `pairs` of joints to loops of the runtime where these may be, as
/// in Rust.
///
/// # Errors
/// More operations than the Rust compiler takes in lanes within a minute, more numbers than the stack should hold.
pub fn compile_in_lanes(model: &Model, kind: Kind, pairs: bool) -> Result<Function, TooLong> {
    let links = prune(model, Pruning::ALL);
    let refused = |operations, numbers| TooLong {
        kind,
        in_lanes: true,
        operations,
        numbers,
    };
    let mut operations = least(model, kind);
    let mut found = None;
    if operations <= LONGEST_IN_LANES {
        let straight = compile_with(model, &links, kind, Loops::Never).function;
        operations = straight.written();
        found = (operations <= LONGEST_IN_LANES).then_some(straight);
    }
    if let (None, true, Some(&way)) = (&found, pairs, kind.pairwise(model).first()) {
        let paired = pair_by_pair(model, &links, (kind, way), Loops::Never);
        if paired.pairs.as_ref().is_some_and(Tables::serves_lanes) {
            operations = paired.written();
            found = (operations <= LONGEST_IN_LANES).then_some(paired);
        }
    }
    let function = found.ok_or_else(|| refused(operations, None))?;
    match numbers_in_lanes(&function) {
        numbers if numbers > WIDEST_IN_LANES => Err(refused(operations, Some(numbers))),
        _ => Ok(function),
    }
}

/// Numbers that a function in lanes has in memory for each state: arguments and results, and for loops over pairs those of the bodies and the factors of M̄.
fn numbers_in_lanes(function: &Function) -> usize {
    let arguments: usize = function.arguments.iter().map(|(_, size)| size).sum();
    let of_pairs = function
        .pairs
        .as_ref()
        .map_or(0, |tables| function.outputs.len() + tables.room_of_lanes());
    arguments + function.results() + of_pairs
}
