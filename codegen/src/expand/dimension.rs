//! The dimension of the configuration manifold against the number of degrees of freedom.

use super::motion::Motion;
use crate::diagnostic::Diagnostic;
use crate::domain::Domain;
use crate::expr::Expr;
use crate::manifold::{Factor, Kind};
use crate::matrix::{Matrix, combinations};
use crate::prepare::{Prepared, insert};
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

/// A joint of k degrees of freedom has a k-dimensional configuration manifold: refuses factors of which the dimension is known to be another.
pub fn check(joint: &Prepared, exponential: bool) -> Result<(), Vec<Diagnostic>> {
    let manifold = &joint.space.manifold;
    let freedoms = &joint.spec.freedoms;
    if !exponential {
        let (k, dimension) = (freedoms.value.len(), manifold.dimension());
        let fits = match manifold.declared().is_empty() {
            true => k == dimension,
            false => k < dimension,
        };
        return match fits {
            true => Ok(()),
            false => Err(vec![wrong_dimension(
                joint,
                "the configuration",
                dimension,
                k,
            )]),
        };
    }
    let wrong = |(n, factor): (usize, &Factor)| {
        let moved = joint.spec.freedoms_of(n).count();
        let dimension = factor.kind.dimension();
        let subgroup = moved > 0 && moved < dimension && !matches!(factor.kind, Kind::S2);
        (moved != dimension && !subgroup)
            .then(|| wrong_dimension(joint, &factor.name, dimension, moved))
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

fn wrong_dimension(joint: &Prepared, what: &str, dimension: usize, moved: usize) -> Diagnostic {
    Diagnostic::new(
        code::DIMENSION,
        joint.spec.freedoms.span.clone(),
        format!("{what} has dimension {dimension}, but {moved} local coordinates move it"),
    )
    .label("these local coordinates")
    .help("declare as many local coordinates as the manifold has dimensions; `relation … = …;` lowers the dimension")
}

/// What is known of the dimension; `Err` where the relations may cut out something else than a manifold of k dimensions, with the function whose
/// zeros are where.
pub fn confinement(
    joint: &Prepared,
    domain: &Domain<'_>,
    exponential: bool,
) -> Result<Confinement, Expr> {
    let manifold = &joint.space.manifold;
    let count = joint.spec.freedoms.value.len();
    let codimension = manifold.dimension() - count.min(manifold.dimension());
    if codimension == 0 {
        return Ok(Confinement::Known);
    }
    let slopes = relation_slopes(joint);
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
        true => Ok(Confinement::Orbit(cut_out(joint))),
        false => Err(last),
    }
}

/// Dimension of what the relations that are checked cut out: k, or more where they are those of a coset around the orbit in which Q moves.
///
/// The relations of a coset are all linear functions that vanish on an algebra of matrices. At any invertible member Q, a
/// direction `Q b` meets them exactly where b is in that algebra: their derivatives have the same rank everywhere, that at the identity.
pub fn cut_out(joint: &Prepared) -> usize {
    let manifold = &joint.space.manifold;
    if !manifold.is_coset() && !manifold.declared().is_empty() {
        return joint.spec.freedoms.value.len();
    }
    let home = manifold
        .coordinates()
        .into_iter()
        .zip(manifold.home())
        .collect();
    let slopes = relation_slopes(joint);
    let mut independent = vec![];
    for i in 0..slopes.rows() {
        let row = (0..slopes.columns()).map(|j| slopes.at(i, j).substitute(&home));
        insert(&mut independent, row.collect());
    }
    manifold.dimension() - independent.len()
}

/// Derivatives of the declared relations along the directions of the known manifolds: a row for each relation.
pub(super) fn relation_slopes(joint: &Prepared) -> Matrix {
    let manifold = &joint.space.manifold;
    let motion = Motion::of_known_manifold(manifold);
    let declared = manifold.declared();
    Matrix::from_fn(declared.len(), motion.freedoms(), |i, j| {
        manifold.ideal().normal_form(&motion.along(&declared[i], j))
    })
}
