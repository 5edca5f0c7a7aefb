//! Kernels in the author's words, and in few operations.
//!
//! A normal form is all or nothing: where one term of a sum needs a relation, it rewrites the others too. Here multiples `m r` of single
//! relations `r = 0` are subtracted as long as that shortens the sum, so that `R₁₁ R₂₂ − R₁₂ R₂₁` becomes `R₃₃` wherever it stands, with any
//! factor, `R₃₃² / √(1 − R₃₃²) + √(1 − R₃₃²)` becomes `1 / √(1 − R₃₃²)`, and what the spec calls `lean` is called so. Each step subtracts 0,
//! so that every form has one value; what is found is checked as proofs are.

mod bias;
mod kernels;
mod laurent;
mod search;
mod twists;
mod verify;
mod views;
mod words;

pub use views::{View, Written, in_words};

use crate::expr::{Atom, Expr, Function, Symbol};
use laurent::{Relation, Ring};
use std::collections::BTreeSet;

/// A form of the expression that takes fewer operations, found by subtracting multiples of relations: of those that are given, some of
/// which define a name, and of those between the functions. No form divides by what the expression does not divide by.
fn shortened<'a>(
    expression: &Expr,
    functions: &BTreeSet<Atom>,
    given: impl Iterator<Item = (Option<&'a Symbol>, &'a Expr)>,
) -> Expr {
    let mut ring = Ring::of(functions);
    let sum = ring.sum(expression);
    let symbols = expression.symbols();
    let near = |relation: &Expr| relation.contains_any(&symbols);
    let given = given.filter(|(_, relation)| near(relation));
    let mut all: Vec<Relation> = given.map(|(name, r)| ring.relation(r, name)).collect();
    let of_functions = relations(functions).into_iter().filter(near);
    all.extend(of_functions.map(|relation| ring.relation(&relation, None)));
    all.extend(ring.definitions());
    ring.expression(&search::shortened(sum, &all))
}

/// What sines, roots and their like satisfy. Quotients are powers here and satisfy nothing.
fn relations(functions: &BTreeSet<Atom>) -> BTreeSet<Expr> {
    let is_quotient = |atom: &Atom| matches!(atom, Atom::Apply(application) if application.function == Function::Recip);
    let others = functions.iter().filter(|atom| !is_quotient(atom));
    others
        .flat_map(|atom| Expr::atom(atom.clone()).atom_relations())
        .collect()
}

#[cfg(test)]
mod tests;
