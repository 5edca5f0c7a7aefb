//! Configuration manifolds: products of known factors, and equality modulo their relations.

mod angles;
mod canonical;
mod dependence;
mod factor;
mod groebner;
mod ideal;
mod quotients;
mod reduction;
#[cfg(test)]
mod tests;

pub use angles::unified_all;
pub use factor::{Factor, Kind, LARGEST_CONSTRAINED_REAL, LARGEST_REAL};
pub use ideal::Ideal;
pub(crate) use ideal::weight;
pub use quotients::cleared_by_squares;

use crate::expr::{Expr, Role, Symbol};
use std::collections::BTreeSet;
use std::slice;

/// A product of known manifolds, or the part of it where declared relations hold, with the ideal of all relations.
#[derive(Clone, Debug)]
pub struct Manifold {
    factors: Vec<Factor>,
    declared: Vec<Expr>,
    /// Whether the declared relations are those of a coset, derived from a basis.
    is_coset: bool,
    ideal: Ideal,
}

/// What holds of the roots, sines and cosines of numbers in expressions, each once.
fn of_numbers(expressions: &[Expr]) -> Vec<Expr> {
    let relations = expressions.iter().flat_map(Expr::atom_relations);
    let found: BTreeSet<Expr> = relations.filter(|e| e.symbols().is_empty()).collect();
    found.into_iter().collect()
}

/// The expression with `sqrt(3) * sqrt(3)` as 3, and its like.
pub(crate) fn with_powers_of_numbers(expression: &Expr) -> Expr {
    match of_numbers(slice::from_ref(expression)) {
        none if none.is_empty() => expression.clone(),
        known => Ideal::new(&known).normal_form(expression),
    }
}

impl Manifold {
    /// The product of the named factors.
    pub fn new(factors: &[(String, Kind)]) -> Self {
        let factors = Self::factors_of(factors, Role::Coordinate);
        let relations: Vec<Expr> = factors.iter().flat_map(Factor::relations).collect();
        Self {
            factors,
            declared: vec![],
            is_coset: false,
            ideal: Ideal::of_known(relations),
        }
    }

    /// The part of this manifold where the polynomials in its stored scalars vanish.
    pub fn constrained(self, declared: Vec<Expr>) -> Self {
        let mut all = self.relations();
        all.extend_from_slice(&declared);
        all.extend(of_numbers(&declared));
        Self {
            ideal: Ideal::new(&all),
            declared: [self.declared, declared].concat(),
            is_coset: false,
            factors: self.factors,
        }
    }

    /// The same where a basis of all relations would take too long: equality is that modulo the relations of the factors alone.
    #[must_use]
    pub fn constrained_in_part(self, declared: Vec<Expr>) -> Self {
        let known = [self.relations(), of_numbers(&declared)].concat();
        let all = [&known[..], &declared].concat();
        Self {
            ideal: Ideal::incomplete(&known, &all),
            declared: [self.declared, declared].concat(),
            is_coset: false,
            factors: self.factors,
        }
    }

    /// The coset of a subgroup in this manifold, which linear relations cut out.
    #[must_use]
    pub fn confined(self, relations: Vec<Expr>) -> Self {
        Self {
            is_coset: true,
            ..self.constrained(relations)
        }
    }

    /// The same manifold where these parameters are known to be positive, and those may be 0.
    #[must_use]
    pub fn with_signs(mut self, positive: BTreeSet<Symbol>, vanishing: BTreeSet<Symbol>) -> Self {
        self.ideal = self.ideal.with_signs(positive, vanishing);
        self
    }

    /// The same manifold where arguments of roots are squares: see [`Ideal::with_squares`].
    #[must_use]
    pub fn with_squares(mut self, squares: &[(Expr, Expr)]) -> Self {
        self.ideal = self.ideal.with_squares(squares);
        self
    }

    /// The relations that join those of the factors: those that the spec declares, or those of a coset.
    pub fn declared(&self) -> &[Expr] {
        &self.declared
    }

    /// Whether these relations are those of a coset, so that their derivatives have one rank everywhere on it.
    pub fn is_coset(&self) -> bool {
        self.is_coset
    }

    fn factors_of(factors: &[(String, Kind)], role: Role) -> Vec<Factor> {
        let mut first = 0;
        let alone = factors.len() == 1;
        let make = |(name, kind): &(String, Kind)| {
            let factor = Factor::new(name, *kind, role, first, alone);
            first += factor.coordinates.len();
            factor
        };
        factors.iter().map(make).collect()
    }

    /// A second copy, for a second configuration Q′.
    pub fn target(&self) -> Vec<Factor> {
        let named = |factor: &Factor| (format!("{}_target", factor.name), factor.kind);
        let named: Vec<_> = self.factors.iter().map(named).collect();
        Self::factors_of(&named, Role::Target)
            .into_iter()
            .zip(&self.factors)
            .map(|(mut copy, factor)| {
                for (symbol, original) in copy.coordinates.iter_mut().zip(&factor.coordinates) {
                    *symbol = Symbol::new(
                        Role::Target,
                        original.index.into(),
                        &format!("{}_target", original.name()),
                    );
                }
                copy
            })
            .collect()
    }

    /// The factors, in storage order.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }

    /// All stored scalars, in storage order.
    pub fn coordinates(&self) -> Vec<Symbol> {
        self.factors
            .iter()
            .flat_map(|factor| factor.coordinates.clone())
            .collect()
    }

    /// The relations as they are stated, not their Gröbner basis.
    pub fn relations(&self) -> Vec<Expr> {
        let known = self.factors.iter().flat_map(Factor::relations);
        known.chain(self.declared.iter().cloned()).collect()
    }

    /// Equality on the manifold.
    pub fn ideal(&self) -> &Ideal {
        &self.ideal
    }

    /// The identity of each factor, as stored scalars.
    pub fn home(&self) -> Vec<Expr> {
        self.factors.iter().flat_map(Factor::home).collect()
    }

    /// Dimension of the product of the factors, declared relations apart.
    pub fn dimension(&self) -> usize {
        self.factors
            .iter()
            .map(|factor| factor.kind.dimension())
            .sum()
    }
}
