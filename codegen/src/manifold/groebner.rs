//! Gröbner bases of the relations of a manifold, by Buchberger's algorithm.

use crate::expr::{Expr, Rational, budget};
use num_traits::One;
use std::borrow::Borrow;

/// A relation whose leading coefficient is a sum of parameters cannot be solved for its leading monomial.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotMonic {
    /// The relation.
    pub relation: Expr,
}

/// The reduced Gröbner basis of the ideal of `relations`.
pub fn groebner_basis(relations: &[Expr]) -> Result<Vec<Expr>, NotMonic> {
    let basis = interreduce(relations.to_vec())?;
    let pairs = pairs_up_to(basis.len());
    completed(basis, pairs)
}

/// The reduced Gröbner basis of the ideal of a basis and further relations.
pub fn extended(basis: &[Expr], relations: &[Expr]) -> Result<Vec<Expr>, NotMonic> {
    let mut all = basis.to_vec();
    let mut pairs = vec![];
    for relation in relations {
        let reduced = reduce(relation, &all);
        if !reduced.is_zero() {
            pairs.extend((0..all.len()).map(|i| (i, all.len())));
            all.push(monic(reduced)?);
        }
    }
    completed(all, pairs)
}

/// Buchberger's algorithm: reduces S-polynomials until all reduce to zero.
fn completed(mut basis: Vec<Expr>, mut pairs: Vec<(usize, usize)>) -> Result<Vec<Expr>, NotMonic> {
    while let Some((i, j)) = take_smallest(&mut pairs, &basis) {
        if budget::is_exhausted() {
            break;
        }
        let Some(s) = s_polynomial(&basis[i], &basis[j]) else {
            continue;
        };
        let remainder = reduce(&s, &basis);
        if !remainder.is_zero() {
            let found = monic(remainder)?;
            if found.is_one() {
                return Ok(vec![found]);
            }
            pairs.extend((0..basis.len()).map(|k| (k, basis.len())));
            basis.push(found);
        }
    }
    interreduce(basis)
}

/// The normal form of `expression` modulo a Gröbner basis of monic polynomials.
pub fn reduce<E: Borrow<Expr>>(expression: &Expr, basis: &[E]) -> Expr {
    let mut rest = expression.clone();
    let mut normal = Expr::zero();
    while let Some((monomial, coefficient)) = rest.leading().map(|(m, c)| (m.clone(), c.clone())) {
        // Searching the basis costs more than the subtraction that follows.
        if !budget::spend(1 + basis.len() as u64) {
            return Expr::zero();
        }
        let step = basis
            .iter()
            .map(Borrow::borrow)
            .find_map(|g| Some((g, monomial.divided_by(g.leading()?.0)?)));
        match step {
            Some((g, quotient)) => {
                // Coefficients of a basis that does not end soon grow to thousands of digits, at a cost of their own.
                budget::spend(weight(&coefficient) * g.terms().len() as u64);
                rest.add_scaled(&-coefficient, &quotient, g);
            }
            None => {
                let term = Expr::term(coefficient, monomial);
                rest -= &term;
                normal += &term;
            }
        }
    }
    normal
}

/// Work of an operation on the number beyond that on a small one: reducing a fraction takes some 64 steps for each machine word.
fn weight(number: &Rational) -> u64 {
    8 * number.excess()
}

fn pairs_up_to(count: usize) -> Vec<(usize, usize)> {
    (0..count)
        .flat_map(|j| (0..j).map(move |i| (i, j)))
        .collect()
}

/// Buchberger's normal strategy: the pair with the smallest common multiple first.
fn take_smallest(pairs: &mut Vec<(usize, usize)>, basis: &[Expr]) -> Option<(usize, usize)> {
    let multiple = |&(i, j): &(usize, usize)| {
        let (a, b) = (basis[i].leading()?.0, basis[j].leading()?.0);
        Some(a.lcm(b))
    };
    budget::spend(pairs.len() as u64 / 4);
    let position = (0..pairs.len()).min_by_key(|&n| multiple(&pairs[n]))?;
    Some(pairs.swap_remove(position))
}

/// `None` where the leading monomials are coprime: the pair then reduces to zero (Buchberger's first criterion).
fn s_polynomial(f: &Expr, g: &Expr) -> Option<Expr> {
    let (lf, lg) = (f.leading()?.0, g.leading()?.0);
    if lf.is_coprime(lg) {
        return None;
    }
    let multiple = lf.lcm(lg);
    let one = Rational::one();
    let mut s = f.scaled(&one, &multiple.divided_by(lf)?);
    s.add_scaled(&-one, &multiple.divided_by(lg)?, g);
    Some(s)
}

/// The relation as a rule for its leading monomial, where that can be solved for.
pub fn rule(relation: &Expr) -> Option<Expr> {
    monic(relation.clone()).ok().filter(|rule| !rule.is_zero())
}

/// Scales so that the leading term has coefficient 1 and no parameters.
fn monic(relation: Expr) -> Result<Expr, NotMonic> {
    let Some((monomial, coefficient)) = relation.leading() else {
        return Ok(relation);
    };
    let (main, units) = monomial.split();
    let competing = relation
        .terms()
        .filter(|(m, _)| m.split().0 == main)
        .count();
    match (competing, units.recip()) {
        (1, Some(inverse)) => Ok(relation.scaled(&coefficient.recip(), &inverse)),
        _ => Err(NotMonic { relation }),
    }
}

/// Reduces every element by the others until none changes; drops zeros.
fn interreduce(mut basis: Vec<Expr>) -> Result<Vec<Expr>, NotMonic> {
    basis = basis
        .into_iter()
        .filter(|g| !g.is_zero())
        .map(monic)
        .collect::<Result<_, _>>()?;
    loop {
        let mut changed = false;
        let mut position = 0;
        while position < basis.len() {
            let element = basis.remove(position);
            let reduced = reduce(&element, &basis);
            changed |= reduced != element;
            if !reduced.is_zero() {
                basis.insert(position, monic(reduced)?);
                position += 1;
            }
        }
        if !changed || budget::is_exhausted() {
            basis.sort_by(|a, b| a.leading().map(|t| t.0).cmp(&b.leading().map(|t| t.0)));
            return Ok(basis);
        }
    }
}

/// Whether a leading monomial is one: the relations contradict each other.
pub fn is_trivial(basis: &[Expr]) -> bool {
    basis
        .iter()
        .any(|g| g.leading().is_some_and(|(m, _)| m.main().is_empty()))
}
