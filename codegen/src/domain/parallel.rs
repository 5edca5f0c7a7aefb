//! Unit vectors of the plane that are parallel where functions vanish, which relations may rule out: a linkage that folds flat.

use crate::expr::{Expr, Symbol};
use std::collections::BTreeMap;

/// Most unit vectors of which all signs are tried.
const MOST: usize = 6;

/// A unit vector by its scalars (c, s).
pub type Circle = (Symbol, Symbol);

/// Whether the functions have no common zero, because vectors would be parallel there and `contradicts` rules that out of the relations, with
/// any signs: ±u in the place of every vector of those that are parallel to u. `is_factor` says what is never 0.
pub fn is_excluded(
    functions: &[Expr],
    relations: &[Expr],
    circles: &[Circle],
    is_factor: impl Fn(&Expr) -> bool,
    contradicts: impl Fn(&[Expr]) -> bool,
) -> bool {
    let groups = parallel(functions, circles, is_factor);
    let others: Vec<(usize, usize)> = (0..circles.len())
        .filter(|&n| groups[n] != n)
        .map(|n| (n, groups[n]))
        .collect();
    if others.is_empty() || others.len() > MOST {
        return false;
    }
    (0..1_usize << others.len()).all(|signs| {
        let values = others.iter().enumerate().flat_map(|(bit, &(n, first))| {
            let turned = |symbol: &Symbol| match signs >> bit & 1 {
                0 => Expr::symbol(symbol),
                _ => -Expr::symbol(symbol),
            };
            let ((c, s), (of_c, of_s)) = (&circles[n], &circles[first]);
            [(c.clone(), turned(of_c)), (s.clone(), turned(of_s))]
        });
        let values: BTreeMap<Symbol, Expr> = values.collect();
        let relations = relations.iter().map(|e| e.substitute(&values));
        contradicts(&relations.collect::<Vec<_>>())
    })
}

/// For each vector the first one to which it is parallel where the functions vanish: those of which one is a multiple of a cross product.
fn parallel(
    functions: &[Expr],
    circles: &[Circle],
    is_factor: impl Fn(&Expr) -> bool,
) -> Vec<usize> {
    let mut first: Vec<usize> = (0..circles.len()).collect();
    for (i, j) in (0..circles.len()).flat_map(|j| (0..j).map(move |i| (i, j))) {
        let [c, s] = [&circles[i].0, &circles[i].1].map(Expr::symbol);
        let [of_c, of_s] = [&circles[j].0, &circles[j].1].map(Expr::symbol);
        let cross = &(&c * &of_s) - &(&s * &of_c);
        let mut factors = functions.iter().filter_map(|e| e.exact_quotient(&cross));
        if factors.any(|factor| is_factor(&factor)) {
            let (from, to) = (first[i].max(first[j]), first[i].min(first[j]));
            first
                .iter_mut()
                .filter(|group| **group == from)
                .for_each(|group| *group = to);
        }
    }
    first
}
