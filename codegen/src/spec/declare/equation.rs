//! Equations of a spec, `left = right`, as differences that must vanish.

use super::super::ast::Equation;
use super::super::code;
use super::super::evaluate::Evaluator;
use crate::diagnostic::Diagnostic;
use crate::expr::{Application, Atom, Expr, Function, Role};

/// Left side minus right side, entry by entry.
pub(super) fn difference(equation: &Equation, evaluator: &mut Evaluator<'_>) -> Option<Vec<Expr>> {
    let left = evaluator.value(&equation.left);
    let right = evaluator.value(&equation.right);
    let (left, right) = (left?, right?);
    let difference = left.minus(&right);
    if difference.is_none() {
        let message = format!("{} cannot equal {}", left.describe(), right.describe());
        let error = Diagnostic::new(code::SHAPES, equation.span(), message);
        evaluator.report(
            error
                .label("the shapes do not fit")
                .help("both sides are scalars, or matrices of one shape"),
        );
    }
    difference
}

/// The difference of two scalars.
pub(super) fn scalar(equation: &Equation, evaluator: &mut Evaluator<'_>) -> Option<Expr> {
    let difference = difference(equation, evaluator)?;
    if let [entry] = difference.as_slice() {
        return Some(entry.clone());
    }
    let message = format!("an equation of {} scalars", difference.len());
    let error = Diagnostic::new(code::SHAPES, equation.span(), message);
    evaluator.report(
        error.label("one scalar is expected").help(
            "write one statement for each set; the zeros of a vector a are those of dot(a, a)",
        ),
    );
    None
}

/// Whether the expression depends on Q.
pub(super) fn of_configuration(expression: &Expr) -> bool {
    let symbols = expression.symbols();
    symbols.iter().any(|symbol| symbol.role == Role::Coordinate)
}

/// A function in the expression, if it is no polynomial in its symbols; quotients by parameters count as polynomial.
pub(super) fn function_in(expression: &Expr) -> Option<Application> {
    expression.atoms().into_iter().find_map(|atom| match atom {
        Atom::Apply(application) if application.function != Function::Pi => {
            Some((*application).clone())
        }
        _ => None,
    })
}
