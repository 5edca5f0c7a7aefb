//! Gröbner bases of the relations of a manifold, by Buchberger's algorithm.

use crate::expr::{Expr, Monomial, Rational, budget};
use num_traits::One;
use std::borrow::Borrow;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A relation whose leading coefficient is a sum of parameters cannot be solved for its leading monomial.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotMonic {
    /// The relation.
    pub relation: Expr,
}

/// The reduced Gröbner basis of the ideal of `relations`.
pub fn groebner_basis(relations: &[Expr]) -> Result<Vec<Expr>, NotMonic> {
    let basis = interreduce(relations.to_vec())?;
    let mut pairs = Pairs::default();
    (0..basis.len()).for_each(|place| pairs.add(&basis, place));
    completed(basis, pairs)
}

/// The reduced Gröbner basis of the ideal of a basis and further relations.
pub fn extended(basis: &[Expr], relations: &[Expr]) -> Result<Vec<Expr>, NotMonic> {
    let mut all = basis.to_vec();
    let mut pairs = Pairs::default();
    for relation in relations {
        let reduced = reduce(relation, &all);
        if !reduced.is_zero() {
            all.push(monic(reduced)?);
            pairs.add(&all, all.len() - 1);
        }
    }
    completed(all, pairs)
}

/// Buchberger's algorithm: reduces S-polynomials until all reduce to zero.
fn completed(mut basis: Vec<Expr>, mut pairs: Pairs) -> Result<Vec<Expr>, NotMonic> {
    while let Some(Reverse((multiple, i, j))) = pairs.0.pop() {
        if budget::is_exhausted() {
            break;
        }
        let Some(s) = s_polynomial(&basis[i], &basis[j], &multiple) else {
            continue;
        };
        let remainder = reduce(&s, &basis);
        if !remainder.is_zero() {
            let found = monic(remainder)?;
            if found.is_one() {
                return Ok(vec![found]);
            }
            basis.push(found);
            pairs.add(&basis, basis.len() - 1);
        }
    }
    interreduce(basis)
}

/// The normal form of `expression` modulo a Gröbner basis of monic polynomials.
pub fn reduce<E: Borrow<Expr>>(expression: &Expr, basis: &[E]) -> Expr {
    let mut rest = expression.clone();
    let mut normal = vec![];
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
            None => normal.extend(rest.pop_leading()),
        }
    }
    Expr::of_terms(normal.into_iter().rev())
}

/// Work of an operation on the number beyond that on a small one: reducing a fraction takes some 64 steps for each machine word.
fn weight(number: &Rational) -> u64 {
    8 * number.excess()
}

/// Pairs of elements of a basis, by Buchberger's normal strategy: that with the smallest common multiple first.
#[derive(Default)]
struct Pairs(BinaryHeap<Reverse<(Monomial, usize, usize)>>);

impl Pairs {
    /// Adds the pairs of an element with those before it, except for coprime leading monomials: these reduce to zero (Buchberger's first
    /// criterion).
    fn add(&mut self, basis: &[Expr], place: usize) {
        budget::spend(place as u64);
        let leading = |n: usize| basis[n].leading().map(|(monomial, _)| monomial);
        let Some(new) = leading(place) else {
            return;
        };
        for other in 0..place {
            if let Some(old) = leading(other).filter(|old| !old.is_coprime(new)) {
                self.0.push(Reverse((old.lcm(new), other, place)));
            }
        }
    }
}

/// The difference of both, each scaled to the common multiple of their leading monomials.
fn s_polynomial(f: &Expr, g: &Expr, multiple: &Monomial) -> Option<Expr> {
    let (lf, lg) = (f.leading()?.0, g.leading()?.0);
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
