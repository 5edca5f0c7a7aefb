//! The names in which the tangent basis is derived: they solve the linear systems that define them, and change along ϕ as is said.
//!
//! All other claims about motion then hold for any values of the names, or as multiples of these systems: no name is written out.

use super::{Attempt, Prover};
use crate::expand::{Flow, Motion, RelationDirections, Systems};
use crate::expr::{Expr, Role, Symbol};
use crate::kernel::Word;
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use std::collections::{BTreeMap, BTreeSet};

/// The relations along the names of B, from the definitions.
pub(super) struct Relations<'a> {
    directions: RelationDirections<'a>,
    flow: &'a Flow,
    motion: &'a Motion,
    /// ∂φ, as it is by definition.
    gradient: Matrix,
}

impl Prover<'_> {
    /// The relations along the names of B, where it has names.
    pub(super) fn relations(&self) -> Option<(Relations<'_>, &Systems)> {
        let flow = self.x.flow.as_ref()?;
        let directions = RelationDirections::new(self.joint);
        let gradient = Matrix::from_fn(flow.gradient.rows(), flow.gradient.columns(), |r, d| {
            directions.along.along(&directions.relations[r], d)
        });
        let relations = Relations {
            directions,
            flow,
            motion: &self.x.motion,
            gradient,
        };
        Some((relations, &flow.systems))
    }

    /// The names of B, of λ and of the rates of B are what they are said to be.
    pub(super) fn names_solve_systems(&self) -> Attempt {
        let Some((relations, systems)) = self.relations() else {
            return Ok(None);
        };
        let residuals = [
            relations.definitions(systems),
            relations.solutions(systems, self.ideal),
            relations.rates(),
            relations.rate_along(systems),
        ];
        let residual = Matrix::column_vector(residuals.concat());
        self.identity(
            "tangent_basis_solves",
            "B and λ solve ∂φ B = 0 and ∂φ N λ = −D²φ(B, B)/2, and ∂B/∂ϕ is their derivative",
            &residual,
            |_| {
                self.fault(
                    crate::spec::code::DIMENSION,
                    "what was derived as B or λ does not solve its linear system",
                )
            },
        )
    }
}

impl Relations<'_> {
    /// Polynomials that vanish for the values of the names in B, with unknowns of their own: `∂φ B`, and `1 − Σ t_d B_d`, since B is not 0.
    pub(super) fn of_tangent(&self) -> Vec<Expr> {
        let tangent = &self.flow.tangent;
        let columns = 0..tangent.columns();
        let mut all: Vec<Expr> = columns
            .flat_map(|i| (0..self.gradient.rows()).map(move |r| (r, i)))
            .map(|(r, i)| self.first(r, i))
            .collect();
        for i in 0..tangent.columns() {
            let unknown = |d: usize| {
                let number = tangent.rows() * i + d;
                Expr::symbol(&Symbol::new(
                    Role::Intermediate,
                    number,
                    "part_of_direction",
                ))
            };
            let entries = tangent.column(i).into_iter().enumerate();
            let whole: Expr = entries.map(|(d, entry)| &unknown(d) * &entry).sum();
            all.push(&Expr::one() - &whole);
        }
        all
    }

    /// `∂φ B_i` of relation r: 0 by the definition of B.
    pub(super) fn first(&self, r: usize, i: usize) -> Expr {
        product(&self.gradient, r, &self.flow.tangent.column(i))
    }

    /// `½ (L_i L_j + L_j L_i) φ + ∂φ N λ_ij` of relation r: 0 by the definition of λ.
    pub(super) fn second(&self, r: usize, i: usize, j: usize) -> Expr {
        let relation = &self.directions.relations[r];
        let tangent = &self.flow.tangent;
        let bend = self.directions.symmetric(relation, tangent, i, j);
        &bend + &product(&self.gradient, r, &self.flow.corrections[i][j])
    }

    /// What the names of entries and of second derivatives stand for, less the definition of these.
    fn definitions(&self, systems: &Systems) -> Vec<Expr> {
        let stands_for = |named: &Expr| {
            let mut words = systems.words.iter().filter(|word| word.rates.is_empty());
            let word = words.find(|word| named.as_symbol() == Some(&word.symbol));
            word.map_or_else(|| named.clone(), |word| word.value.clone())
        };
        let entries = systems.gradient.entries().iter();
        let entries = entries.zip(self.gradient.entries());
        let entries = entries.map(|(named, plain)| &stands_for(named) - plain);
        let bends = self.places().into_iter().map(|(r, i, j)| {
            let relation = &self.directions.relations[r];
            let bend = self
                .directions
                .symmetric(relation, &self.flow.tangent, i, j);
            &stands_for(&systems.bends[i][j][r]) - &bend
        });
        entries.chain(bends).collect()
    }

    /// Both systems with the values of B and of λ, by Cramer's rule: entries and second derivatives are known by their names alone, except for those of λ that
    /// follow from a constant entry of B.
    fn solutions(&self, systems: &Systems, ideal: &Ideal) -> Vec<Expr> {
        let bends = systems.bends.iter().flatten().flatten();
        let given: BTreeSet<Symbol> = systems
            .gradient
            .entries()
            .iter()
            .chain(bends)
            .filter_map(|entry| entry.as_symbol().cloned())
            .filter(|symbol| symbol.role == Role::Intermediate)
            .collect();
        let solved = systems
            .words
            .iter()
            .filter(|word| !given.contains(&word.symbol));
        let solved: Vec<Word> = solved.cloned().collect();
        // The determinant of the second system is made of B where that is the cross product; else B stands on its right side alone.
        let of_second: Vec<Word> = match self.is_cross_product() {
            true => solved.clone(),
            false => solved
                .iter()
                .filter(|word| word.rates.is_empty())
                .cloned()
                .collect(),
        };
        let tangent = &self.flow.tangent;
        let first = (0..self.gradient.rows()).flat_map(|r| {
            let product = |i: usize| product(&systems.gradient, r, &tangent.column(i));
            (0..tangent.columns()).map(product).collect::<Vec<_>>()
        });
        let second = self.places().into_iter().map(|(r, i, j)| {
            let back = &self.flow.corrections[i][j];
            let system = &systems.bends[i][j][r] + &product(&systems.gradient, r, back);
            let plain = written_out(&system, &of_second);
            match ideal.vanishes(&plain) {
                true => Expr::zero(),
                false => written_out(&system, &systems.words),
            }
        });
        let first = first.map(|system| written_out(&system, &solved));
        first.chain(second).collect()
    }

    /// Whether B is the cross product, whose entries are what must not vanish together.
    fn is_cross_product(&self) -> bool {
        self.flow.regular.len() > 1
    }

    /// `∂/∂ϕ_l (∂φ B_i)` with the rates of B, less the multiples of both systems that it is.
    fn rates(&self) -> Vec<Expr> {
        let tangent = &self.flow.tangent;
        let along = &self.directions.along;
        let residual = |r: usize, i: usize, l: usize| {
            let slope = |d: usize| -> Expr {
                let terms = (0..tangent.rows()).filter(|&e| !tangent.at(e, l).is_zero());
                terms
                    .map(|e| tangent.at(e, l) * &along.along(self.gradient.at(r, d), e))
                    .sum()
            };
            let column = tangent.column(i).into_iter().enumerate();
            let moved: Expr = column.map(|(d, entry)| &slope(d) * &entry).sum();
            let rates: Vec<Expr> = (0..tangent.rows())
                .map(|d| self.motion.along(tangent.at(d, i), l))
                .collect();
            let whole = &moved + &product(&self.gradient, r, &rates);
            let slopes = self.flow.slopes[l].column(i).into_iter().enumerate();
            let turned: Expr = slopes.map(|(j, part)| &part * &self.first(r, j)).sum();
            &(&whole - &self.second(r, l, i)) + &turned
        };
        let k = tangent.columns();
        let places = (0..self.gradient.rows())
            .flat_map(|r| (0..k).flat_map(move |i| (0..k).map(move |l| (r, i, l))));
        places.map(|(r, i, l)| residual(r, i, l)).collect()
    }

    /// Of the rate of B as a cross product its part along B, less that by the chain rule; the others follow from ∂φ B = 0.
    fn rate_along(&self, systems: &Systems) -> Vec<Expr> {
        if !self.is_cross_product() {
            return vec![];
        }
        let tangent = &self.flow.tangent;
        let plain = self.directions.combined_of(&self.flow.regular, tangent);
        let entries = tangent.entries().iter().zip(&plain);
        let along: Expr = entries
            .map(|(entry, plain)| entry * &(&self.motion.along(entry, 0) - plain))
            .sum();
        let back = &self.flow.corrections[0][0];
        let is_made =
            |word: &&Word| word.rates.is_empty() && !back.contains(&Expr::symbol(&word.symbol));
        let words: Vec<Word> = systems.words.iter().filter(is_made).cloned().collect();
        vec![written_out(&along, &words)]
    }

    /// Relations and pairs of columns of B.
    fn places(&self) -> Vec<(usize, usize, usize)> {
        let k = self.flow.tangent.columns();
        let pairs = (0..k).flat_map(|i| (0..=i).map(move |j| (i, j)));
        let relations = 0..self.gradient.rows();
        relations
            .flat_map(|r| pairs.clone().map(move |(i, j)| (r, i, j)))
            .collect()
    }
}

/// Row r of a matrix times a column.
fn product(matrix: &Matrix, r: usize, column: &[Expr]) -> Expr {
    let entries = column.iter().enumerate();
    entries.map(|(d, entry)| matrix.at(r, d) * entry).sum()
}

/// The expression with the values of these names in their places, the last first.
pub(super) fn written_out(expression: &Expr, words: &[Word]) -> Expr {
    words.iter().rev().fold(expression.clone(), |whole, word| {
        whole.substitute(&BTreeMap::from([(word.symbol.clone(), word.value.clone())]))
    })
}
