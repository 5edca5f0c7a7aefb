//! N_X: the spatial inertias that do not affect a joint.
//!
//! `N = [I mc~; −mc~ m1]` in the child frame with `N X^c = 0`, and constant when read in the parent frame:
//! `ad_Tᵀ N + N ad_T = 0` for each twist T of the joint. Linear in the ten parameters; solved over the rationals.

use super::Expansion;
use super::twist::bracket;
use crate::expr::{Expr, Monomial, Rational, Role, Symbol};
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use num_traits::{One, Zero};
use std::collections::BTreeMap;

/// A basis of N_X; each element `[m, mc_x, mc_y, mc_z, Ixx, Iyy, Izz, Ixy, Ixz, Iyz]`.
///
/// Of a joint with one body. What holds only at special parameter values does not count. Conditions
/// are met one after the other, so that the first ones, which are short, leave little for the others.
pub fn unidentifiable(expansion: &Expansion, ideal: &Ideal) -> Vec<[Rational; 10]> {
    // The second are twists by ϕ̇.
    let (child, twists) = (&expansion.twist_map_child, &expansion.jacobian.child);
    let whole: Vec<[Rational; 10]> = (0..10).map(unit).collect();
    let columns = (0..child.columns()).map(|j| Matrix::column_vector(child.column(j)));
    // Forces before moments: they hold mass and first moment alone.
    let mut left = columns.fold(whole, |left, column| {
        let of_rows = |rows: &'static [usize]| {
            let column = &column;
            move |n: &Matrix| n.select_rows(rows).times(column)
        };
        let left = restrict(left, ideal, of_rows(&[3, 4, 5]));
        restrict(left, ideal, of_rows(&[0, 1, 2]))
    });
    for k in 0..twists.columns() {
        let ad = bracket(&twists.column(k));
        left = restrict(left, ideal, |n| ad.transpose().times(n).plus(&n.times(&ad)));
    }
    // One more elimination gives the reduced form that does not depend on the order.
    null_space(annihilator(&left))
}

fn unit(n: usize) -> [Rational; 10] {
    std::array::from_fn(|i| Rational::from_integer(i64::from(i == n).into()))
}

/// The combinations of the given inertias for which the condition, linear in N, vanishes.
fn restrict(
    left: Vec<[Rational; 10]>,
    ideal: &Ideal,
    condition: impl Fn(&Matrix) -> Matrix,
) -> Vec<[Rational; 10]> {
    if left.is_empty() {
        return left;
    }
    let weights = Symbol::series(Role::Inertia, "n", left.len());
    let entry = |i: usize| -> Expr {
        let terms = left.iter().zip(&weights);
        terms
            .map(|(element, weight)| &Expr::rational(element[i].clone()) * &Expr::symbol(weight))
            .sum()
    };
    let inertia = spatial_inertia(&(0..10).map(entry).collect::<Vec<_>>());
    let condition = condition(&inertia);
    let mut rows: Vec<[Rational; 10]> = condition
        .entries()
        .iter()
        .flat_map(|entry| linear_conditions(&ideal.normal_form(entry)))
        .collect();
    // Weights beyond those that are left are zero.
    rows.extend((left.len()..10).map(unit));
    let combined = |weights: [Rational; 10]| {
        std::array::from_fn(|i| {
            left.iter()
                .zip(&weights)
                .map(|(element, w)| &element[i] * w)
                .sum()
        })
    };
    null_space(rows).into_iter().map(combined).collect()
}

/// Linear conditions that hold for the given inertias alone.
fn annihilator(inertias: &[[Rational; 10]]) -> Vec<[Rational; 10]> {
    null_space(inertias.to_vec())
}

fn spatial_inertia(n: &[Expr]) -> Matrix {
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
        rows[from]
            .iter_mut()
            .for_each(|entry| *entry = &*entry * &scale);
        let pivot = rows[from].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(n, _)| *n != from) {
            let factor = row[column].clone();
            if !factor.is_zero() {
                row.iter_mut()
                    .zip(&pivot)
                    .for_each(|(entry, p)| *entry = &*entry - &factor * p);
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
