//! Factors that are never zero, because the spec says so: what is left without them vanishes in the same places.

use crate::expr::{Atom, Expr, Function, Monomial};
use std::collections::BTreeMap;

/// The expression without those factors that are powers of functions that are never 0.
pub fn without<'f>(expression: &Expr, never_zero: impl IntoIterator<Item = &'f Expr>) -> Expr {
    never_zero
        .into_iter()
        .filter(|factor| !factor.is_constant() || factor.terms().len() > 1)
        .fold(expression.clone(), |mut rest, factor| {
            while let Some(quotient) = rest.exact_quotient(factor).filter(|_| !rest.is_zero()) {
                rest = quotient;
            }
            rest
        })
}

/// The only term with u for `sinh(u)`, `tanh(u)` and `sqrt(u)`, which vanish where u does; other expressions as they stand.
pub fn vanishing_arguments(expression: &Expr) -> Expr {
    let vanishing = |atom: Atom| match &atom {
        Atom::Apply(application)
            if matches!(
                application.function,
                Function::Sinh | Function::Tanh | Function::Sqrt
            ) =>
        {
            let argument = application.arguments.first()?.clone();
            Some((atom, argument))
        }
        _ => None,
    };
    match expression.single_term() {
        Some(_) => {
            let values = expression
                .atoms()
                .into_iter()
                .filter_map(vanishing)
                .collect();
            expression.replace_atoms(&values)
        }
        None => expression.clone(),
    }
}

/// Functions and scalars of Q that divide every term, with their powers.
pub fn of_all_terms(expression: &Expr) -> Vec<(Atom, u32)> {
    let mut terms = expression.terms().map(|(monomial, _)| monomial.main());
    let mut common: Vec<(Atom, u32)> = terms.next().unwrap_or_default().to_vec();
    for factors in terms {
        common.retain_mut(|(atom, power)| {
            let found = factors.iter().find(|(other, _)| other == atom);
            *power = found.map_or(0, |(_, other)| *other.min(power));
            *power > 0
        });
    }
    common
}

/// The function of parameters by which all coefficients are multiples of it, where one of them is that, and what is left without it.
pub fn content(expression: &Expr) -> Option<(Expr, Expr)> {
    let mut coefficients: BTreeMap<Monomial, Expr> = BTreeMap::new();
    for (monomial, coefficient) in expression.terms() {
        let (main, units) = monomial.split();
        *coefficients.entry(main).or_default() += &Expr::term(coefficient.clone(), units);
    }
    let shortest = coefficients.into_values().min_by_key(|c| c.terms().len());
    let content = shortest.filter(|c| c.terms().len() > 1)?;
    let rest = expression.exact_quotient(&content)?;
    Some((content, rest))
}

#[cfg(test)]
mod tests {
    use super::{content, without};
    use crate::expr::{Expr, Role, Symbol};

    #[test]
    fn powers_of_a_condition_are_taken_out_and_nothing_else() {
        let parameter = |n: usize, name: &str| Expr::symbol(&Symbol::new(Role::Parameter, n, name));
        let (a, b) = (parameter(0, "a"), parameter(1, "b"));
        let x = Expr::symbol(&Symbol::new(Role::Coordinate, 0, "x"));
        let condition = &a - &b;
        let rest = &(&x * &a) + &b.square();
        let whole = &(&condition.square() * &rest) * &x;
        assert_eq!(without(&whole, [&condition]), &rest * &x);
        // Its opposite has a factor as well, and the sum has none.
        assert_eq!(without(&(&b - &a), [&condition]), -Expr::one());
        let sum = &a + &b;
        assert_eq!(without(&sum, [&condition]), sum);
        assert_eq!(without(&Expr::zero(), [&condition]), Expr::zero());
    }

    #[test]
    fn functions_of_parameters_that_all_terms_share_are_found() {
        let parameter = |n: usize, name: &str| Expr::symbol(&Symbol::new(Role::Parameter, n, name));
        let (a, b) = (parameter(0, "a"), parameter(1, "b"));
        let x = Expr::symbol(&Symbol::new(Role::Coordinate, 0, "x"));
        let (sum, rest) = (&a + &b, &(&x.square() * &a) + &Expr::one());
        assert_eq!(content(&(&sum * &rest)), Some((sum.clone(), rest)));
        assert_eq!(content(&(&(&sum * &x) + &a)), None);
        assert_eq!(content(&Expr::zero()), None);
    }
}
