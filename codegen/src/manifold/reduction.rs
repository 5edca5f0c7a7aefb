//! A Gröbner basis with the ring that it lives in.
//!
//! Parameters belong to the field of coefficients: that keeps bases small. A relation whose leading coefficient is a sum of
//! parameters (`q / (a + b)`, say) cannot be solved there; all parameters then become indeterminates, each beside its inverse.
//! Those of which the range holds 0 have none: where they occur they are indeterminates, so that nothing is divided by them.

use super::groebner::{self, NotMonic};
use crate::expr::{Atom, Expr, Monomial, Role, Symbol};
use std::collections::{BTreeMap, BTreeSet};

/// A Gröbner basis, over the field of parameters or over the rationals.
#[derive(Clone, Debug, Default)]
pub struct Reduction {
    basis: Vec<Expr>,
    /// Further relations that hold, not completed.
    rules: Vec<Expr>,
    /// The parameters that are indeterminates here.
    freed: Vec<Freed>,
}

/// A parameter as an indeterminate.
#[derive(Clone, Debug)]
struct Freed {
    unit: Atom,
    stand_in: Symbol,
    /// That of its inverse; none where the parameter may be 0.
    inverse: Option<Symbol>,
}

impl Reduction {
    /// The basis of the ideal of the relations.
    pub fn new(relations: &[Expr]) -> Self {
        let basis = groebner::groebner_basis(relations);
        Self::of(basis, relations, vec![], &BTreeSet::new())
    }

    /// The basis of the ideal of this basis and further relations; and rules by which to rewrite, without completing them to a
    /// basis. Nothing is divided by the `vanishing` parameters.
    pub fn with(&self, relations: &[Expr], rules: &[Expr], vanishing: &BTreeSet<Symbol>) -> Self {
        let own = self.relations();
        let held = |symbol: &&Symbol| {
            let mut all = own.iter().chain(relations).chain(rules);
            all.any(|e| e.contains(symbol))
        };
        let held = vanishing.iter().filter(held).cloned().map(Atom::Symbol);
        let held: Vec<Atom> = held.collect();
        let all = [&own[..], relations].concat();
        let mut reduction = match self.freed.is_empty() {
            true => Self::with_freed(&own, relations, held, vanishing),
            false => Self::with_free_parameters(&all, held, vanishing),
        };
        let freed = &reduction.freed;
        let rules = rules.iter().map(|rule| freely(rule, freed));
        reduction.rules = rules.filter_map(|rule| groebner::rule(&rule)).collect();
        reduction
    }

    /// The same with each rule reduced by those before it, so that a sum of rules, each times a number, has normal form 0.
    #[must_use]
    pub fn in_echelon(mut self) -> Self {
        for rule in std::mem::take(&mut self.rules) {
            let known: Vec<&Expr> = self.basis.iter().chain(&self.rules).collect();
            let reduced = groebner::reduce(&rule, &known);
            self.rules.extend(groebner::rule(&reduced));
        }
        self
    }

    /// The basis of a basis and further relations, with those parameters as indeterminates.
    fn with_freed(
        own: &[Expr],
        relations: &[Expr],
        units: Vec<Atom>,
        vanishing: &BTreeSet<Symbol>,
    ) -> Self {
        let of_own = |unit: &Atom| own.iter().any(|e| units_of(e).contains(unit));
        let is_basis = !units.iter().any(of_own);
        let freed = freed(units, vanishing);
        let free = |all: &[Expr]| all.iter().map(|e| freely(e, &freed)).collect::<Vec<_>>();
        let all = [own, relations].concat();
        let basis = match is_basis {
            true => groebner::extended(own, &free(relations)),
            false => groebner::groebner_basis(&free(&all)),
        };
        Self::of(basis, &all, freed, vanishing)
    }

    fn of(
        basis: Result<Vec<Expr>, NotMonic>,
        relations: &[Expr],
        freed: Vec<Freed>,
        vanishing: &BTreeSet<Symbol>,
    ) -> Self {
        match basis {
            Ok(basis) => Self {
                basis,
                rules: vec![],
                freed,
            },
            Err(NotMonic { .. }) => {
                let units = freed.into_iter().map(|freed| freed.unit).collect();
                Self::with_free_parameters(relations, units, vanishing)
            }
        }
    }

    /// The basis with all parameters in the relations, and those `units`, as indeterminates.
    fn with_free_parameters(
        relations: &[Expr],
        units: Vec<Atom>,
        vanishing: &BTreeSet<Symbol>,
    ) -> Self {
        let named = relations.iter().flat_map(units_of);
        let units: BTreeSet<Atom> = named.chain(units).collect();
        let freed = freed(units, vanishing);
        let inverses = freed.iter().filter_map(|unit| {
            let product = &Expr::symbol(&unit.stand_in) * &Expr::symbol(unit.inverse.as_ref()?);
            Some(&product - &Expr::one())
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
        if self.freed.is_empty() {
            return expression.clone();
        }
        let values = self.freed.iter().flat_map(|freed| {
            let value = Expr::atom(freed.unit.clone());
            let reciprocal = value.recip().unwrap_or_default();
            let inverse = freed.inverse.clone().map(|inverse| (inverse, reciprocal));
            [(freed.stand_in.clone(), value)].into_iter().chain(inverse)
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

fn freed(units: impl IntoIterator<Item = Atom>, vanishing: &BTreeSet<Symbol>) -> Vec<Freed> {
    let symbol = |n: usize, name: String| Symbol::new(Role::Constant, n, &name);
    let stand_ins = |(index, unit): (usize, Atom)| {
        let may_be_zero = matches!(&unit, Atom::Symbol(symbol) if vanishing.contains(symbol));
        let inverse = (!may_be_zero).then(|| symbol(2 * index + 1, format!("r{index}")));
        Freed {
            unit,
            stand_in: symbol(2 * index, format!("p{index}")),
            inverse,
        }
    };
    units.into_iter().enumerate().map(stand_ins).collect()
}

/// The expression with the freed parameters as indeterminates.
fn freely(expression: &Expr, freed: &[Freed]) -> Expr {
    if freed.is_empty() {
        return expression.clone();
    }
    let term = |(monomial, coefficient): (&Monomial, &crate::expr::Rational)| {
        let (main, units) = monomial.split();
        units.units().iter().fold(
            Expr::term(coefficient.clone(), main),
            |product, (atom, power)| {
                let freed = freed.iter().find(|freed| freed.unit == *atom);
                let stand_in = freed.and_then(|freed| match *power < 0 {
                    false => Some(&freed.stand_in),
                    true => freed.inverse.as_ref(),
                });
                let factor = match (stand_in, *power < 0) {
                    (Some(symbol), _) => Expr::symbol(symbol),
                    (None, false) => Expr::atom(atom.clone()),
                    (None, true) => Expr::atom(atom.clone()).recip().unwrap_or_default(),
                };
                &product * &factor.pow(power.unsigned_abs())
            },
        )
    };
    expression.terms().map(term).sum()
}
