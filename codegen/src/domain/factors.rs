//! Factors that are never zero, because the spec says that they are positive: what is left without them vanishes in the same places.

use crate::expr::{Atom, Expr, Monomial, Rational, Symbol};
use num_traits::One;

/// The expression without those factors that are powers of the conditions, functions of parameters that are never 0.
pub fn without<'c>(expression: &Expr, conditions: impl IntoIterator<Item = &'c Expr>) -> Expr {
    conditions
        .into_iter()
        .fold(expression.clone(), |mut rest, condition| {
            while let Some(quotient) = quotient(&rest, condition) {
                rest = quotient;
            }
            rest
        })
}

/// The quotient of an expression, not 0, by a condition that is linear in some parameter, where it is a polynomial in that.
fn quotient(expression: &Expr, condition: &Expr) -> Option<Expr> {
    let (symbol, slope) = linear(condition)?;
    let inverse = slope.recip()?;
    if condition.terms().len() < 2 {
        return None;
    }
    let unit = Atom::Symbol(symbol);
    let mut rest = expression.clone();
    let mut quotient = Expr::zero();
    loop {
        let power = |(monomial, _): &(&Monomial, &Rational)| power_of(monomial, &unit);
        let Some((monomial, coefficient)) = rest.terms().max_by_key(power) else {
            return (!quotient.is_zero()).then_some(quotient);
        };
        if power_of(monomial, &unit) < 1 {
            return None;
        }
        let term = Expr::term(coefficient.clone(), monomial.times(&inverse));
        rest -= &(&term * condition);
        quotient += &term;
    }
}

/// A parameter that occurs in one term alone, to the first power and with coefficient 1; and that term.
fn linear(condition: &Expr) -> Option<(Symbol, Monomial)> {
    let candidates = condition.symbols().into_iter();
    let mut found = candidates.filter_map(|symbol| {
        let unit = Atom::Symbol(symbol.clone());
        let mut with = condition.terms().filter(|(m, _)| power_of(m, &unit) != 0);
        let (monomial, coefficient) = with.next()?;
        let alone = with.next().is_none() && power_of(monomial, &unit) == 1;
        (alone && coefficient.is_one()).then(|| (symbol, monomial.clone()))
    });
    found.next()
}

fn power_of(monomial: &Monomial, unit: &Atom) -> i32 {
    let mut factors = monomial.units().iter();
    factors
        .find(|(atom, _)| atom == unit)
        .map_or(0, |(_, power)| *power)
}

#[cfg(test)]
mod tests {
    use super::without;
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
}
