//! The terms of one expression over numbers: of its atoms, and of the sizes of its coefficients.

use crate::expr::{Atom, Expr, Monomial, Rational, reverse_lexicographic};
use num_traits::One;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// What the numbers of terms stand for.
pub struct Numbered {
    /// The atoms, ascending.
    pub atoms: Vec<Atom>,
    /// 1, and the other absolute values of coefficients, ascending.
    pub sizes: Vec<Rational>,
}

/// A term. Terms are ordered as their monomials are.
#[derive(Clone, Debug)]
pub struct Term {
    /// Whether it is subtracted.
    pub negative: bool,
    /// The number of its coefficient's absolute value.
    pub size: usize,
    degree: u32,
    main: Vec<(usize, u32)>,
    units: Vec<(usize, i32)>,
}

impl Numbered {
    /// The number of 1.
    pub const ONE: usize = 0;

    /// Numbers an expression; its terms in ascending order.
    pub fn new(expression: &Expr) -> (Self, Vec<Term>) {
        let mut sizes: BTreeSet<Rational> = expression.terms().map(|(_, c)| c.abs()).collect();
        sizes.remove(&Rational::one());
        let numbered = Self {
            atoms: expression.atoms().into_iter().collect(),
            sizes: std::iter::once(Rational::one()).chain(sizes).collect(),
        };
        let places = |(number, atom)| (atom, number);
        let places: BTreeMap<&Atom, usize> =
            numbered.atoms.iter().enumerate().map(places).collect();
        let terms = expression.terms();
        let terms = terms.map(|(monomial, c)| numbered.term(&places, monomial, c));
        let terms = terms.collect();
        (numbered, terms)
    }

    fn term(&self, places: &BTreeMap<&Atom, usize>, monomial: &Monomial, c: &Rational) -> Term {
        let others = &self.sizes[1..];
        let size = others.binary_search(&c.abs()).map_or(Self::ONE, |n| n + 1);
        let main = monomial.main().iter();
        let units = monomial.units().iter();
        Term {
            negative: c.is_negative(),
            size,
            degree: monomial.degree(),
            main: main.map(|(atom, power)| (places[atom], *power)).collect(),
            units: units.map(|(atom, power)| (places[atom], *power)).collect(),
        }
    }
}

impl Term {
    /// All atoms with their powers.
    pub fn factors(&self) -> impl Iterator<Item = (usize, i32)> {
        let main = self.main.iter().map(|(atom, power)| (*atom, *power as i32));
        self.units.iter().copied().chain(main)
    }

    /// The power of an atom.
    pub fn power(&self, atom: usize) -> i32 {
        let found = self.factors().find(|(candidate, _)| *candidate == atom);
        found.map_or(0, |(_, power)| power)
    }

    /// Changes the power of an atom that occurs; false where it does not.
    pub fn multiply(&mut self, atom: usize, by: i32) -> bool {
        if let Some((_, power)) = self.units.iter_mut().find(|(unit, _)| *unit == atom) {
            *power += by;
            self.units.retain(|(_, power)| *power != 0);
            return true;
        }
        let Some((_, power)) = self.main.iter_mut().find(|(own, _)| *own == atom) else {
            return false;
        };
        *power = power.saturating_add_signed(by);
        self.degree = self.degree.saturating_add_signed(by);
        self.main.retain(|(_, power)| *power != 0);
        true
    }
}

impl Ord for Term {
    fn cmp(&self, other: &Self) -> Ordering {
        self.degree
            .cmp(&other.degree)
            .then_with(|| reverse_lexicographic(&self.main, &other.main))
            .then_with(|| self.units.cmp(&other.units))
    }
}

impl PartialOrd for Term {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Eq for Term {}

impl PartialEq for Term {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
