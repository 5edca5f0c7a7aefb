//! Derivatives of relations along the standard directions of G.

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
    pub fn normal(&self, chosen: &Matrix) -> Option<(Matrix, Expr)> {
        let size = chosen.rows();
        let simplify = |e: &Expr| self.ideal.simplest(e);
        let candidates = combinations(size, size - chosen.columns());
        let complete = candidates.into_iter().filter_map(|rest| {
            let unit = |&n: &usize| Matrix::identity(size).column(n);
            let normal = Matrix::from_columns(size, &rest.iter().map(unit).collect::<Vec<_>>());
            let whole = chosen.beside(&normal).determinant(&Expr::clone);
            if whole.is_zero() || whole.as_rational().is_none() {
                return None;
            }
            let determinant = self.gradient.times(&normal).determinant(&simplify);
            (!self.ideal.vanishes(&determinant)).then_some((normal, determinant))
        });
        complete.min_by_key(|(_, determinant)| determinant.terms().len())
    }

    /// B, N = ∂φᵀ and |B|² for one degree of freedom: the maximal minors of ∂φ with alternating signs.
    pub fn cross_product(&self) -> Option<(Matrix, Matrix, Expr)> {
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
        let tangent = Matrix::column_vector((0..size).map(minor).collect());
        let square: Expr = tangent.entries().iter().map(Expr::square).sum();
        let square = self.ideal.simplest(&square);
        (!tangent.is_zero() && !square.is_zero()).then_some((tangent, transposed, square))
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

    /// `N ∂²λ/∂ϕ_i∂ϕ_j = −N (∂φ N)⁻¹ ½ (L_i L_j + L_j L_i) φ`, in the standard directions.
    pub fn corrections(&self, tangent: &Matrix, normal: &Matrix) -> Option<Vec<Vec<Vec<Expr>>>> {
        let k = tangent.columns();
        let simplify = |e: &Expr| self.ideal.normal_form(e);
        let square = self.ideal.normal_forms(&self.gradient.times(normal));
        let inverse = square.determinant(&simplify).recip()?;
        let inverse = square.adjugate(&simplify).scale(&inverse);
        let correction = |i: usize, j: usize| {
            let bends = self
                .relations
                .iter()
                .map(|relation| simplify(&self.symmetric(relation, tangent, i, j)));
            let bends = Matrix::column_vector(bends.collect());
            let back = normal.times(&inverse.times(&bends)).map(|entry| -entry);
            self.ideal.simplest_entries(&back).entries().to_vec()
        };
        let rows = (0..k).map(|i| (0..k).map(|j| correction(i, j)).collect());
        Some(rows.collect())
    }
}

