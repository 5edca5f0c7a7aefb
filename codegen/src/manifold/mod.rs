//! Configuration manifolds: products of known factors, and equality modulo their relations.

mod factor;
mod groebner;
mod ideal;
#[cfg(test)]
mod tests;

pub use factor::{Factor, Kind, LARGEST_REAL};
pub use groebner::NotMonic;
pub use ideal::Ideal;

use crate::expr::{Expr, Role, Symbol};

/// A product of known manifolds, with the ideal of its relations.
#[derive(Clone, Debug)]
pub struct Manifold {
    factors: Vec<Factor>,
    ideal: Ideal,
}

impl Manifold {
    /// The product of the named factors.
    pub fn new(factors: &[(String, Kind)]) -> Result<Self, NotMonic> {
        let factors = Self::factors_of(factors, Role::Coordinate);
        let relations: Vec<Expr> = factors.iter().flat_map(Factor::relations).collect();
        Ok(Self {
            factors,
            ideal: Ideal::new(&relations)?,
        })
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
                        &format!("{}_target", original.name),
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
        self.factors.iter().flat_map(Factor::relations).collect()
    }

    /// Equality on the manifold.
    pub fn ideal(&self) -> &Ideal {
        &self.ideal
    }

    /// The stored scalars of the home configuration.
    pub fn home(&self) -> Vec<Expr> {
        self.factors.iter().flat_map(Factor::home).collect()
    }

    /// Dimension of the manifold.
    pub fn dimension(&self) -> usize {
        self.factors
            .iter()
            .map(|factor| factor.kind.dimension())
            .sum()
    }
}
