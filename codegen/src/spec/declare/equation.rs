//! Equations of a spec, `left = right`, as differences that must vanish.

use super::super::ast::Equation;
use super::super::code;
use super::super::evaluate::Evaluator;
use crate::diagnostic::Diagnostic;
use crate::expr::{Application, Atom, Expr, Function, Role};
use crate::manifold::with_powers_of_numbers;

/// Left side minus right side, entry by entry; squares of roots of numbers are taken.
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
    Some(difference?.iter().map(with_powers_of_numbers).collect())
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

/// As [`function_in`], except for roots, sines and cosines of numbers, as `sqrt(3)`: they are numbers too.
pub(super) fn function_beside_numbers(expression: &Expr) -> Option<Application> {
    let is_number = |application: &Application| {
        let algebraic = [Function::Sqrt, Function::Cos, Function::Sin, Function::Pi];
        let of_number = |argument: &Expr| {
            argument.symbols().is_empty() && function_beside_numbers(argument).is_none()
        };
        algebraic.contains(&application.function) && application.arguments.iter().all(of_number)
    };
    expression.atoms().into_iter().find_map(|atom| match atom {
        Atom::Apply(application) if !is_number(&application) => Some((*application).clone()),
        _ => None,
    })
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
