//! Sines and cosines of several multiples of one angle, written by those of their common part, so that they can be compared.

use crate::expr::{Application, Atom, Expr, Function, Monomial, Rational};
use num_traits::{ToPrimitive, Zero};
use std::collections::{BTreeMap, BTreeSet};

/// Largest multiple that is expanded: cos 16x has 17 terms.
const LARGEST_MULTIPLE: u32 = 16;

/// The expression with one base angle where it holds several multiples of it: cos q beside cos q/2 becomes cos² q/2 − sin² q/2.
pub fn unified(expression: &Expr) -> Expr {
    match by_base_angles(expression.atoms()) {
        Some(replaced) => expression.replace_atoms(&replaced),
        None => expression.clone(),
    }
}

/// The expressions with one base angle where they hold several multiples of it together.
pub fn unified_all(expressions: &[Expr]) -> Vec<Expr> {
    match by_base_angles(expressions.iter().flat_map(Expr::atoms).collect()) {
        Some(replaced) => {
            let unified = expressions.iter().map(|e| e.replace_atoms(&replaced));
            unified.collect()
        }
        None => expressions.to_vec(),
    }
}

/// The sines and cosines of which several are of multiples of one angle, by those of its common part; `None` where there are none.
fn by_base_angles(atoms: BTreeSet<Atom>) -> Option<BTreeMap<Atom, Expr>> {
    let mut angles: BTreeMap<Monomial, BTreeSet<Rational>> = BTreeMap::new();
    for (monomial, coefficient) in atoms.iter().filter_map(angle) {
        angles.entry(monomial).or_default().insert(coefficient);
    }
    angles.retain(|_, coefficients| coefficients.len() > 1);
    let replaced = atoms.into_iter().filter_map(|atom| {
        let value = by_common_part(&atom, &angles)?;
        Some((atom, value))
    });
    (!angles.is_empty()).then(|| replaced.collect())
}

/// Monomial and coefficient of the argument of a sine or cosine of one term.
fn angle(atom: &Atom) -> Option<(Monomial, Rational)> {
    let (monomial, coefficient) = trigonometric(atom)?.arguments.first()?.single_term()?;
    Some((monomial.clone(), coefficient.clone()))
}

fn trigonometric(atom: &Atom) -> Option<&Application> {
    match atom {
        Atom::Apply(application) => {
            matches!(application.function, Function::Cos | Function::Sin).then_some(&**application)
        }
        Atom::Symbol(_) => None,
    }
}

fn by_common_part(atom: &Atom, angles: &BTreeMap<Monomial, BTreeSet<Rational>>) -> Option<Expr> {
    let (monomial, coefficient) = angle(atom)?;
    let parts = angles.get(&monomial)?.iter();
    let part = parts.fold(Rational::zero(), |common, c| common.common_part(c));
    let multiple = (&coefficient / &part).to_integer().to_u32()?;
    if multiple > LARGEST_MULTIPLE {
        return None;
    }
    let base = Expr::term(part, monomial);
    let (cos, sin) = (base.cos(), base.sin());
    let (mut c, mut s) = (Expr::one(), Expr::zero());
    for _ in 0..multiple {
        (c, s) = (&(&c * &cos) - &(&s * &sin), &(&s * &cos) + &(&c * &sin));
    }
    match trigonometric(atom)?.function {
        Function::Cos => Some(c),
        _ => Some(s),
    }
}
