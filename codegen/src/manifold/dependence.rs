//! Linear dependence of polynomials whose coefficients are functions of parameters, by elimination without division.

use crate::expr::{Expr, Monomial};
use std::collections::BTreeMap;

/// A combination of the polynomials so far that has a leading monomial of its own.
#[derive(Clone, Debug)]
pub struct Row {
    /// Coefficients by monomial.
    entries: BTreeMap<Monomial, Expr>,
    /// The factors of the polynomials in it.
    combination: Vec<Expr>,
}

/// Adds polynomial number `n`; the factors of a combination of all so far that is 0, not all of them 0, where there is one.
pub fn add(rows: &mut Vec<Row>, polynomial: &Expr, n: usize) -> Option<Vec<Expr>> {
    let mut combination = vec![Expr::zero(); n + 1];
    combination[n] = Expr::one();
    let mut row = Row {
        entries: coefficients(polynomial),
        combination,
    };
    for known in rows.iter() {
        row.eliminate(known);
    }
    match row.entries.is_empty() {
        true => Some(row.combination).filter(|c| c.iter().any(|factor| !factor.is_zero())),
        false => {
            rows.push(row);
            None
        }
    }
}

impl Row {
    /// Takes the leading monomial of `other` out: `row · pivot − other · entry`.
    fn eliminate(&mut self, other: &Self) {
        let Some((monomial, pivot)) = other.entries.last_key_value() else {
            return;
        };
        let Some(entry) = self.entries.get(monomial).cloned() else {
            return;
        };
        for value in self.entries.values_mut().chain(&mut self.combination) {
            *value = &*value * pivot;
        }
        for (monomial, value) in &other.entries {
            *self.entries.entry(monomial.clone()).or_default() -= &(value * &entry);
        }
        for (own, value) in self.combination.iter_mut().zip(&other.combination) {
            *own -= &(value * &entry);
        }
        self.entries.retain(|_, value| !value.is_zero());
    }
}

/// The functions of parameters that stand before each monomial.
fn coefficients(polynomial: &Expr) -> BTreeMap<Monomial, Expr> {
    let mut found: BTreeMap<Monomial, Expr> = BTreeMap::new();
    for (monomial, coefficient) in polynomial.terms() {
        let (main, units) = monomial.split();
        *found.entry(main).or_default() += &Expr::term(coefficient.clone(), units);
    }
    found.retain(|_, value| !value.is_zero());
    found
}
