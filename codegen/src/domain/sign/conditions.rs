//! Signs of polynomials in the parameters, by what ranges and requirements say of these.

use super::{Sign, Signs};
use crate::expr::{Atom, Expr, Monomial, Rational};
use crate::model::{Interval, Parameter};

/// Most multiples of conditions that are taken together to show that a polynomial in the parameters is positive.
const MOST_CONDITIONS: usize = 8;
/// Most conditions of which products are formed.
const MOST_FACTORS: usize = 6;
/// Most combinations of conditions that are tried.
const MOST_TRIES: usize = 400;

/// A search for multiples of conditions.
struct Search<'a> {
    conditions: &'a [(Expr, bool)],
    /// Whether the multiples may have parameters in denominators: many more do nothing than without.
    by_quotients: bool,
    tries: usize,
}

impl Signs {
    /// The same of a polynomial in the parameters.
    pub(super) fn exceeds_zero(&self, sum: &Expr, enough: bool) -> bool {
        let by = |conditions, by_quotients| {
            let mut search = Search {
                conditions,
                by_quotients,
                tries: 0,
            };
            self.exceeds_by(sum, enough, &mut search, MOST_CONDITIONS)
        };
        // Without conditions there are no products either.
        let all = [&self.conditions, &self.with_products];
        let lists = if self.conditions.is_empty() {
            &all[..1]
        } else {
            &all
        };
        let mut tried = [false, true].into_iter();
        tried.any(|by_quotients| lists.iter().any(|list| by(list, by_quotients)))
    }

    /// Whether a polynomial in the parameters is positive, or not negative where that is enough: by its terms, or after subtracting
    /// multiples of conditions, each to cancel a term that may be negative.
    fn exceeds_by(&self, rest: &Expr, enough: bool, search: &mut Search<'_>, left: usize) -> bool {
        let may_be_negative =
            |(m, c): &(&Monomial, &Rational)| c.is_negative() || self.sign(m) == Sign::Unknown;
        let Some((monomial, coefficient)) = rest.terms().find(may_be_negative) else {
            let positive = |(m, _): (&Monomial, &Rational)| self.sign(m) == Sign::Positive;
            return enough || rest.terms().any(positive);
        };
        search.tries += 1;
        if left == 0 || search.tries > MOST_TRIES {
            return false;
        }
        search.conditions.iter().any(|(condition, strict)| {
            let same_sign = |c: &Rational| c.is_negative() == coefficient.is_negative();
            let mut terms = condition.terms().filter(|(_, c)| same_sign(c));
            terms.any(|(of_condition, c)| {
                let Some(units) = of_condition.recip().map(|m| monomial.times(&m)) else {
                    return false;
                };
                let is_refused = |(atom, power): &(Atom, i32)| {
                    let vanishes = matches!(atom, Atom::Symbol(s) if self.vanishing.contains(s));
                    *power < 0 && (vanishes || !search.by_quotients)
                };
                if units.units().iter().any(is_refused) {
                    return false;
                }
                let sign = self.sign(&units);
                let rest = rest - &condition.scaled(&(coefficient / c), &units);
                sign != Sign::Unknown
                    && self.exceeds_by(
                        &rest,
                        enough || (*strict && sign == Sign::Positive),
                        search,
                        left - 1,
                    )
            })
        })
    }
}

/// What the ends of a range say: `p − lower` and `upper − p` are not negative. Of a lower end below 0, or of the others; one that is 0 is the sign of the parameter.
pub(super) fn conditions_of(parameter: &Parameter, is_below_zero: bool) -> Vec<(Expr, bool)> {
    let (p, Interval { lower, upper, .. }) = (Expr::symbol(&parameter.symbol), &parameter.range);
    let above = lower.iter().filter(|end| match is_below_zero {
        true => end.value.is_negative(),
        false => end.value.is_positive(),
    });
    let above = above.map(|end| (&p - &Expr::rational(end.value.clone()), !end.included));
    let below = upper.iter().filter(|_| !is_below_zero);
    let below = below.map(|end| (&Expr::rational(end.value.clone()) - &p, !end.included));
    above.chain(below).collect()
}

/// The conditions, and the products of two each, squares among them.
pub(super) fn with_products(conditions: &[(Expr, bool)]) -> Vec<(Expr, bool)> {
    let first = &conditions[..conditions.len().min(MOST_FACTORS)];
    let with_later = first.iter().enumerate().flat_map(|(n, (a, strict))| {
        let later = first[n..].iter();
        later.map(move |(b, also)| (a * b, *strict && *also))
    });
    conditions.iter().cloned().chain(with_later).collect()
}
