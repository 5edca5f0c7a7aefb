//! The tangent basis of one degree of freedom as the generalised cross product of the relations' derivatives, entry by entry under a name.
//!
//! The entries b of B are the maximal minors of ∂φ, so that `∂φ B = 0`. What brings Φ back along N = ∂φᵀ, x = N λ, solves `∂φ x = −L_B L_B φ`, L_B the
//! derivative along B held constant; the determinant of `∂φ ∂φᵀ` is |B|². `∂B/∂ϕ = L_B B` solves the same system, so that it differs
//! from x by a multiple of B: `∂B/∂ϕ = x − B s` with `s = Bᵀ(x − L_B B) / |B|²`, which is ∂S/∂ϕ. Proofs read the rates so, and kernels as `L_B B`, which
//! divides by nothing.

use super::directions::Directions;
use super::named::{LONGEST_BEND, Labels, Named, Systems, give_rates, named_gradient};
use super::system::{Inverse, LONGEST, Minors, Names};
use crate::expr::Expr;
use crate::matrix::Matrix;
use crate::prepare::Prepared;
use std::collections::BTreeMap;

/// B and what follows; `None` where B is 0 everywhere.
pub fn expand(joint: &Prepared, directions: &Directions<'_>, plain: &[Expr]) -> Option<Named> {
    let ideal = joint.space.manifold.ideal();
    let (count, size) = directions.gradient.shape();
    let labels = Labels::new(joint, directions, &Matrix::zeros(size, 0));
    let by = labels.freedoms.first()?.clone();
    let mut names = Names::new(ideal);
    let gradient = named_gradient(directions, &labels, &mut names);
    let entries = minors(&gradient, &labels, &by, &mut names);
    let square: Expr = entries.iter().map(Expr::square).sum();
    let inverse = inverse(&gradient, &square, &labels, &mut names)?;
    let tangent = Matrix::column_vector(entries.clone());
    let bend = |r: usize, names: &mut Names<'_>| {
        let value = directions.symmetric(&directions.relations[r], &tangent, 0, 0);
        let name = format!("relation_{}_by_{by}_{by}", labels.relations[r]);
        names.if_long(&name, &value, LONGEST_BEND)
    };
    let bends: Vec<Expr> = (0..count).map(|r| bend(r, &mut names)).collect();
    let back: Vec<Expr> = inverse.times(&bends);
    let back = back.iter().zip(&labels.relations).map(|(value, label)| {
        let symbol = names.named(&format!("back_{label}"), -ideal.simplest(value));
        Expr::symbol(&symbol)
    });
    let back = Matrix::column_vector(back.collect());
    let back = gradient.transpose().times(&back);
    let plain = directions.combined_of(plain, &tangent);
    let (mut corrections, mut rates) = (vec![], vec![]);
    for (n, label) in labels.standard.iter().enumerate() {
        let rate = format!("{label}_by_{by}_along_{by}");
        rates.push(names.if_long(&rate, &plain[n], LONGEST));
        let correction = format!("{label}_by_{by}_{by}");
        let correction = names.named(&correction, back.at(n, 0).clone());
        corrections.push(Expr::symbol(&correction));
    }
    let apart = corrections.iter().zip(&rates).zip(&entries);
    let apart: Expr = apart.map(|((x, rate), entry)| entry * &(x - rate)).sum();
    let slope = Expr::symbol(&names.named("slope", &apart * inverse.reciprocal()));
    let (mut words, mut known) = (names.words, BTreeMap::new());
    for (n, entry) in entries.iter().enumerate() {
        if let Some(symbol) = entry.as_symbol() {
            known.insert(symbol.clone(), vec![&corrections[n] - &(entry * &slope)]);
            give_rates(&mut words, symbol, vec![rates[n].clone()]);
        }
    }
    Some(Named {
        tangent,
        corrections: vec![vec![corrections]],
        rates: known,
        slopes: vec![Matrix::column_vector(vec![slope])],
        systems: Systems {
            words,
            gradient,
            bends: vec![vec![bends]],
        },
    })
}

/// The maximal minors of ∂φ with alternating signs, each under a name.
fn minors(gradient: &Matrix, labels: &Labels, by: &str, names: &mut Names<'_>) -> Vec<Expr> {
    let all: Vec<usize> = (0..gradient.rows()).collect();
    let mut minors = Minors::new(gradient, (&labels.relations, &labels.standard));
    let mut entries = vec![];
    for (n, label) in labels.standard.iter().enumerate() {
        let others: Vec<usize> = (0..gradient.columns())
            .filter(|&other| other != n)
            .collect();
        let minor = minors.expanded(&all, &others, names);
        let minor = if n % 2 == 0 { minor } else { -minor };
        let entry = match minor.is_constant() {
            true => minor,
            false => Expr::symbol(&names.named(&format!("{label}_by_{by}"), minor)),
        };
        entries.push(entry);
    }
    entries
}

/// The inverse of `∂φ ∂φᵀ`, whose determinant is |B|².
fn inverse(
    gradient: &Matrix,
    square: &Expr,
    labels: &Labels,
    names: &mut Names<'_>,
) -> Option<Inverse> {
    let products = gradient.times(&gradient.transpose());
    let mut entries = products.clone();
    for (i, of_row) in labels.relations.iter().enumerate() {
        for (j, of_column) in labels.relations.iter().enumerate().skip(i) {
            let name = format!("relation_{of_row}_beside_{of_column}");
            let entry = names.if_long(&name, products.at(i, j), LONGEST);
            entries = Matrix::from_fn(entries.rows(), entries.columns(), |a, b| {
                match (a, b) == (i, j) || (a, b) == (j, i) {
                    true => entry.clone(),
                    false => entries.at(a, b).clone(),
                }
            });
        }
    }
    Inverse::over(
        square,
        &entries,
        (&labels.relations, &labels.relations),
        names,
    )
}
