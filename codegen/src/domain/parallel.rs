//! Unit vectors of the plane that are parallel where functions vanish, which relations may rule out: a linkage that folds flat.

use crate::expr::{Expr, Symbol};
use std::collections::BTreeMap;

/// Most unit vectors of which all signs are tried.
const MOST: usize = 6;

/// A unit vector by its scalars (c, s).
pub type Circle = (Symbol, Symbol);

/// Whether the functions have no common zero, because vectors would be parallel there and loops rule that out, with any signs: ±u in the place
/// of every vector of those that are parallel to u. `is_never_zero` decides of functions of parameters.
pub fn is_excluded(
    functions: &[Expr],
    relations: &[Expr],
    circles: &[Circle],
    is_never_zero: impl Fn(&Expr) -> bool,
) -> bool {
    let groups = parallel(functions, circles, &is_never_zero);
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
        let relations: Vec<Expr> = relations.iter().map(|e| e.substitute(&values)).collect();
        is_open(&relations, circles, &is_never_zero)
    })
}

/// Whether two relations are those of a loop that does not close: `(k + i l)(c + i s) = m + i n`, where `k² + l² − m² − n²` is never 0.
fn is_open(relations: &[Expr], circles: &[Circle], is_never_zero: impl Fn(&Expr) -> bool) -> bool {
    let pairs = relations
        .iter()
        .flat_map(|first| relations.iter().map(move |second| (first, second)));
    circles.iter().any(|(c, s)| {
        pairs.clone().any(|(real, imaginary)| {
            let none = [c.clone(), s.clone()];
            let [k, l] = [real.derivative(c), imaginary.derivative(c)];
            let turns =
                (&imaginary.derivative(s) - &k).is_zero() && (&real.derivative(s) + &l).is_zero();
            let [m, n] = [real.at_zero(&none), imaginary.at_zero(&none)];
            let squares = [&k, &l, &m, &n].map(Expr::square);
            let apart = &(&squares[0] + &squares[1]) - &(&squares[2] + &squares[3]);
            let constant = [&k, &l, &m, &n].iter().all(|e| e.is_constant());
            turns && constant && is_never_zero(&apart)
        })
    })
}

/// For each vector the first one to which it is parallel where the functions vanish: those of which one is a multiple of a cross product.
fn parallel(
    functions: &[Expr],
    circles: &[Circle],
    is_never_zero: impl Fn(&Expr) -> bool,
) -> Vec<usize> {
    let mut first: Vec<usize> = (0..circles.len()).collect();
    for (i, j) in (0..circles.len()).flat_map(|j| (0..j).map(move |i| (i, j))) {
        let [c, s] = [&circles[i].0, &circles[i].1].map(Expr::symbol);
        let [of_c, of_s] = [&circles[j].0, &circles[j].1].map(Expr::symbol);
        let cross = &(&c * &of_s) - &(&s * &of_c);
        let mut factors = functions.iter().filter_map(|e| e.exact_quotient(&cross));
        if factors.any(|factor| is_never_zero(&factor)) {
            let (from, to) = (first[i].max(first[j]), first[i].min(first[j]));
            first
                .iter_mut()
                .filter(|group| **group == from)
                .for_each(|group| *group = to);
        }
    }
    first
}

#[cfg(test)]
mod tests {
    use super::is_excluded;
    use crate::expr::{Expr, Role, Symbol};

    #[test]
    fn a_four_bar_folds_flat_where_its_lengths_allow_it() {
        let symbol = |role, n: usize, name: &str| Symbol::new(role, n, name);
        let circle = |n: usize| {
            let scalar = |n| symbol(Role::Coordinate, n, "q");
            (scalar(2 * n), scalar(2 * n + 1))
        };
        let circles: Vec<_> = (0..3).map(circle).collect();
        let cross = |i: usize, j: usize| {
            let [a, b]: [&(Symbol, Symbol); 2] = [&circles[i], &circles[j]];
            let product = |x: &Symbol, y: &Symbol| &Expr::symbol(x) * &Expr::symbol(y);
            &product(&a.0, &b.1) - &product(&a.1, &b.0)
        };
        let minors = [cross(0, 1), cross(1, 2), cross(0, 2)];
        let loop_of = |[ground, a, b, c]: [i64; 4]| {
            let along = |of: fn(&(Symbol, Symbol)) -> &Symbol| -> Expr {
                let links = [a, b, -c].into_iter().zip(&circles);
                links
                    .map(|(length, circle)| &Expr::integer(length) * &Expr::symbol(of(circle)))
                    .sum()
            };
            [&along(|q| &q.0) - &Expr::integer(ground), along(|q| &q.1)]
        };
        let excluded = |links, functions: &[Expr]| {
            is_excluded(functions, &loop_of(links), &circles, |e| {
                e.as_rational().is_some() && !e.is_zero()
            })
        };
        assert!(excluded([6, 5, 2, 4], &minors));
        // A parallelogram, and one of which a third link is free to turn.
        assert!(!excluded([2, 1, 2, 1], &minors));
        assert!(!excluded([6, 5, 2, 4], &minors[..1]));
    }
}
