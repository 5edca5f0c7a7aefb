//! Sums of exponentials whose powers are factors: each with the exponent that it is scaled by.

use super::numerator::{over_common_denominator, paired, product};
use super::opened;
use super::term::{Key, Terms};
use crate::expr::{Expr, Function, Monomial, Rational};
use num_traits::Zero;
use std::collections::{BTreeMap, BTreeSet};

/// Sums by number, each once.
#[derive(Default)]
pub struct Sums {
    factors: BTreeMap<Expr, Vec<(usize, i32)>>,
    known: Vec<Sum>,
}

/// A sum `S = e^m S′`.
#[derive(Clone)]
pub struct Sum {
    /// Its terms.
    pub terms: Terms,
    /// Their exponents.
    pub exponents: Vec<Expr>,
    /// m.
    pub scale: Expr,
    /// S′.
    pub scaled: Expr,
}

impl Sums {
    /// A sum as a product of powers of numbered sums: a sum of quotients is one over the common denominator.
    pub fn factors(&mut self, sum: &Expr) -> Vec<(usize, i32)> {
        if let Some(known) = self.factors.get(sum) {
            return known.clone();
        }
        let inside = self.with_arguments_in_range(&opened(sum));
        let terms = Terms::new(self, &inside);
        let (terms, common) = over_common_denominator(self, terms).without_common_powers();
        let mut factors = vec![(self.add(terms), 1)];
        factors.extend(common);
        self.factors.insert(sum.clone(), factors.clone());
        factors
    }

    fn add(&mut self, terms: Terms) -> usize {
        let known = self.known.iter();
        if let Some(number) = known.clone().position(|known| known.terms == terms) {
            return number;
        }
        let exponents = self.exponents(&terms);
        let scale = largest(&exponents);
        let scaled = self.scaled(&terms, &scale);
        self.known.push(Sum {
            terms,
            exponents: exponents.into_iter().collect(),
            scale,
            scaled,
        });
        self.known.len() - 1
    }

    /// The sum of that number.
    pub fn sum(&self, number: usize) -> &Sum {
        &self.known[number]
    }

    /// The exponents of terms, those of the sums in them included.
    pub fn exponents(&self, terms: &Terms) -> BTreeSet<Expr> {
        terms.0.keys().map(|key| self.exponent(key)).collect()
    }

    /// The exponent of a term with the powers of sums at their sizes.
    pub fn exponent(&self, key: &Key) -> Expr {
        key.powers
            .iter()
            .fold(key.exponent.clone(), |sum, (number, power)| {
                let half = Rational::new((*power).into(), 2.into());
                &sum + &self.sum(*number).scale.scaled(&half, &Monomial::one())
            })
    }

    /// The terms times `e^(−scale)`.
    pub fn scaled(&self, terms: &Terms, scale: &Expr) -> Expr {
        paired(terms, &|key| {
            product(self, key, &(&self.exponent(key) - scale).exp())
        })
    }
}

/// The largest of some exponents.
pub fn largest(exponents: &BTreeSet<Expr>) -> Expr {
    let mut corners = corners(exponents).into_iter();
    let first = corners.next().unwrap_or_default();
    corners.fold(first, |largest, other| {
        Expr::applied(Function::Larger, &[other, largest])
    })
}

/// The exponents without those between two others on a line: k·d with numbers k lie on the line of d.
fn corners(exponents: &BTreeSet<Expr>) -> Vec<Expr> {
    let mut lines: BTreeMap<Expr, Vec<Rational>> = BTreeMap::new();
    for exponent in exponents {
        if let Some((_, first)) = exponent.leading() {
            let direction = exponent.scaled(&first.recip(), &Monomial::one());
            lines.entry(direction).or_default().push(first.clone());
        }
    }
    let has_zero = exponents.contains(&Expr::zero());
    let mut zero_is_between = false;
    let mut corners = vec![];
    for (direction, mut multiples) in lines {
        if has_zero {
            multiples.push(Rational::zero());
        }
        multiples.sort();
        let ends = [multiples.first(), multiples.last()].into_iter().flatten();
        let ends: BTreeSet<Rational> = ends.cloned().collect();
        zero_is_between |= has_zero && !ends.contains(&Rational::zero());
        let others = ends.into_iter().filter(|end| !end.is_zero());
        corners.extend(others.map(|end| direction.scaled(&end, &Monomial::one())));
    }
    if has_zero && !zero_is_between {
        corners.insert(0, Expr::zero());
    }
    corners
}

/// Powers of S′, by their halves.
pub fn power(scaled: &Expr, halves: i32) -> Expr {
    let (whole, times) = (halves % 2 == 0, halves.unsigned_abs());
    let (base, times) = match whole {
        true => (scaled.clone(), times / 2),
        false => (scaled.sqrt(), times),
    };
    match halves < 0 {
        true => base.recip().unwrap_or_default().pow(times),
        false => base.pow(times),
    }
}
