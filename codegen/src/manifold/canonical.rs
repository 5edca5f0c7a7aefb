//! Laws between functions that no polynomial relation of one of them knows: `e^a e^b = e^{a+b}`, `√a √b = √(a b)`,
//! `ln a + ln b = ln(a b)`, and that functions of equal arguments are equal. They hold wherever both sides are defined.
//!
//! They serve to decide whether an expression vanishes. Kernels are not written by them: `e^{a+b}` is not always better than a product.

use super::Ideal;
use crate::expr::{Application, Atom, Expr, Function, Monomial, Rational};
use std::collections::{BTreeMap, BTreeSet};

/// Powers of the argument of one logarithm that are looked for in that of another.
const POWERS: [i32; 5] = [-1, 2, -2, 3, 4];

/// The expression with functions replaced by these laws, and relations that hold between the roots that are left.
pub fn rewritten(expression: &Expr, ideal: &Ideal) -> (Expr, Vec<Expr>) {
    let alike = with_equal_arguments(expression, ideal);
    let logarithms = by_fewer_logarithms(&alike, ideal);
    let merged = merged_exponentials(&logarithms, ideal);
    // What was merged may be alike only now.
    let merged = with_equal_arguments(&merged, ideal);
    let relations = relations_of_roots(&merged, ideal);
    (merged, relations)
}

/// Hyperbolic functions by exponentials, of which the laws are known.
pub fn by_exponentials(expression: &Expr) -> Expr {
    let value = |atom: Atom| {
        let application = is_function(&atom)?;
        let x = application.arguments.first()?;
        let (up, down) = (x.exp(), (-x).exp());
        let half = Expr::fraction(1, 2);
        let cosh = || &half * &(&up + &down);
        let sinh = || &half * &(&up - &down);
        let value = match application.function {
            Function::Cosh => cosh(),
            Function::Sinh => sinh(),
            Function::Tanh => &sinh() * &quotient(&cosh())?,
            Function::Sech => quotient(&cosh())?,
            Function::LnCosh => cosh().ln(),
            _ => return None,
        };
        Some((atom, value))
    };
    let values = expression.atoms().into_iter().filter_map(value);
    expression.replace_atoms(&values.collect())
}

fn quotient(e: &Expr) -> Option<Expr> {
    e.recip().filter(|_| !e.is_zero())
}

/// The functions of one kind in the expression itself, with their argument.
fn functions(expression: &Expr, function: Function) -> Vec<(Atom, Expr)> {
    let of_kind = |atom: Atom| match &atom {
        Atom::Apply(application) if application.function == function => {
            let argument = application.arguments.first()?.clone();
            Some((atom, argument))
        }
        _ => None,
    };
    expression.atoms().into_iter().filter_map(of_kind).collect()
}

fn is_function(atom: &Atom) -> Option<&Application> {
    match atom {
        Atom::Apply(application) => Some(application),
        Atom::Symbol(_) => None,
    }
}

/// One atom for functions whose arguments are equal on the manifold.
fn with_equal_arguments(expression: &Expr, ideal: &Ideal) -> Expr {
    let mut kept: Vec<Atom> = vec![];
    let mut replaced = BTreeMap::new();
    for atom in expression.atoms() {
        let Some(application) = is_function(&atom) else {
            continue;
        };
        let equal = kept.iter().find(|other| {
            is_function(other).is_some_and(|other| has_equal_arguments(application, other, ideal))
        });
        match equal {
            Some(other) => {
                replaced.insert(atom, Expr::atom(other.clone()));
            }
            None => kept.push(atom),
        }
    }
    expression.replace_atoms(&replaced)
}

fn has_equal_arguments(a: &Application, b: &Application, ideal: &Ideal) -> bool {
    let mut pairs = a.arguments.iter().zip(&b.arguments);
    a.function == b.function
        && a.arguments.len() == b.arguments.len()
        && pairs.all(|(x, y)| ideal.vanishes(&(x - y)))
}

/// `ln u = n ln v` where u = vⁿ, and `ln u = ln v + ln w` where u = v w.
fn by_fewer_logarithms(expression: &Expr, ideal: &Ideal) -> Expr {
    let logarithms = functions(expression, Function::Ln);
    let mut replaced: BTreeMap<Atom, Expr> = BTreeMap::new();
    for (place, (atom, u)) in logarithms.iter().enumerate() {
        let others: Vec<&(Atom, Expr)> = logarithms
            .iter()
            .enumerate()
            .filter(|(n, (other, _))| *n != place && !replaced.contains_key(other))
            .map(|(_, pair)| pair)
            .collect();
        let as_power = others.iter().find_map(|(other, v)| {
            let power = POWERS.into_iter().find(|n| is_power(u, v, *n, ideal))?;
            Some(Expr::term(
                Rational::from(i64::from(power)),
                Monomial::atom(other.clone()),
            ))
        });
        let as_product = || {
            let pairs = others
                .iter()
                .flat_map(|a| others.iter().map(move |b| (a, b)));
            let mut products = pairs.filter(|((_, v), (_, w))| ideal.vanishes(&(u - &(v * w))));
            let ((first, _), (second, _)) = products.next()?;
            Some(&Expr::atom(first.clone()) + &Expr::atom(second.clone()))
        };
        if let Some(value) = as_power.or_else(as_product) {
            replaced.insert(atom.clone(), value);
        }
    }
    expression.replace_atoms(&replaced)
}

/// Whether `u = vⁿ`.
fn is_power(u: &Expr, v: &Expr, n: i32, ideal: &Ideal) -> bool {
    let power = v.pow(n.unsigned_abs());
    match n < 0 {
        true => ideal.vanishes(&(&(u * &power) - &Expr::one())),
        false => ideal.vanishes(&(u - &power)),
    }
}

/// One exponential in each term, of the sum of all exponents in it; what is a whole multiple of a logarithm there leaves it.
fn merged_exponentials(expression: &Expr, ideal: &Ideal) -> Expr {
    let exponentials: BTreeMap<Atom, Expr> =
        functions(expression, Function::Exp).into_iter().collect();
    if exponentials.is_empty() {
        return expression.clone();
    }
    let merged = |(monomial, coefficient): (&Monomial, &Rational)| {
        let mut exponent = Expr::zero();
        let mut rest = monomial.clone();
        for (atom, argument) in &exponentials {
            let power = monomial.power(atom);
            exponent += &argument.scaled(&Rational::from(i64::from(power)), &Monomial::one());
            let single = Monomial::atom(atom.clone());
            for _ in 0..power {
                rest = rest.divided_by(&single).unwrap_or_default();
            }
        }
        &Expr::term(coefficient.clone(), rest) * &exponential(&ideal.normal_form(&exponent))
    };
    expression.terms().map(merged).sum()
}

/// `exp(a + n ln u) = uⁿ exp(a)`.
fn exponential(exponent: &Expr) -> Expr {
    let mut factor = Expr::one();
    let mut rest = Expr::zero();
    for (monomial, coefficient) in exponent.terms() {
        let logarithm = match (monomial.main(), monomial.units()) {
            ([(Atom::Apply(application), 1)], []) if application.function == Function::Ln => {
                application.arguments.first().cloned()
            }
            _ => None,
        };
        let power = num_traits::ToPrimitive::to_i32(&coefficient.to_integer());
        match (logarithm, power.filter(|_| coefficient.is_integer())) {
            (Some(u), Some(power)) => {
                let base = if power < 0 {
                    u.recip().unwrap_or_default()
                } else {
                    u
                };
                factor = &factor * &base.pow(power.unsigned_abs());
            }
            _ => rest += &Expr::term(coefficient.clone(), monomial.clone()),
        }
    }
    &factor * &rest.exp()
}

/// `√u √v = √w` where u v = w, and `√u = r √v` where u = r² v. Roots are defined where they stand, so that no argument is negative.
fn relations_of_roots(expression: &Expr, ideal: &Ideal) -> Vec<Expr> {
    let roots: BTreeSet<(Atom, Expr)> = functions(expression, Function::Sqrt).into_iter().collect();
    let roots: Vec<_> = roots.into_iter().collect();
    let mut relations = vec![];
    for (place, (u_root, u)) in roots.iter().enumerate() {
        for (v_root, v) in &roots[..place] {
            let (a, b) = (Expr::atom(u_root.clone()), Expr::atom(v_root.clone()));
            if let Some(ratio) = rational_ratio(u, v, ideal) {
                relations.push(&a - &(&ratio * &b));
                continue;
            }
            let product = u * v;
            if let Some(root) = ideal.known_root(&product) {
                relations.push(&(&a * &b) - &root);
            }
            let of_product = roots.iter().find(|(_, w)| ideal.vanishes(&(&product - w)));
            if let Some((root, _)) = of_product {
                relations.push(&(&a * &b) - &Expr::atom(root.clone()));
            }
        }
    }
    relations
}

/// r where `u = r² v`.
fn rational_ratio(u: &Expr, v: &Expr, ideal: &Ideal) -> Option<Expr> {
    let (of_u, of_v) = (u.leading()?.1, v.leading()?.1);
    let ratio = of_u / of_v;
    let root = ratio.square_root()?;
    let ratio = Expr::rational(ratio);
    ideal
        .vanishes(&(u - &(&ratio * v)))
        .then(|| Expr::rational(root))
}

#[cfg(test)]
mod tests;
