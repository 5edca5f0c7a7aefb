//! No common zero by elimination: one function or its square, or what the functions and the relations generate, is a polynomial in one
//! scalar, which has no zero between −1 and 1.

use super::roots;
use crate::expr::{Atom, Expr, Rational, Symbol};
use crate::manifold::Ideal;
use std::collections::BTreeSet;

/// Most of the degree of such a polynomial.
const DEGREE: usize = 8;

/// Whether the function, in normal form, or its square is a polynomial in one of the `scalars`, which lie between −1 and 1, that has no
/// zero there. `sign` tells whether an expression is positive, or negative, everywhere.
pub fn is_never_zero(
    ideal: &Ideal,
    function: &Expr,
    scalars: &BTreeSet<Symbol>,
    sign: impl Fn(&Expr) -> Option<bool>,
) -> bool {
    let square = || in_one_scalar(&ideal.normal_form(&function.square()), scalars);
    let found = in_one_scalar(function, scalars).or_else(square);
    found.is_some_and(|(coefficients, scalar)| has_no_zero(&coefficients, &scalar, sign))
}

/// Whether the functions and the relations generate such a polynomial.
pub fn exclude(
    ideal: &Ideal,
    functions: &[Expr],
    scalars: &BTreeSet<Symbol>,
    sign: impl Fn(&Expr) -> Option<bool>,
) -> bool {
    scalars.iter().any(|scalar| {
        let found = ideal.in_one_scalar(functions, scalar, DEGREE);
        found.is_some_and(|coefficients| has_no_zero(&coefficients, scalar, &sign))
    })
}

/// The coefficients, from that of degree 0 on, of a polynomial in one of the scalars; and that scalar.
fn in_one_scalar(expression: &Expr, scalars: &BTreeSet<Symbol>) -> Option<(Vec<Expr>, Symbol)> {
    let mut found: Option<Symbol> = None;
    let mut coefficients: Vec<Expr> = vec![];
    for (monomial, coefficient) in expression.terms() {
        let (main, units) = monomial.split();
        let degree = match main.main() {
            [] => 0,
            [(Atom::Symbol(symbol), degree)] if scalars.contains(symbol) => {
                if found.as_ref().is_some_and(|other| other != symbol) {
                    return None;
                }
                found = Some(symbol.clone());
                *degree as usize
            }
            _ => return None,
        };
        if coefficients.len() <= degree {
            coefficients.resize(degree + 1, Expr::zero());
        }
        coefficients[degree] += &Expr::term(coefficient.clone(), units);
    }
    Some((coefficients, found?))
}

/// Whether the expression, in normal form, is a polynomial in one of the `scalars`, which lie between −1 and 1, that is positive there, or negative;
/// `sign` as for [`is_never_zero`].
pub fn sign_of(
    expression: &Expr,
    scalars: &BTreeSet<Symbol>,
    sign: impl Fn(&Expr) -> Option<bool>,
) -> Option<bool> {
    let (coefficients, scalar) = in_one_scalar(expression, scalars)?;
    sign_between(&coefficients, &scalar, sign)
}

fn has_no_zero(
    coefficients: &[Expr],
    scalar: &Symbol,
    sign: impl Fn(&Expr) -> Option<bool>,
) -> bool {
    sign_between(coefficients, scalar, sign).is_some()
}

/// Whether the polynomial is positive, or negative, for all values of the scalar between −1 and 1; `None` where it may have a zero there.
fn sign_between(
    coefficients: &[Expr],
    scalar: &Symbol,
    sign: impl Fn(&Expr) -> Option<bool>,
) -> Option<bool> {
    let numbers: Option<Vec<Rational>> = coefficients.iter().map(Expr::as_rational).collect();
    if let Some(mut numbers) = numbers {
        while numbers.last().is_some_and(num_traits::Zero::is_zero) {
            numbers.pop();
        }
        let at_zero = numbers.first()?.is_positive();
        return roots::has_none_in_unit_interval(&numbers).then_some(at_zero);
    }
    if let Some((multiple, factors)) = linear_factors(coefficients) {
        let of_factor = |[b, a]: &[Expr; 2]| {
            // Least at one end and largest at the other.
            let (least, largest) = match sign(a)? {
                true => (b - a, b + a),
                false => (b + a, b - a),
            };
            match (sign(&least), sign(&largest)) {
                (Some(true), _) => Some(true),
                (_, Some(false)) => Some(false),
                _ => None,
            }
        };
        let mut signs = factors.iter().map(of_factor);
        return signs.try_fold(sign(&multiple)?, |product, own| Some(product == own?));
    }
    let x = Expr::symbol(scalar);
    let terms = coefficients.iter().enumerate();
    let whole: Expr = terms.map(|(n, c)| c * &x.pow(n as u32)).sum();
    match whole.polynomial_root() {
        Some(root) => sign(&root).map(|_| true),
        None => sign(&whole),
    }
}

/// The factors `B + A x`, each as (B, A), of a multiple of the polynomial, beside what it is multiplied by: itself, or those of `4 A (A x² + B x + C)`, which
/// are `2 A x + B ± √(B² − 4 A C)`, where the root is a polynomial.
fn linear_factors(coefficients: &[Expr]) -> Option<(Expr, Vec<[Expr; 2]>)> {
    match coefficients {
        [b, a] => Some((Expr::one(), vec![[b.clone(), a.clone()]])),
        [c, b, a] => {
            let discriminant = &b.square() - &(&(a * c) * &Expr::integer(4));
            let root = discriminant.polynomial_root()?;
            let slope = a * &Expr::integer(2);
            Some((
                a.clone(),
                vec![[b + &root, slope.clone()], [b - &root, slope]],
            ))
        }
        _ => None,
    }
}
