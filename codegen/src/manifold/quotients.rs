//! Expressions without their quotients: they have the same zeros, and, times squares, the same signs.

use crate::expr::{Atom, Expr, Function, Monomial, Rational, budget};

/// The expression times even powers of its denominators, which has its sign wherever it is defined.
pub fn cleared_by_squares(expression: &Expr) -> Expr {
    let mut numerator = expression.clone();
    while let Some((quotient, denominator)) =
        quotient_in(&numerator).filter(|_| !budget::is_exhausted())
    {
        let highest = highest_power(&numerator, &quotient);
        numerator = cleared(&numerator, &quotient, &denominator);
        if highest % 2 == 1 {
            numerator = &numerator * &denominator;
        }
    }
    numerator
}

/// A quotient in the expression itself, with its denominator.
pub fn quotient_in(expression: &Expr) -> Option<(Atom, Expr)> {
    expression.atoms().into_iter().find_map(|atom| match &atom {
        Atom::Apply(application) if application.function == Function::Recip => {
            let denominator = application.arguments.first()?.clone();
            Some((atom, denominator))
        }
        _ => None,
    })
}

/// The expression times the highest power of the denominator in it.
pub fn cleared(expression: &Expr, quotient: &Atom, denominator: &Expr) -> Expr {
    let highest = highest_power(expression, quotient);
    let term = |(monomial, coefficient): (&Monomial, &Rational)| {
        let power = power_in(monomial, quotient);
        let single = Monomial::atom(quotient.clone());
        let rest = (0..power).try_fold(monomial.clone(), |rest, _| rest.divided_by(&single));
        let rest = Expr::term(coefficient.clone(), rest.unwrap_or_default());
        &rest * &denominator.pow((highest - power).unsigned_abs())
    };
    expression.terms().map(term).sum()
}

fn power_in(monomial: &Monomial, quotient: &Atom) -> i32 {
    monomial.power(quotient).max(0)
}

fn highest_power(expression: &Expr, quotient: &Atom) -> i32 {
    let powers = expression
        .terms()
        .map(|(monomial, _)| power_in(monomial, quotient));
    powers.max().unwrap_or(0)
}
