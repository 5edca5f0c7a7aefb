//! Expressions that are positive as another form of them shows.

use super::{Sign, Signs};
use crate::domain::constant::{self, ConstantSign};
use crate::domain::{factors, quadratics};
use crate::expr::{Atom, Expr, Monomial, Rational, budget};
use std::collections::BTreeMap;

/// Most terms of expressions of which other forms are looked at.
const MOST_TERMS: usize = 12;
/// Most term operations for showing that an expression is positive by other forms of it.
const OF_OTHER_FORMS: u64 = 20_000;

impl Signs {
    /// Whether another form of the expression shows that it is positive: that without functions and denominators that are positive, or as a quadratic polynomial. Searches ask for the
    /// signs of many long expressions, which this would make longer.
    pub fn has_positive_form(&self, expression: &Expr) -> bool {
        let other_forms = || {
            let rest = self.without_denominators(&self.without_positive_factors(expression));
            let is_shorter = rest != *expression;
            is_shorter && self.exceeds(&rest, false) || self.is_positive_quadratic(&rest)
        };
        expression.terms().len() <= MOST_TERMS
            && budget::scope(OF_OTHER_FORMS, other_forms).unwrap_or(false)
    }

    /// The expression without functions that are positive and divide every term.
    fn without_positive_factors(&self, expression: &Expr) -> Expr {
        let common = factors::of_all_terms(expression).into_iter();
        let positive = common.filter(|(atom, _)| self.sign_of_atom(atom) == Sign::Positive);
        positive.fold(expression.clone(), |rest, (atom, power)| {
            let factor = Expr::atom(atom).pow(power);
            rest.exact_quotient(&factor).unwrap_or(rest)
        })
    }

    /// The expression times powers of parameters that are positive, so that no parameter stands in a denominator.
    fn without_denominators(&self, expression: &Expr) -> Expr {
        let units = expression
            .terms()
            .flat_map(|(monomial, _)| monomial.units());
        let mut powers: BTreeMap<Atom, i32> = BTreeMap::new();
        for (atom, power) in units.filter(|(_, power)| *power < 0) {
            let least = powers.entry(atom.clone()).or_default();
            *least = (*least).min(*power);
        }
        let cleared = powers
            .into_iter()
            .fold(Monomial::one(), |all, (atom, power)| {
                // Of a parameter of either sign an even power is positive.
                let is_positive = self.sign_of_unit(&atom, 1) == Sign::Positive;
                let size = power.unsigned_abs() + u32::from(!is_positive && power % 2 != 0);
                (0..size).fold(all, |all, _| all.times(&Monomial::atom(atom.clone())))
            });
        expression.scaled(&Rational::from(1), &cleared)
    }

    /// Whether the expression is `a x² + b x + c` in one of its functions or scalars x, and positive: for every x, as a > 0 and 4ac > b²; or for every x from −1 to 1, as a ≤ 0
    /// and it is positive at both ends.
    fn is_positive_quadratic(&self, expression: &Expr) -> bool {
        let positive =
            |e: &Expr| self.exceeds(e, false) || constant::sign(e) == Some(ConstantSign::Positive);
        quadratics::all(expression).iter().any(|(x, [c, b, a])| {
            let bends_down = || self.is_not_negative(&-a);
            let is_bounded = || {
                self.bound_of_atom(x)
                    .is_some_and(|bound| bound <= Rational::from(1))
            };
            let (ends, discriminant) = (a + c, &b.square() - &(&(a * c) * &Expr::integer(4)));
            positive(a) && positive(&-&discriminant)
                || is_bounded() && bends_down() && positive(&(&ends + b)) && positive(&(&ends - b))
        })
    }
}
