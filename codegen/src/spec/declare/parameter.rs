//! Parameters: the range of each, and `require` between them.

use super::super::ast::{Bound, Bounds, Requirement};
use super::super::code;
use super::super::comments::one_line;
use super::super::evaluate::Evaluator;
use super::equation;
use super::once::{At, Once};
use crate::diagnostic::Diagnostic;
use crate::expr::Expr;
use crate::model::{self, Declared, End, Interval};

/// The interval that a range declares; the unbounded one where it is wrong, which was reported.
pub(super) fn interval(bounds: &Bounds, evaluator: &mut Evaluator<'_>) -> Interval {
    let mut end = |bound: &Option<Bound>| match bound {
        Some(bound) => self::end(bound, evaluator).map(Some),
        None => Some(None),
    };
    let ends = (end(&bounds.lower), end(&bounds.upper));
    let (Some(lower), Some(upper)) = ends else {
        return Interval::default();
    };
    let interval = Interval { lower, upper };
    if is_empty(&interval) {
        let error = Diagnostic::new(
            code::RANGE,
            bounds.span.clone(),
            "no number is in this range",
        );
        evaluator.report(
            error
                .label("empty")
                .help("`in 0..1` leaves out the 1, `in 0..=1` has it"),
        );
    }
    interval
}

fn end(bound: &Bound, evaluator: &mut Evaluator<'_>) -> Option<End> {
    let span = &bound.value.span;
    let value = evaluator.bounded("a range", span, |evaluator| evaluator.value(&bound.value))?;
    let number = value.as_scalar().and_then(Expr::as_rational);
    if number.is_none() {
        let message = format!(
            "an end of a range is an exact number, found {}",
            value.describe()
        );
        let error = Diagnostic::new(code::RANGE, span.clone(), message).label("not a number");
        evaluator.report(error.help("compare parameters by `require a > b;`"));
    }
    Some(End {
        value: number?,
        included: bound.included,
    })
}

fn is_empty(interval: &Interval) -> bool {
    match (&interval.lower, &interval.upper) {
        (Some(lower), Some(upper)) if lower.value == upper.value => {
            !(lower.included && upper.included)
        }
        (Some(lower), Some(upper)) => lower.value > upper.value,
        _ => false,
    }
}

/// All requirements; those that are wrong are reported and left out.
pub(super) fn requirements(
    statements: &Once<'_>,
    source: &str,
    evaluator: &mut Evaluator<'_>,
) -> Vec<Declared<model::Requirement>> {
    let requirements = statements.requirements.iter();
    requirements
        .filter_map(|at| {
            Some(Declared {
                value: model::Requirement {
                    value: requirement(*at, evaluator)?,
                    text: one_line(&source[at.value.span()]),
                },
                span: at.span.clone(),
            })
        })
        .collect()
}

/// Larger side minus smaller side.
fn requirement(at: At<'_, Requirement>, evaluator: &mut Evaluator<'_>) -> Option<Expr> {
    let sides = evaluator.bounded("require", at.span, |evaluator| {
        let larger = evaluator.value(&at.value.larger);
        let smaller = evaluator.value(&at.value.smaller);
        Some((larger?, smaller?))
    })?;
    let (Some(larger), Some(smaller)) = (sides.0.as_scalar(), sides.1.as_scalar()) else {
        let (a, b) = (sides.0.describe(), sides.1.describe());
        let message = format!("cannot compare {a} and {b}");
        let error = Diagnostic::new(code::SHAPES, at.value.span(), message);
        evaluator.report(error.label("the sides of a comparison are scalars"));
        return None;
    };
    let value = larger - smaller;
    match wrong(at, &value) {
        None => Some(value),
        Some(error) => {
            evaluator.report(error);
            None
        }
    }
}

/// Why this is no condition on the parameters, if it is none.
fn wrong(at: At<'_, Requirement>, value: &Expr) -> Option<Diagnostic> {
    let error = |message: &str| Diagnostic::new(code::REQUIREMENT, at.value.span(), message);
    if equation::of_configuration(value) {
        return Some(
            error("a requirement is about parameters alone")
                .label("depends on the configuration")
                .help("where Q must not come is said by `except a = b;`"),
        );
    }
    if value.symbols().is_empty() {
        let error = error("a requirement between numbers").label("no parameter occurs here");
        return Some(error.help("compare parameters: `require outer > inner;`"));
    }
    equation::function_in(value).map(|_| {
        error("a requirement is a polynomial in the parameters")
            .label("not a polynomial")
            .help("multiply both sides by divisors, square roots away")
    })
}
