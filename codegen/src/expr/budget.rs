//! A bound on symbolic work, so that no spec, however wrong, makes the build hang.
//!
//! Arithmetic on expressions spends from the budget of the innermost [`scope`] of its thread, in proportion to the time that it takes. Once
//! it is spent, operations return zero at once, and the scope returns [`Exhausted`] instead of a result: a value made after exhaustion
//! never leaves it.

use std::cell::Cell;

thread_local! {
    static REMAINING: Cell<u64> = const { Cell::new(u64::MAX) };
    static TASK: Cell<&'static str> = const { Cell::new("") };
    static CLAIM: Cell<&'static str> = const { Cell::new("") };
}

/// The bound on symbolic work was reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exhausted {
    /// The bound, in term operations.
    pub limit: u64,
    /// What was being worked on, as `begin` named it.
    pub task: &'static str,
    /// The claim that was being proved, as `begin_claim` named it; empty before the first.
    pub claim: &'static str,
}

impl std::fmt::Display for Exhausted {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.task)?;
        if !self.claim.is_empty() {
            write!(f, " of `{}`", self.claim)?;
        }
        write!(f, ": more than {} term operations", self.limit)
    }
}

/// Runs `work` with at most `limit` term operations, and no more than the scope around it has left. A term operation is the
/// product of two short terms; others count as many of these as take the same time.
pub fn scope<T>(limit: u64, work: impl FnOnce() -> T) -> Result<T, Exhausted> {
    let given = limit.min(REMAINING.get());
    let outer = REMAINING.replace(given);
    let result = work();
    let left = REMAINING.replace(outer);
    spend(given - left.min(given));
    match left {
        0 => Err(Exhausted {
            limit,
            task: TASK.get(),
            claim: CLAIM.get(),
        }),
        _ => Ok(result),
    }
}

/// Runs `work`, and says how many term operations it took.
pub fn measured<T>(work: impl FnOnce() -> T) -> (T, u64) {
    let before = REMAINING.get();
    let result = work();
    (result, before - REMAINING.get())
}

/// Names what is worked on from here, unless the budget is spent: what spent it keeps its name.
pub fn begin(task: &'static str) {
    if !is_exhausted() {
        TASK.set(task);
        CLAIM.set("");
    }
}

/// Names the claim that is proved from here within the task, in the same way.
pub fn begin_claim(claim: &'static str) {
    if !is_exhausted() {
        CLAIM.set(claim);
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
