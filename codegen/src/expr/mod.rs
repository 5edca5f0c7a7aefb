//! Symbolic scalars: polynomials over the rationals in symbols and functions.
//!
//! An [`Expr`] is a sum of terms, each a rational times a [`Monomial`] of [`Atom`]s, sorted; equal sums are equal values, so
//! that the ring needs no separate simplifier. Sines, roots and quotients are atoms of their own, related to others by the
//! polynomials of [`Expr::atom_relations`]; an [`crate::manifold::Ideal`] reduces modulo those and the manifold's relations.

mod atom;
pub mod budget;
pub mod curve;
mod derivative;
mod display;
mod division;
mod evaluate;
mod function;
mod hyperbolic;
mod intern;
mod monomial;
mod rational;
mod terms;

pub use atom::{Application, Atom, Function, Role, Symbol};
pub use evaluate::{Number, evaluate_f64};
pub use monomial::Monomial;
pub(crate) use monomial::reverse_lexicographic;
pub use rational::Rational;
pub(crate) use terms::Terms;

use num_traits::{One, Zero};
use rustc_hash::FxHashSet;
use std::collections::BTreeSet;
use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

/// Distinct atoms for which a set has room from the beginning: growing from nothing, it would move them three times.
const FEW_ATOMS: usize = 14;

/// Products of terms that are not combined before there are as many.
const MANY_PRODUCTS: usize = 4096;

/// A polynomial with rational coefficients in [`Atom`]s.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Expr {
    terms: Terms<Monomial>,
}

impl Expr {
    /// Zero.
    pub fn zero() -> Self {
        Self::default()
    }

    /// One.
    pub fn one() -> Self {
        Self::integer(1)
    }

    /// The integer `value`.
    pub fn integer(value: i64) -> Self {
        Self::rational(value.into())
    }

    /// The fraction `numerator / denominator`; zero denominators are a programming error of the caller.
    pub fn fraction(numerator: i64, denominator: i64) -> Self {
        Self::rational(Rational::new(numerator.into(), denominator.into()))
    }

    /// The rational `value`.
    pub fn rational(value: Rational) -> Self {
        Self::term(value, Monomial::one())
    }

    /// The symbol.
    pub fn symbol(symbol: &Symbol) -> Self {
        Self::atom(Atom::Symbol(symbol.clone()))
    }

    /// The atom.
    pub fn atom(atom: Atom) -> Self {
        Self::term(Rational::one(), Monomial::atom(atom))
    }

    /// `coefficient · monomial`.
    pub fn term(coefficient: Rational, monomial: Monomial) -> Self {
        Self {
            terms: Terms::single(monomial, coefficient),
        }
    }

    /// The sum of terms in any order.
    pub(crate) fn of_terms(terms: impl IntoIterator<Item = (Monomial, Rational)>) -> Self {
        Self {
            terms: terms.into_iter().collect(),
        }
    }

    /// Takes the largest term away.
    pub(crate) fn pop_leading(&mut self) -> Option<(Monomial, Rational)> {
        // As for taking the term from one sum and putting it into another.
        budget::spend(2);
        self.terms.pop()
    }

    /// The terms, in ascending term order.
    pub fn terms(
        &self,
    ) -> impl DoubleEndedIterator<Item = (&Monomial, &Rational)> + ExactSizeIterator {
        self.terms.iter()
    }

    /// The largest term.
    pub fn leading(&self) -> Option<(&Monomial, &Rational)> {
        self.terms.last()
    }

    /// Whether this is zero as it stands, without any relation.
    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// Whether this is one term of a rational and parameters.
    pub fn is_unit(&self) -> bool {
        self.terms().len() == 1
            && self
                .leading()
                .is_some_and(|(monomial, _)| monomial.is_unit())
    }

    /// Whether this is one.
    pub fn is_one(&self) -> bool {
        self.as_rational().is_some_and(|value| value.is_one())
    }

    /// Monomial and coefficient, if this is one term.
    pub fn single_term(&self) -> Option<(&Monomial, &Rational)> {
        self.leading().filter(|_| self.terms.len() == 1)
    }

    /// The value, if this is a rational number.
    pub fn as_rational(&self) -> Option<Rational> {
        match self.terms.len() {
            0 => Some(Rational::zero()),
            1 => {
                let (monomial, value) = self.leading()?;
                monomial.is_one().then(|| value.clone())
            }
            _ => None,
        }
    }

    /// The symbol, if this is one.
    pub fn as_symbol(&self) -> Option<&Symbol> {
        let (monomial, coefficient) = self.leading()?;
        match monomial.main() {
            [(Atom::Symbol(symbol), 1)]
                if self.terms.len() == 1 && coefficient.is_one() && monomial.units().is_empty() =>
            {
                Some(symbol)
            }
            _ => None,
        }
    }

    /// Whether a name would say nothing more: a number, a parameter, a symbol, or the opposite of one.
    pub fn is_plain(&self) -> bool {
        let is_signed_symbol = |(monomial, coefficient): (&Monomial, &Rational)| {
            let is_symbol = matches!(monomial.main(), [(Atom::Symbol(_), 1)]);
            is_symbol && monomial.units().is_empty() && coefficient.abs().is_one()
        };
        self.is_constant() || self.single_term().is_some_and(is_signed_symbol)
    }

    /// Whether this depends on no symbol but parameters.
    pub fn is_constant(&self) -> bool {
        let varies = |symbol: &Symbol| symbol.role != Role::Parameter;
        !self.any_atom(|atom| match atom {
            Atom::Symbol(symbol) => varies(symbol),
            Atom::Apply(application) => application.symbols().iter().any(varies),
        })
    }

    /// All symbols, those inside functions included.
    pub fn symbols(&self) -> BTreeSet<Symbol> {
        let mut symbols = BTreeSet::new();
        for atom in self.distinct_atoms() {
            match atom {
                Atom::Symbol(symbol) => {
                    symbols.insert(symbol.clone());
                }
                Atom::Apply(application) => {
                    symbols.extend(application.symbols().iter().cloned());
                }
            }
        }
        symbols
    }

    /// Whether the symbol occurs, inside functions too.
    pub fn contains(&self, symbol: &Symbol) -> bool {
        self.any_atom(|atom| match atom {
            Atom::Symbol(own) => own == symbol,
            Atom::Apply(application) => application.symbols().contains(symbol),
        })
    }

    /// Whether one of the symbols occurs, inside functions too.
    pub fn contains_any(&self, symbols: &BTreeSet<Symbol>) -> bool {
        self.any_atom(|atom| match atom {
            Atom::Symbol(own) => symbols.contains(own),
            Atom::Apply(application) => !application.symbols().is_disjoint(symbols),
        })
    }

    fn any_atom(&self, holds: impl Fn(&Atom) -> bool) -> bool {
        budget::spend(self.work());
        let mut factors = self.terms.keys().flat_map(Monomial::factors);
        factors.any(|(atom, _)| holds(atom))
    }

    /// The atoms of the polynomial itself, not those inside functions.
    pub fn atoms(&self) -> BTreeSet<Atom> {
        self.distinct_atoms().into_iter().cloned().collect()
    }

    fn distinct_atoms(&self) -> FxHashSet<&Atom> {
        budget::spend(self.work());
        let factors = self.terms.keys().flat_map(Monomial::factors);
        // Most occur in many terms: hashing finds that sooner than sorting.
        let mut atoms = FxHashSet::with_capacity_and_hasher(FEW_ATOMS, Default::default());
        atoms.extend(factors.map(|(atom, _)| atom));
        atoms
    }

    /// The functions with relations that occur, those inside arguments of roots and quotients included.
    pub(crate) fn related_functions(&self) -> BTreeSet<Atom> {
        let mut found = BTreeSet::new();
        for atom in self.atoms() {
            let Atom::Apply(application) = &atom else {
                continue;
            };
            match application.function {
                Function::Cos
                | Function::Sin
                | Function::Exp
                | Function::Sinh
                | Function::Cosh
                | Function::Sech
                | Function::Tanh => {
                    found.insert(atom);
                }
                Function::Sqrt | Function::Recip | Function::Group => {
                    found.extend(application.related().iter().cloned());
                    found.insert(atom);
                }
                _ => {}
            }
        }
        found
    }

    /// `self · coefficient · monomial`.
    pub fn scaled(&self, coefficient: &Rational, monomial: &Monomial) -> Self {
        if coefficient.is_zero() || !budget::spend(self.work()) {
            return Self::zero();
        }
        let scale = |(m, c): (&Monomial, &Rational)| (m.times(monomial), c * coefficient);
        Self {
            terms: self.terms.iter().map(scale).collect(),
        }
    }

    /// The integer power.
    pub fn pow(&self, exponent: u32) -> Self {
        let (mut base, mut exponent, mut power) = (self.clone(), exponent, Self::one());
        while exponent > 0 && !budget::is_exhausted() {
            if exponent & 1 == 1 {
                power = &power * &base;
            }
            exponent >>= 1;
            if exponent > 0 {
                base = &base * &base;
            }
        }
        power
    }

    /// The square.
    pub fn square(&self) -> Self {
        self * self
    }

    /// Whether the leading coefficient is negative: decides which of `a − b` and `b − a` is written.
    pub fn leads_negative(&self) -> bool {
        self.leading().is_some_and(|(_, c)| c.is_negative())
    }

    /// Term operations that a pass over the terms takes: long monomials take longer to multiply and to compare, and so do long numbers.
    fn work(&self) -> u64 {
        let longest = self.leading().map_or(0, |(monomial, _)| monomial.len());
        let ends = self.terms.first().into_iter().chain(self.leading());
        let excess = ends.map(|(_, coefficient)| coefficient.excess()).max();
        self.terms.len() as u64 * (1 + longest as u64 / 4 + 4 * excess.unwrap_or(0))
    }

    /// Adds `coefficient · monomial · other` in place.
    pub fn add_scaled(&mut self, coefficient: &Rational, monomial: &Monomial, other: &Self) {
        self.terms += other.scaled(coefficient, monomial).terms;
    }
}

impl AddAssign<&Expr> for Expr {
    fn add_assign(&mut self, other: &Expr) {
        if budget::spend(other.work()) {
            self.terms += other.terms.clone();
        }
    }
}

impl SubAssign<&Expr> for Expr {
    fn sub_assign(&mut self, other: &Expr) {
        if budget::spend(other.work()) {
            self.terms += (-other).terms;
        }
    }
}

impl Add for &Expr {
    type Output = Expr;
    fn add(self, other: &Expr) -> Expr {
        let mut sum = self.clone();
        sum += other;
        sum
    }
}

impl Sub for &Expr {
    type Output = Expr;
    fn sub(self, other: &Expr) -> Expr {
        let mut difference = self.clone();
        difference -= other;
        difference
    }
}

impl Mul for &Expr {
    type Output = Expr;
    fn mul(self, other: &Expr) -> Expr {
        let (short, long) = match self.terms.len() <= other.terms.len() {
            true => (self, other),
            false => (other, self),
        };
        let (mut product, mut products) = (Expr::zero(), vec![]);
        for (monomial, coefficient) in short.terms.iter() {
            if !budget::spend(long.work()) {
                break;
            }
            let scaled = |(m, c): (&Monomial, &Rational)| (m.times(monomial), c * coefficient);
            products.extend(long.terms.iter().map(scaled));
            // Combined when they are as many as the terms so far: memory holds no more than twice the product, and each merge doubles it.
            if products.len() >= product.terms.len().max(MANY_PRODUCTS) {
                product.terms += products.drain(..).collect();
            }
        }
        product.terms += products.into_iter().collect();
        product
    }
}

impl Neg for &Expr {
    type Output = Expr;
    fn neg(self) -> Expr {
        let terms = self.terms.iter().map(|(m, c)| (m.clone(), -c)).collect();
        Expr { terms }
    }
}

macro_rules! by_value {
    ($($operator:ident $method:ident),*) => {$(
        impl $operator for Expr {
            type Output = Expr;
            fn $method(self, other: Expr) -> Expr {
                (&self).$method(&other)
            }
        }
    )*};
}
by_value!(Add add, Sub sub, Mul mul);

impl Neg for Expr {
    type Output = Expr;
    fn neg(self) -> Expr {
        -&self
    }
}

impl std::iter::Sum for Expr {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::zero(), |mut sum, term| {
            sum += &term;
            sum
        })
    }
}

#[cfg(test)]
mod tests;
