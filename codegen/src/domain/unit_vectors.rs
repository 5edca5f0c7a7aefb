//! Vectors of length 1 among the scalars of a configuration, and the sines and cosines of one angle.

use crate::expr::{Application, Atom, Expr, Function, Monomial, Symbol};
use crate::manifold::{Factor, Kind};
use std::collections::BTreeSet;

/// The scalars (c, s) of unit complex numbers.
pub fn circles(factors: &[Factor]) -> Vec<(Symbol, Symbol)> {
    let circles = factors.iter().filter(|factor| factor.kind == Kind::S1);
    circles
        .filter_map(|factor| match factor.coordinates.as_slice() {
            [c, s] => Some((c.clone(), s.clone())),
            _ => None,
        })
        .collect()
}

/// The vectors of length 1 of each factor: itself, or the rows and columns of a rotation.
pub fn of_factors(factors: &[Factor]) -> Vec<Vec<Atom>> {
    factors.iter().flat_map(of_factor).collect()
}

fn of_factor(factor: &Factor) -> Vec<Vec<Atom>> {
    let entries: Vec<Atom> = factor
        .coordinates
        .iter()
        .cloned()
        .map(Atom::Symbol)
        .collect();
    let rotation = |size: usize, width: usize| -> Vec<Vec<Atom>> {
        let row = |i: usize| (0..size).map(|j| entries[width * i + j].clone()).collect();
        let column = |j: usize| (0..size).map(|i| entries[width * i + j].clone()).collect();
        (0..size).map(row).chain((0..size).map(column)).collect()
    };
    match factor.kind {
        Kind::Real(_) => vec![],
        Kind::S1 | Kind::S2 | Kind::S3 => vec![entries],
        Kind::So2 => rotation(2, 2),
        Kind::Se2 => rotation(2, 3),
        Kind::So3 => rotation(3, 3),
        Kind::Se3 => rotation(3, 4),
    }
}

/// Cosine and sine of each angle that occurs.
pub fn of_angles(expression: &Expr) -> Vec<Vec<Atom>> {
    let angle = |atom: &Atom| match atom {
        Atom::Apply(application) => angle_of(application),
        Atom::Symbol(_) => None,
    };
    let angles: BTreeSet<Expr> = expression.atoms().iter().filter_map(angle).collect();
    let pair = |angle: &Expr| {
        let atoms = [angle.cos(), angle.sin()];
        let atoms = atoms.iter().flat_map(Expr::atoms).collect::<Vec<_>>();
        (atoms.len() == 2).then_some(atoms)
    };
    angles.iter().filter_map(pair).collect()
}

fn angle_of(application: &Application) -> Option<Expr> {
    let trigonometric = matches!(application.function, Function::Cos | Function::Sin);
    application
        .arguments
        .first()
        .filter(|_| trigonometric)
        .cloned()
}

/// An expression as `rest + Σ factor_i · vector_i`, where it is linear in the vector and holds some of it.
pub fn split(expression: &Expr, vector: &[Atom]) -> Option<(Expr, Vec<Expr>)> {
    let mut rest = Expr::zero();
    let mut factors = vec![Expr::zero(); vector.len()];
    for (monomial, coefficient) in expression.terms() {
        let powers: Vec<i32> = vector.iter().map(|atom| monomial.power(atom)).collect();
        match powers.iter().sum::<i32>() {
            0 => rest += &Expr::term(coefficient.clone(), monomial.clone()),
            1 => {
                let place = powers.iter().position(|power| *power == 1)?;
                let single = Monomial::atom(vector[place].clone());
                let factor = Expr::term(coefficient.clone(), monomial.divided_by(&single)?);
                factors[place] += &factor;
            }
            _ => return None,
        }
    }
    let free = |e: &Expr| {
        !e.symbols()
            .iter()
            .any(|s| vector.contains(&Atom::Symbol(s.clone())))
    };
    let held = factors.iter().any(|factor| !factor.is_zero());
    (held && free(&rest) && factors.iter().all(free)).then_some((rest, factors))
}
