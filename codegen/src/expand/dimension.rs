//! The dimension of the configuration manifold against the number of freedoms.
//!
//! A basis of a subalgebra moves Q inside a coset of a subgroup: the linear relations that hold there join the manifold's, so
//! that inputs can be checked and projected. They are all relations of that subgroup where it is the group of units of a matrix algebra
//! within the whole group, as for the displacement subgroups of SE(3) without a screw.

use super::motion::Motion;
use crate::algebra;
use crate::diagnostic::Diagnostic;
use crate::domain::Domain;
use crate::expr::Expr;
use crate::manifold::{Factor, Kind};
use crate::matrix::{Matrix, combinations};
use crate::model::{Freedom, JointSpec};
use crate::spec::code;

/// What is known of the manifold's dimension.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Confinement {
    /// The known manifolds have it.
    Known,
    /// The declared or derived relations cut it out: the certificate in words.
    Relations(String),
    /// Q moves in an orbit of the basis; the relations that are checked cut out something of this dimension around it.
    Orbit(usize),
}

/// Adds to the manifold the linear relations of the cosets in which the basis moves.
pub fn confine(spec: &mut JointSpec) {
    if !spec.manifold.value.declared().is_empty() || spec.home.is_some() {
        return;
    }
    let factors = spec.manifold.value.factors().to_vec();
    let relations = factors.iter().enumerate().flat_map(|(n, factor)| {
        let generators = of_factor(spec, n)
            .map(|freedom| freedom.generator.clone())
            .collect();
        linear_relations(factor, generators)
    });
    let relations: Vec<Expr> = relations.collect();
    if !relations.is_empty() {
        spec.manifold.value = spec.manifold.value.clone().confined(relations);
    }
}

fn of_factor(spec: &JointSpec, n: usize) -> impl Iterator<Item = &Freedom> {
    spec.freedoms
        .value
        .iter()
        .filter(move |freedom| freedom.factor == n)
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
    crate::manifold::Ideal::new(&factor.relations()).vanishes(relation)
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
fn insert(echelon: &mut Vec<Vec<Expr>>, mut row: Vec<Expr>) -> bool {
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

/// A joint of k freedoms has a k-dimensional configuration manifold: refuses factors of which the dimension is known to be another.
pub fn check(spec: &JointSpec, exponential: bool) -> Result<(), Vec<Diagnostic>> {
    let manifold = &spec.manifold.value;
    let freedoms = &spec.freedoms;
    if !exponential {
        let (k, dimension) = (freedoms.value.len(), manifold.dimension());
        let fits = match manifold.declared().is_empty() {
            true => k == dimension,
            false => k < dimension,
        };
        return match fits {
            true => Ok(()),
            false => Err(vec![wrong_dimension(
                spec,
                "the configuration",
                dimension,
                k,
            )]),
        };
    }
    let wrong = |(n, factor): (usize, &Factor)| {
        let moved = of_factor(spec, n).count();
        let dimension = factor.kind.dimension();
        let subgroup = moved > 0 && moved < dimension && !matches!(factor.kind, Kind::S2);
        (moved != dimension && !subgroup)
            .then(|| wrong_dimension(spec, &factor.name, dimension, moved))
    };
    let errors: Vec<Diagnostic> = manifold
        .factors()
        .iter()
        .enumerate()
        .filter_map(wrong)
        .collect();
    match errors.is_empty() {
        true => Ok(()),
        false => Err(errors),
    }
}

fn wrong_dimension(spec: &JointSpec, what: &str, dimension: usize, moved: usize) -> Diagnostic {
    Diagnostic::new(
        code::DIMENSION,
        spec.freedoms.span.clone(),
        format!("{what} has dimension {dimension}, but {moved} local coordinates move it"),
    )
    .label("these local coordinates")
    .help("declare as many local coordinates as the manifold has dimensions; `relation … = …;` lowers the dimension")
}

/// What is known of the dimension; `Err` where the relations may cut out something else than a manifold of k dimensions, with the function whose
/// zeros are where.
pub fn confinement(
    spec: &JointSpec,
    domain: &Domain<'_>,
    exponential: bool,
) -> Result<Confinement, Expr> {
    let manifold = &spec.manifold.value;
    let count = spec.freedoms.value.len();
    let codimension = manifold.dimension() - count.min(manifold.dimension());
    if codimension == 0 {
        return Ok(Confinement::Known);
    }
    let slopes = relation_slopes(spec);
    // The k independent directions of Φ annihilate the relations, so that their rank is at most the codimension.
    let transposed = slopes.transpose();
    let small = combinations(transposed.columns(), codimension);
    let mut last = Expr::zero();
    for columns in small {
        let chosen = Matrix::from_columns(
            transposed.rows(),
            &columns
                .iter()
                .map(|&j| transposed.column(j))
                .collect::<Vec<_>>(),
        );
        match super::rank::full_column_rank(&chosen, domain) {
            Ok(certificate) => return Ok(Confinement::Relations(certificate)),
            Err(gram) if last.is_zero() => last = gram,
            Err(_) => {}
        }
    }
    // Declared relations that do not describe the orbit would be projected onto as if they did.
    match exponential && (manifold.is_coset() || manifold.declared().is_empty()) {
        true => Ok(Confinement::Orbit(cut_out(spec))),
        false => Err(last),
    }
}

/// Dimension of what the relations that are checked cut out: k, or more where they are those of a coset around the orbit in which Q moves.
///
/// The relations of a coset are all linear functions that vanish on an algebra of matrices. At any invertible member Q, a
/// direction `Q b` meets them exactly where b is in that algebra: their derivatives have the same rank everywhere, that at the identity.
pub fn cut_out(spec: &JointSpec) -> usize {
    let manifold = &spec.manifold.value;
    if !manifold.is_coset() && !manifold.declared().is_empty() {
        return spec.freedoms.value.len();
    }
    let home = manifold
        .coordinates()
        .into_iter()
        .zip(manifold.home())
        .collect();
    let slopes = relation_slopes(spec);
    let mut independent = vec![];
    for i in 0..slopes.rows() {
        let row = (0..slopes.columns()).map(|j| slopes.at(i, j).substitute(&home));
        insert(&mut independent, row.collect());
    }
    manifold.dimension() - independent.len()
}

/// Derivatives of the declared relations along the directions of the known manifolds: a row for each relation.
fn relation_slopes(spec: &JointSpec) -> Matrix {
    let manifold = &spec.manifold.value;
    let motion = Motion::of_known_manifold(manifold);
    let declared = manifold.declared();
    Matrix::from_fn(declared.len(), motion.freedoms(), |i, j| {
        manifold.ideal().normal_form(&motion.along(&declared[i], j))
    })
}
