//! `relation`: polynomials in the stored scalars of Q that vanish on the manifold of the joint.

use super::super::ast::{Equation, Target};
use super::super::evaluate::Evaluator;
use super::super::{code, limits};
use super::equation;
use super::once::{At, Once};
use crate::diagnostic::Diagnostic;
use crate::expr::{Application, Expr, Function, Role, budget};
use crate::manifold::Manifold;
use crate::model::Declared;
use std::ops::Range;

/// The part of the manifold where all relations hold, and where each of them stands; the manifold itself where some are wrong, which was
/// reported.
pub(super) fn constrained(
    statements: &Once<'_>,
    manifold: &Declared<Manifold>,
    evaluator: &mut Evaluator<'_>,
) -> (Declared<Manifold>, Vec<Range<usize>>) {
    let (mut relations, mut spans) = (vec![], vec![]);
    for at in &statements.relations {
        let own = relation(*at, manifold, evaluator).unwrap_or_default();
        spans.extend(own.iter().map(|_| at.value.span()));
        relations.extend(own);
    }
    let constrained = match statements.relations_span() {
        Some(span) if !relations.is_empty() => {
            let has_retract = statements.target(Target::Retract).is_some();
            let manifold = &manifold.value;
            basis(relations, manifold, &span, evaluator, !has_retract)
        }
        _ => None,
    };
    let constrained = Declared {
        value: constrained.unwrap_or_else(|| manifold.value.clone()),
        span: manifold.span.clone(),
    };
    (constrained, spans)
}

/// The polynomials of one statement, each once.
fn relation(
    at: At<'_, Equation>,
    manifold: &Declared<Manifold>,
    evaluator: &mut Evaluator<'_>,
) -> Option<Vec<Expr>> {
    let entries = evaluator.bounded("relation", at.span, |evaluator| {
        equation::difference(at.value, evaluator)
    })?;
    let mut distinct: Vec<Expr> = vec![];
    for entry in entries {
        let known = |other: &Expr| *other == entry || *other == -&entry;
        if !entry.is_zero() && !distinct.iter().any(known) {
            distinct.push(entry);
        }
    }
    let error = match distinct.iter().find_map(equation::function_beside_numbers) {
        Some(function) => Some(not_polynomial(at, &function)),
        None => says_nothing(at, &distinct, &manifold.value),
    };
    match error {
        None => Some(distinct),
        Some(error) => {
            evaluator.report(error);
            None
        }
    }
}

fn not_polynomial(at: At<'_, Equation>, found: &Application) -> Diagnostic {
    let of_parameters = !found.arguments.iter().any(equation::of_configuration);
    let (found, advice) = match found.function {
        _ if of_parameters => (
            "a function of parameters",
            "make its value a parameter, in place of what it is computed from",
        ),
        Function::Sqrt => ("a square root", "square both sides: `dot(Q, Q) = r * r`"),
        Function::Recip => ("a quotient", "multiply both sides by the divisor"),
        Function::Cos | Function::Sin => (
            "a sine or cosine",
            "store the angle as a factor of S1, whose parts c and s are its cosine and sine",
        ),
        _ => (
            "a function",
            "bring its value into Q as a scalar of its own, or parametrise the joint by real coordinates",
        ),
    };
    let message =
        format!("a relation is a polynomial in the stored scalars of Q, this one holds {found}");
    Diagnostic::new(code::RELATION, at.value.span(), message)
        .label("not a polynomial")
        .help(advice)
}

/// The error that the relations hold everywhere already, or hold nowhere because Q is not in them.
fn says_nothing(
    at: At<'_, Equation>,
    relations: &[Expr],
    manifold: &Manifold,
) -> Option<Diagnostic> {
    let message = match relations.iter().find(|r| !equation::of_configuration(r)) {
        Some(_) => "a relation without the configuration",
        None if relations.iter().all(|r| manifold.ideal().vanishes(r)) => {
            "this relation holds everywhere on the factors of the configuration"
        }
        None => return None,
    };
    let error = Diagnostic::new(code::RELATIONS, at.value.span(), message);
    Some(
        match relations.iter().any(|r| !equation::of_configuration(r)) {
            true => error
                .label("no stored scalar of Q occurs here")
                .help("a condition on parameters is `require a > b;`"),
            false => error.label("says nothing").help("remove it"),
        },
    )
}

/// The manifold with the Gröbner basis of all relations. Where that takes too long and the relations alone are to say how Q moves, it is that
/// of the factors: the proofs of such joints take few steps.
fn basis(
    relations: Vec<Expr>,
    manifold: &Manifold,
    span: &Range<usize>,
    evaluator: &mut Evaluator<'_>,
    alone: bool,
) -> Option<Manifold> {
    let found = match evaluator.errors.is_empty() {
        true if alone => {
            let whole = || manifold.clone().constrained(relations.clone());
            match budget::scope(limits::RELATIONS_BUDGET, whole) {
                Ok(found) => Some(found),
                Err(_) => evaluator.bounded("relation", span, |_| {
                    Some(manifold.clone().constrained_in_part(relations.clone()))
                }),
            }
        }
        true => evaluator.bounded_by(limits::RELATIONS_BUDGET, "relation", span, |_| {
            Some(manifold.clone().constrained(relations.clone()))
        }),
        // In a spec that is wrong already, only a contradiction that is soon found is told.
        false => budget::scope(limits::RELATIONS_BUDGET_OF_WRONG, || {
            manifold.clone().constrained(relations.clone())
        })
        .ok(),
    }?;
    // What holds of roots and sines of numbers is no constraint.
    let constrains_parameters = |e: &Expr| {
        e.related_functions().is_empty()
            && e.symbols()
                .iter()
                .all(|symbol| symbol.role == Role::Parameter)
    };
    if !found.ideal().is_contradictory() && !found.ideal().basis().iter().any(constrains_parameters)
    {
        return Some(found);
    }
    let error = Diagnostic::new(
        code::RELATIONS,
        span.clone(),
        "these relations contradict each other",
    )
    .label("no configuration satisfies them")
    .note("1 is a combination of the relations");
    evaluator.report(error);
    None
}
