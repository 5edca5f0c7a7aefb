//! The cosets of subgroups in which a basis moves Q.
//!
//! A basis of a subalgebra moves Q inside a coset of a subgroup: the linear relations that hold there join the manifold's, so
//! that inputs can be checked and projected. They are all relations of that subgroup where it is the group of units of a matrix algebra
//! within the whole group, as for the displacement subgroups of SE(3) without a screw.

use crate::algebra;
use crate::expr::Expr;
use crate::manifold::{Factor, Ideal};
use crate::matrix::Matrix;
use crate::model::JointSpec;

/// The linear relations of the cosets in which the basis moves Q.
pub fn relations(spec: &JointSpec) -> Vec<Expr> {
    let manifold = &spec.manifold.value;
    if !manifold.declared().is_empty() || spec.home.is_some() {
        return vec![];
    }
    let factors = manifold.factors().iter().enumerate();
    let relations = factors.flat_map(|(n, factor)| {
        let own = spec.freedoms_of(n);
        linear_relations(
            factor,
            own.map(|freedom| freedom.generator.clone()).collect(),
        )
    });
    relations.collect()
}

/// Linear functions of Q that vanish on the span of all products of the generators, the identity included.
fn linear_relations(factor: &Factor, generators: Vec<Vec<Expr>>) -> Vec<Expr> {
    let full = generators.len() >= factor.kind.dimension();
    let usable = generators
        .iter()
        .all(|g| !g.is_empty() && g.iter().all(|e| e.as_rational().is_some()));
    if full || generators.is_empty() || !usable {
        return vec![];
    }
    let elements: Vec<Matrix> = generators
        .iter()
        .map(|g| algebra::hat(factor.kind, g))
        .collect();
    let q = factor.matrix();
    let functionals = annihilator(&associative_span(&elements), q.entries().len());
    let on_q = |weights: &Vec<Expr>| -> Expr {
        weights
            .iter()
            .zip(q.entries())
            .map(|(w, entry)| w * entry)
            .sum()
    };
    let relations = functionals.iter().map(on_q);
    relations
        .filter(|relation| !relation.is_zero() && !factor_knows(factor, relation))
        .collect()
}

/// Whether a relation follows from those of the known manifold.
fn factor_knows(factor: &Factor, relation: &Expr) -> bool {
    Ideal::new(&factor.relations()).vanishes(relation)
}

/// A basis of the matrix algebra that the elements generate, reduced row by row.
fn associative_span(elements: &[Matrix]) -> Vec<Vec<Expr>> {
    let size = elements[0].rows();
    let mut members = vec![Matrix::identity(size)];
    let mut echelon: Vec<Vec<Expr>> = vec![];
    insert(&mut echelon, members[0].entries().to_vec());
    let mut next = 0;
    while next < members.len() {
        for element in elements {
            let product = members[next].times(element);
            if insert(&mut echelon, product.entries().to_vec()) {
                members.push(product);
            }
        }
        next += 1;
    }
    echelon
}

/// Adds a row to a reduced row echelon form; false where it depends on the others.
pub fn insert(echelon: &mut Vec<Vec<Expr>>, mut row: Vec<Expr>) -> bool {
    for known in echelon.iter() {
        if let Some(pivot) = leading(known) {
            let factor = row[pivot].clone();
            subtract(&mut row, known, &factor);
        }
    }
    let Some(pivot) = leading(&row) else {
        return false;
    };
    let inverse = row[pivot].recip().unwrap_or_default();
    row.iter_mut().for_each(|entry| *entry = &*entry * &inverse);
    for known in echelon.iter_mut() {
        let factor = known[pivot].clone();
        subtract(known, &row, &factor);
    }
    echelon.push(row);
    true
}

fn leading(row: &[Expr]) -> Option<usize> {
    row.iter().position(|entry| !entry.is_zero())
}

fn subtract(row: &mut [Expr], other: &[Expr], factor: &Expr) {
    if !factor.is_zero() {
        row.iter_mut()
            .zip(other)
            .for_each(|(entry, o)| *entry -= &(factor * o));
    }
}

/// The linear functions that vanish on all rows of a reduced echelon form.
fn annihilator(echelon: &[Vec<Expr>], size: usize) -> Vec<Vec<Expr>> {
    let pivots: Vec<usize> = echelon.iter().filter_map(|row| leading(row)).collect();
    let free = (0..size).filter(|column| !pivots.contains(column));
    free.map(|column| {
        let mut weights = vec![Expr::zero(); size];
        weights[column] = Expr::one();
        for (row, &pivot) in echelon.iter().zip(&pivots) {
            weights[pivot] = -&row[column];
        }
        weights
    })
    .collect()
}
