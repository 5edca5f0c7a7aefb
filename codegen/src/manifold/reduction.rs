//! A Gröbner basis with the ring that it lives in.
//!
//! Parameters belong to the field of coefficients: that keeps bases small. A relation whose leading coefficient is a sum of
//! parameters (`q / (a + b)`, say) cannot be solved there; all parameters then become indeterminates, each beside its inverse.

use super::groebner::{self, NotMonic};
use crate::expr::{Atom, Expr, Monomial, Role, Symbol};
use std::collections::{BTreeMap, BTreeSet};

/// A Gröbner basis, over the field of parameters or over the rationals.
#[derive(Clone, Debug, Default)]
pub struct Reduction {
    basis: Vec<Expr>,
    /// Further relations that hold, not completed.
    rules: Vec<Expr>,
    /// The parameters that are indeterminates here, each with its stand-in and that of its inverse.
    freed: Vec<(Atom, Symbol, Symbol)>,
}

impl Reduction {
    /// The basis of the ideal of the relations.
    pub fn new(relations: &[Expr]) -> Self {
        Self::of(groebner::groebner_basis(relations), relations)
    }

    /// The basis of the ideal of this basis and further relations.
    pub fn with(&self, relations: &[Expr]) -> Self {
        let all = [&self.basis[..], relations].concat();
        match self.freed.is_empty() {
            true => Self::of(groebner::extended(&self.basis, relations), &all),
            false => {
                let own: Vec<Expr> = self.basis.iter().map(|e| self.bound(e)).collect();
                Self::with_free_parameters(&[&own[..], relations].concat())
            }
        }
    }

    /// Adds rules by which to rewrite, without completing them to a basis.
    pub fn add_rules(&mut self, relations: &[Expr]) {
        let rules = relations
            .iter()
            .filter_map(|relation| groebner::rule(&freely(relation, &self.freed)));
        self.rules.extend(rules);
    }

    fn of(basis: Result<Vec<Expr>, NotMonic>, relations: &[Expr]) -> Self {
        match basis {
            Ok(basis) => Self {
                basis,
                rules: vec![],
                freed: vec![],
            },
            Err(NotMonic { .. }) => Self::with_free_parameters(relations),
        }
    }

    fn with_free_parameters(relations: &[Expr]) -> Self {
        let units: BTreeSet<Atom> = relations.iter().flat_map(units_of).collect();
        let freed: Vec<(Atom, Symbol, Symbol)> =
            units.into_iter().enumerate().map(stand_ins).collect();
        let inverses = freed.iter().map(|(_, symbol, inverse)| {
            &(&Expr::symbol(symbol) * &Expr::symbol(inverse)) - &Expr::one()
        });
        let mut all: Vec<Expr> = inverses.collect();
        all.extend(relations.iter().map(|relation| freely(relation, &freed)));
        // Over the rationals every leading coefficient can be divided by, so that this does not fail.
        let basis = groebner::groebner_basis(&all).unwrap_or_default();
        Self {
            basis,
            rules: vec![],
            freed,
        }
    }

    /// The elements of the basis.
    pub fn basis(&self) -> &[Expr] {
        &self.basis
    }

    /// The elements of the basis, in the parameters themselves.
    pub fn relations(&self) -> Vec<Expr> {
        let relations = self.basis.iter().map(|e| self.bound(e));
        relations.filter(|e| !e.is_zero()).collect()
    }

    /// The normal form of an expression.
    pub fn normal_form(&self, expression: &Expr) -> Expr {
        let all: Vec<&Expr> = self.basis.iter().chain(&self.rules).collect();
        match self.freed.is_empty() {
            true => groebner::reduce(expression, &all),
            false => self.bound(&groebner::reduce(&freely(expression, &self.freed), &all)),
        }
    }

    /// The expression with the freed parameters as parameters again.
    fn bound(&self, expression: &Expr) -> Expr {
        let values = self.freed.iter().flat_map(|(unit, symbol, inverse)| {
            let value = Expr::atom(unit.clone());
            let reciprocal = value.recip().unwrap_or_default();
            [(symbol.clone(), value), (inverse.clone(), reciprocal)]
        });
        expression.substitute(&values.collect::<BTreeMap<_, _>>())
    }

    /// Whether the relations contradict each other.
    pub fn is_trivial(&self) -> bool {
        groebner::is_trivial(&self.basis)
    }
}

fn units_of(expression: &Expr) -> BTreeSet<Atom> {
    let factors = expression
        .terms()
        .flat_map(|(monomial, _)| monomial.units());
    factors.map(|(atom, _)| atom.clone()).collect()
}

fn stand_ins((index, unit): (usize, Atom)) -> (Atom, Symbol, Symbol) {
    let symbol = |n: usize, name: &str| Symbol::new(Role::Constant, n, &format!("{name}{index}"));
    (unit, symbol(2 * index, "p"), symbol(2 * index + 1, "r"))
}

/// The expression with the freed parameters as indeterminates.
fn freely(expression: &Expr, freed: &[(Atom, Symbol, Symbol)]) -> Expr {
    let term = |(monomial, coefficient): (&Monomial, &crate::expr::Rational)| {
        let (main, units) = monomial.split();
        units.units().iter().fold(
            Expr::term(coefficient.clone(), main),
            |product, (atom, power)| {
                let stand_in = freed.iter().find(|(unit, ..)| unit == atom);
                let factor = match (stand_in, *power < 0) {
                    (Some((_, symbol, _)), false) => Expr::symbol(symbol),
                    (Some((_, _, inverse)), true) => Expr::symbol(inverse),
                    (None, false) => Expr::atom(atom.clone()),
                    (None, true) => Expr::atom(atom.clone()).recip().unwrap_or_default(),
                };
                &product * &factor.pow(power.unsigned_abs())
            },
        )
    };
    expression.terms().map(term).sum()
}
