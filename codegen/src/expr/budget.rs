//! A bound on symbolic work, so that no spec, however wrong, makes the build hang.
//!
//! Arithmetic on expressions spends from the budget of the innermost [`scope`] of its thread. Once it is spent, operations
//! return zero at once, and the scope returns [`Exhausted`] instead of a result: a value made after exhaustion never leaves it.

use std::cell::Cell;

thread_local! {
    static REMAINING: Cell<u64> = const { Cell::new(u64::MAX) };
}

/// The bound on symbolic work was reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exhausted {
    /// The bound, in term operations.
    pub limit: u64,
}

/// Runs `work` with at most `limit` term operations (products of two terms).
pub fn scope<T>(limit: u64, work: impl FnOnce() -> T) -> Result<T, Exhausted> {
    let outer = REMAINING.replace(limit);
    let result = work();
    let left = REMAINING.replace(outer);
    spend(limit - left.min(limit));
    match left {
        0 => Err(Exhausted { limit }),
        _ => Ok(result),
    }
}

/// Spends `amount`; false where the budget is exhausted.
pub(crate) fn spend(amount: u64) -> bool {
    let left = REMAINING.get().saturating_sub(amount);
    REMAINING.set(left);
    left > 0
}

/// Whether the budget of the innermost scope is spent.
pub fn is_exhausted() -> bool {
    REMAINING.get() == 0
}
