//! S to first order in ϕ as the paper writes it, (32): `Q (I + ½ ϕ~)`.

use super::notation::Notation;
use super::typeset::{Mark, Math, named};
use crate::algebra;
use crate::derived::Derived;
use crate::expr::{Expr, Rational};
use crate::matrix::Matrix;
use crate::model::Freedom;
use num_traits::{One, Zero};

/// A product of factors known by name, and those of them that have to be shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Series {
    /// The product: `Q (I + ½ ϕ~)`.
    pub product: Math,
    /// Names in it, with the matrices that they stand for.
    pub parts: Vec<(Math, Matrix)>,
}

/// The series of a joint.
pub fn series(derived: &Derived, notation: &Notation) -> Series {
    let (left, right) = &derived.velocity_map_series;
    let mut parts = vec![];
    let mut factors = vec![];
    if !left.is_identity() {
        factors.push(known_matrix(derived, left).unwrap_or_else(|| {
            let name = Math::Letter('S').with_index(Math::integer(0));
            parts.push((name.clone(), left.clone()));
            name
        }));
    }
    if !right.is_identity() {
        let linear = linear_factor(derived, notation, right, &mut parts);
        let alone = factors.is_empty();
        factors.push(if alone { linear } else { linear.grouped() });
    }
    let product = match factors.is_empty() {
        true => Math::Letter('I'),
        false => Math::product(factors),
    };
    Series { product, parts }
}

/// The name of a matrix of coordinates: a factor itself, or its transpose.
fn known_matrix(derived: &Derived, matrix: &Matrix) -> Option<Math> {
    let mut factors = derived.space.manifold.factors().iter();
    factors.find_map(|factor| {
        let (itself, name) = (factor.matrix(), named(&factor.name));
        match (*matrix == itself, *matrix == itself.transpose()) {
            (true, _) => Some(name),
            (_, true) => Some(name.transposed()),
            _ => None,
        }
    })
}

/// `I + ½ ϕ~`, `I − ½ ad_ϕ`, or `I + L` with L shown.
fn linear_factor(
    derived: &Derived,
    notation: &Notation,
    right: &Matrix,
    parts: &mut Vec<(Math, Matrix)>,
) -> Math {
    let linear = right.minus(&Matrix::identity(right.rows()));
    let local: Vec<Expr> = derived.arguments.local.iter().map(Expr::symbol).collect();
    let tilde = (local.len() == 3).then(|| Matrix::tilde(&local));
    if let Some(ratio) = tilde.and_then(|tilde| multiple_of(&linear, &tilde)) {
        return identity_plus(&ratio, notation, Math::Letter('ϕ').marked(Mark::Tilde));
    }
    let ad = adjoint(derived, &local);
    if let Some((ratio, ad)) = ad.and_then(|ad| Some((multiple_of(&linear, &ad)?, ad))) {
        let name = Math::Word("ad".into()).with_index(Math::Letter('ϕ'));
        parts.push((name.clone(), ad));
        return identity_plus(&ratio, notation, name);
    }
    let name = Math::Row(vec![Math::Letter('L'), Math::Letter('ϕ').grouped()]);
    parts.push((name.clone(), linear));
    Math::Row(vec![Math::Letter('I'), Math::Sign('+'), name])
}

/// `I + ratio · matrix`.
fn identity_plus(ratio: &Rational, notation: &Notation, matrix: Math) -> Math {
    let sign = if ratio.is_negative() { '−' } else { '+' };
    let size = ratio.abs();
    let term = match size.is_one() {
        true => matrix,
        false => Math::product([notation.set(&Expr::rational(size)), matrix]),
    };
    Math::Row(vec![Math::Letter('I'), Math::Sign(sign), term])
}

/// The rational r with `a = r b`.
fn multiple_of(a: &Matrix, b: &Matrix) -> Option<Rational> {
    let (x, y) = a
        .entries()
        .iter()
        .zip(b.entries())
        .find(|(_, y)| !y.is_zero())?;
    let (monomial, divisor) = y.leading()?;
    let (_, dividend) = x.terms().find(|(candidate, _)| *candidate == monomial)?;
    let ratio = dividend / divisor;
    let rest = a.minus(&b.scale(&Expr::rational(ratio.clone())));
    (rest.is_zero() && !ratio.is_zero()).then_some(ratio)
}

/// `ad_ϕ` in the declared basis, where one factor alone moves; degrees of freedom that only Φ gives a meaning have none.
fn adjoint(derived: &Derived, local: &[Expr]) -> Option<Matrix> {
    let freedoms = &derived.spec.freedoms.value;
    let factor = freedoms.first()?.factor;
    let other = |freedom: &Freedom| freedom.factor != factor || freedom.generator.is_empty();
    if freedoms.iter().any(other) {
        return None;
    }
    let kind = derived.space.manifold.factors().get(factor)?.kind;
    let generators: Vec<Vec<Expr>> = freedoms
        .iter()
        .map(|freedom| freedom.generator.clone())
        .collect();
    let basis = Matrix::from_columns(generators.first()?.len(), &generators);
    let element = basis.times(&Matrix::column_vector(local.to_vec()));
    let element = algebra::hat(kind, element.entries());
    let bracket = |generator: &Vec<Expr>| {
        let bracket = algebra::commutator(&element, &algebra::hat(kind, generator));
        algebra::coordinates_in(&basis, &algebra::vee(kind, &bracket)).ok()
    };
    let columns: Vec<Vec<Expr>> = generators.iter().map(bracket).collect::<Option<_>>()?;
    Some(Matrix::from_columns(local.len(), &columns))
}
