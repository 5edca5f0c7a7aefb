//! N_X: the spatial inertias that a joint cannot feel.
//!
//! `N = [I mc~; −mc~ m1]` in the child frame with `N X^c = 0`, and constant when read in the parent frame:
//! `ad_Tᵀ N + N ad_T = 0` for each twist T of the joint. Linear in the ten parameters; solved over the rationals.

use super::velocity::bracket;
use crate::expr::{Expr, Monomial, Rational, Role, Symbol};
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use num_traits::{One, Zero};
use std::collections::BTreeMap;

const NAMES: [&str; 10] = [
    "m", "mcx", "mcy", "mcz", "ixx", "iyy", "izz", "ixy", "ixz", "iyz",
];

/// A basis of N_X; each element `[m, mc_x, mc_y, mc_z, Ixx, Iyy, Izz, Ixy, Ixz, Iyz]`.
///
/// `child` is X^c, `twists` the twists by ϕ̇ in the child frame. What holds only at special parameter values does not count.
pub fn imperceptible(child: &Matrix, twists: &Matrix, ideal: &Ideal) -> Vec<[Rational; 10]> {
    let symbols: Vec<Symbol> = NAMES
        .iter()
        .enumerate()
        .map(|(i, name)| Symbol::new(Role::Inertia, i, name))
        .collect();
    let inertia = spatial_inertia(&symbols);
    let mut conditions = inertia.times(child).entries().to_vec();
    for k in 0..twists.columns() {
        let ad = bracket(&twists.column(k));
        conditions.extend_from_slice(
            ad.transpose()
                .times(&inertia)
                .plus(&inertia.times(&ad))
                .entries(),
        );
    }
    let rows = conditions
        .iter()
        .flat_map(|condition| linear_conditions(&ideal.normal_form(condition)));
    null_space(rows.collect())
}

fn spatial_inertia(symbols: &[Symbol]) -> Matrix {
    let n: Vec<Expr> = symbols.iter().map(Expr::symbol).collect();
    let moment = Matrix::tilde(&n[1..4]);
    let entry = |i: usize, j: usize| n[[[4, 7, 8], [7, 5, 9], [8, 9, 6]][i][j]].clone();
    let inertia = Matrix::from_fn(3, 3, entry);
    let mass = Matrix::identity(3).scale(&n[0]);
    inertia
        .beside(&moment)
        .stack(&moment.map(|e| -e).beside(&mass))
}

/// The coefficient of each monomial in Q is a linear form in the ten parameters, and must vanish.
fn linear_conditions(condition: &Expr) -> Vec<[Rational; 10]> {
    let mut rows: BTreeMap<Monomial, [Rational; 10]> = BTreeMap::new();
    for (monomial, coefficient) in condition.terms() {
        let parameter = monomial.main().iter().find_map(|(atom, _)| match atom {
            crate::expr::Atom::Symbol(symbol) if symbol.role == Role::Inertia => {
                Some((atom.clone(), symbol.index))
            }
            _ => None,
        });
        if let Some((atom, index)) = parameter
            && let Some(rest) = monomial.divided_by(&Monomial::atom(atom))
        {
            let row = rows
                .entry(rest)
                .or_insert_with(|| std::array::from_fn(|_| Rational::zero()));
            row[usize::from(index)] += coefficient;
        }
    }
    rows.into_values().collect()
}

/// The null space, by Gauss–Jordan elimination.
fn null_space(mut rows: Vec<[Rational; 10]>) -> Vec<[Rational; 10]> {
    let mut pivots = vec![];
    for column in 0..10 {
        let from = pivots.len();
        let Some(found) = (from..rows.len()).find(|&row| !rows[row][column].is_zero()) else {
            continue;
        };
        rows.swap(from, found);
        let scale = rows[from][column].recip();
        rows[from].iter_mut().for_each(|entry| *entry *= &scale);
        let pivot = rows[from].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(n, _)| *n != from) {
            let factor = row[column].clone();
            if !factor.is_zero() {
                row.iter_mut()
                    .zip(&pivot)
                    .for_each(|(entry, p)| *entry -= &factor * p);
            }
        }
        pivots.push(column);
    }
    let free = (0..10).filter(|column| !pivots.contains(column));
    free.map(|column| {
        let mut solution: [Rational; 10] = std::array::from_fn(|_| Rational::zero());
        solution[column] = Rational::one();
        for (row, &pivot) in pivots.iter().enumerate() {
            solution[pivot] = -rows[row][column].clone();
        }
        solution
    })
    .collect()
}
