//! Derivatives of relations along the standard directions of G.

use crate::domain::Domain;
use crate::expand::motion::Motion;
use crate::expr::Expr;
use crate::manifold::Ideal;
use crate::matrix::{Matrix, combinations};
use crate::prepare::Prepared;

/// Derivatives along the standard directions of G.
pub struct Directions<'a> {
    /// Derivatives along these directions, each alone.
    pub along: Motion,
    ideal: &'a Ideal,
    /// φ.
    pub relations: &'a [Expr],
    /// ∂φ, c×dim G.
    pub gradient: Matrix,
}

impl<'a> Directions<'a> {
    /// Those of the factors of the joint.
    pub fn new(joint: &'a Prepared) -> Self {
        let manifold = &joint.space.manifold;
        let along = Motion::of_known_manifold(manifold);
        let ideal = manifold.ideal();
        let relations = manifold.declared();
        let gradient = Matrix::from_fn(relations.len(), along.freedoms(), |i, j| {
            ideal.simplest(&along.along(&relations[i], j))
        });
        Self {
            along,
            ideal,
            relations,
            gradient,
        }
    }

    /// N and det(∂φ N) where the chosen directions are independent: of the standard directions that complete them, those with the
    /// shortest determinant.
    pub fn normal(&self, chosen: &Matrix, domain: &Domain<'_>) -> Option<(Matrix, Expr)> {
        let size = chosen.rows();
        let simplify = |e: &Expr| self.ideal.simplest(e);
        let candidates = combinations(size, size - chosen.columns());
        let complete = candidates.into_iter().filter_map(|rest| {
            let unit = |&n: &usize| Matrix::identity(size).column(n);
            let normal = Matrix::from_columns(size, &rest.iter().map(unit).collect::<Vec<_>>());
            let whole = chosen.beside(&normal).determinant(&Expr::clone);
            // Of numbers and parameters alone, as the chosen directions are.
            let is_regular = || domain.is_unit(&whole) || domain.nonzero(&whole).is_some();
            if whole.is_zero() || !is_regular() {
                return None;
            }
            let determinant = self.gradient.times(&normal).determinant(&simplify);
            (!self.ideal.vanishes(&determinant)).then_some((normal, determinant))
        });
        complete.min_by_key(|(_, determinant)| determinant.terms().len())
    }

    /// B for one degree of freedom: the maximal minors of ∂φ with alternating signs.
    pub fn cross_product(&self) -> Vec<Expr> {
        let size = self.gradient.columns();
        let simplify = |e: &Expr| self.ideal.simplest(e);
        let transposed = self.gradient.transpose();
        let minor = |left_out: usize| {
            let rows: Vec<usize> = (0..size).filter(|&n| n != left_out).collect();
            let minor = transposed.select_rows(&rows).determinant(&simplify);
            match left_out % 2 {
                0 => minor,
                _ => -&minor,
            }
        };
        (0..size).map(minor).collect()
    }

    /// The rates of the stored scalars along a combination of the directions.
    pub fn combined(&self, weights: &[Expr]) -> Vec<Expr> {
        let sum = |n: usize| -> Expr {
            let terms = weights.iter().enumerate();
            terms
                .map(|(d, weight)| weight * &self.along.direction(d)[n])
                .sum()
        };
        let count = self.along.direction(0).len();
        (0..count).map(|n| self.ideal.simplest(&sum(n))).collect()
    }

    /// The derivatives of functions along a combination of the directions.
    pub fn combined_of(&self, functions: &[Expr], weights: &Matrix) -> Vec<Expr> {
        let along = |function: &Expr| -> Expr {
            let directions = (0..weights.rows()).filter(|&d| !weights.at(d, 0).is_zero());
            let terms = directions.map(|d| weights.at(d, 0) * &self.along.along(function, d));
            terms.sum()
        };
        functions.iter().map(along).collect()
    }

    /// `½ (L_a L_b + L_b L_a) f` with a and b the columns i and j of `tangent`, held constant.
    pub fn symmetric(&self, function: &Expr, tangent: &Matrix, i: usize, j: usize) -> Expr {
        let size = tangent.rows();
        let once: Vec<Expr> = (0..size).map(|d| self.along.along(function, d)).collect();
        let twice = |i: usize, j: usize| -> Expr {
            let pairs = (0..size).flat_map(|d| (0..size).map(move |e| (d, e)));
            let weighted = pairs.filter_map(|(d, e)| {
                let weight = tangent.at(d, i) * tangent.at(e, j);
                (!weight.is_zero()).then(|| &weight * &self.along.along(&once[e], d))
            });
            weighted.sum()
        };
        match i == j {
            true => twice(i, i),
            false => &(&twice(i, j) + &twice(j, i)) * &Expr::fraction(1, 2),
        }
    }
}
