//! S to first order in ϕ as the paper writes it, (32): `Q (I + ½ ϕ~)`.

use super::notation::Notation;
use crate::algebra;
use crate::derived::Derived;
use crate::expr::{Expr, Rational};
use crate::matrix::Matrix;
use num_traits::{One, Zero};

/// A product of factors known by name, and those of them that have to be shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Series {
    /// The product: `Q (I + ½ ϕ~)`.
    pub product: String,
    /// Names in it, with the matrices that they stand for.
    pub parts: Vec<(String, Matrix)>,
}

/// The series of a joint.
pub fn series(derived: &Derived, notation: &Notation) -> Series {
    let (left, right) = &derived.velocity_map_series;
    let mut parts = vec![];
    let left_name = if left.is_identity() {
        None
    } else {
        Some(known_matrix(derived, left))
    };
    let left_text = left_name.map(|name| {
        name.unwrap_or_else(|| {
            parts.push(("S₀".to_owned(), left.clone()));
            "S₀".to_owned()
        })
    });
    let right_text = if right.is_identity() {
        None
    } else {
        Some(linear_factor(derived, notation, right, &mut parts))
    };
    let product = match (left_text, right_text) {
        (None, None) => "I".to_owned(),
        (Some(left), None) => left,
        (None, Some(right)) => right,
        (Some(left), Some(right)) => format!("{left} ({right})"),
    };
    Series { product, parts }
}

/// The name of a matrix of coordinates: a factor itself, or its transpose.
fn known_matrix(derived: &Derived, matrix: &Matrix) -> Option<String> {
    derived
        .spec
        .manifold
        .value
        .factors()
        .iter()
        .find_map(|factor| {
            let itself = factor.matrix();
            let name = &factor.name;
            match (*matrix == itself, *matrix == itself.transpose()) {
                (true, _) => Some(name.clone()),
                (_, true) => Some(format!("{name}ᵀ")),
                _ => None,
            }
        })
}

/// `I + ½ ϕ~`, `I − ½ ad_ϕ`, or `I + L` with L shown.
fn linear_factor(
    derived: &Derived,
    notation: &Notation,
    right: &Matrix,
    parts: &mut Vec<(String, Matrix)>,
) -> String {
    let linear = right.minus(&Matrix::identity(right.rows()));
    let local: Vec<Expr> = derived.arguments.local.iter().map(Expr::symbol).collect();
    if let Some(ratio) = (local.len() == 3)
        .then(|| multiple_of(&linear, &Matrix::tilde(&local)))
        .flatten()
    {
        return format!("I {} ϕ~", signed(&ratio, notation));
    }
    let ad = adjoint(derived, &local);
    if let Some((ratio, ad)) = ad.and_then(|ad| Some((multiple_of(&linear, &ad)?, ad))) {
        parts.push(("ad_ϕ".to_owned(), ad));
        return format!("I {} ad_ϕ", signed(&ratio, notation));
    }
    parts.push(("L(ϕ)".to_owned(), linear));
    "I + L(ϕ)".to_owned()
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

fn signed(ratio: &Rational, notation: &Notation) -> String {
    let size = if ratio < &Rational::zero() {
        -ratio
    } else {
        ratio.clone()
    };
    let sign = if ratio < &Rational::zero() {
        "−"
    } else {
        "+"
    };
    match size.is_one() {
        true => sign.to_owned(),
        false => format!("{sign} {}", notation.expression(&Expr::rational(size))),
    }
}

/// `ad_ϕ` in the declared basis, where one factor alone moves.
fn adjoint(derived: &Derived, local: &[Expr]) -> Option<Matrix> {
    let freedoms = &derived.spec.freedoms.value;
    let factor = freedoms.first()?.factor;
    if freedoms.iter().any(|freedom| freedom.factor != factor) {
        return None;
    }
    let kind = derived.spec.manifold.value.factors().get(factor)?.kind;
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
