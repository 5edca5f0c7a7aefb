//! Sums that several entries of a kernel share, once each is divided by a product: `a x + a y` and `b y + b x` share `x + y`.
//!
//! Division of sums by cubes, greedy on what it saves (Rajski and Vasudevamurthi 1992, *The testability-preserving
//! concurrent decomposition and factorization of Boolean expressions*, with numbers as coefficients). Only the distributive
//! law is used: the expanded sum of products stays the same, term by term, so that rounding stays in proportion to its
//! largest term.

mod cube;
mod greedy;
mod numbers;
mod pool;

use super::Node;
use crate::expr::Expr;
use pool::Pool;

/// Formulas of the expressions, with equal parts where sums are shared; in the order given. `None` where no sum is shared, and each is
/// factored alone.
pub fn shared_sums(expressions: &[Expr]) -> Option<Vec<Node>> {
    let mut pool = Pool::new(expressions);
    greedy::extract(&mut pool);
    (!pool.is_plain()).then(|| pool.formulas())
}
