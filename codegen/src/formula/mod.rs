//! Formulas as they are written: sums, products and quotients in reading order, common factors outside.
//!
//! An [`Expr`](crate::expr::Expr) is a sorted sum of terms; a [`Node`] is one way to write its value. Code and pages are
//! both written from nodes, so that what is counted is what is emitted and what is shown.

mod count;
mod divisor;
mod exponential;
mod factor;
mod few;
mod fused;
mod layered;
pub mod names;
mod numbered;
mod pairs;
mod reciprocal;
mod shapes;
mod share;
mod symbols;
#[cfg(test)]
mod tests;

pub use count::Counts;
pub use factor::factored;
pub use fused::Chain;
pub use share::{Binding, Program};
pub use symbols::Names;

use crate::expr::{Function, Rational, Symbol};
use num_traits::{One, Zero};
use rustc_hash::FxHashMap;

/// A formula.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Node {
    /// A rational number, not negative.
    Number(Rational),
    /// A named value.
    Symbol(Symbol),
    /// The circle constant.
    Pi,
    /// Two or more terms; those marked true are subtracted, and the first never is.
    Sum(Vec<(bool, Node)>),
    /// Two or more factors.
    Product(Vec<Node>),
    /// Numerator and denominator.
    Quotient(Box<Node>, Box<Node>),
    /// The opposite.
    Negative(Box<Node>),
    /// A function applied to arguments.
    Call(Function, Vec<Node>),
}

impl Node {
    /// The number `value`.
    pub fn number(value: &Rational) -> Self {
        let size = Self::Number(value.abs());
        if value.is_negative() {
            size.negated()
        } else {
            size
        }
    }

    /// Zero.
    pub fn zero() -> Self {
        Self::Number(Rational::zero())
    }

    /// One.
    pub fn one() -> Self {
        Self::Number(Rational::one())
    }

    /// Whether this is the number zero.
    pub fn is_zero(&self) -> bool {
        matches!(self, Self::Number(value) if value.is_zero())
    }

    /// Whether this is the number one.
    pub fn is_one(&self) -> bool {
        matches!(self, Self::Number(value) if value.is_one())
    }

    /// The opposite.
    #[must_use]
    pub fn negated(self) -> Self {
        match self {
            Self::Negative(inner) => *inner,
            zero if zero.is_zero() => zero,
            other => Self::Negative(Box::new(other)),
        }
    }

    /// The sum, in the order given; sums among the terms are opened.
    ///
    /// Its first term has a plus: a sum that would start with a minus is the opposite of a sum, so that `a − b` and `b − a`
    /// are recognised as one value.
    pub fn sum(terms: impl IntoIterator<Item = Self>) -> Self {
        let mut signed = vec![];
        for term in terms {
            push_term(&mut signed, false, term);
        }
        cancel(&mut signed);
        let flip = signed.first().is_some_and(|(subtracted, _)| *subtracted);
        for (subtracted, _) in &mut signed {
            *subtracted ^= flip;
        }
        let sum = match signed.len() {
            0 => Self::zero(),
            1 => signed.remove(0).1,
            _ => Self::Sum(signed),
        };
        if flip { sum.negated() } else { sum }
    }

    /// The product, in the order given; products and quotients among the factors are opened, signs move to the front.
    pub fn product(factors: impl IntoIterator<Item = Self>) -> Self {
        let mut parts = Parts::default();
        for factor in factors {
            parts.multiply(factor);
        }
        parts.cancel();
        let value = match (Self::of_factors(parts.above), parts.below.is_empty()) {
            (above, true) => above,
            (above, false) => {
                Self::Quotient(Box::new(above), Box::new(Self::of_factors(parts.below)))
            }
        };
        match (value.is_zero_quotient(), parts.negative) {
            (true, _) => Self::zero(),
            (false, true) => value.negated(),
            (false, false) => value,
        }
    }

    /// The quotient.
    #[must_use]
    pub fn over(self, denominator: Self) -> Self {
        let mut parts = Parts::default();
        parts.multiply(denominator);
        let (above, below) = (Self::of_factors(parts.below), Self::of_factors(parts.above));
        let sign = if parts.negative {
            Self::one().negated()
        } else {
            Self::one()
        };
        let quotient = match below.is_one() {
            true => Self::one(),
            false => Self::Quotient(Box::new(Self::one()), Box::new(below)),
        };
        Self::product([sign, self, above, quotient])
    }

    fn of_factors(mut factors: Vec<Self>) -> Self {
        match factors.len() {
            0 => Self::one(),
            _ if factors.iter().any(Self::is_zero) => Self::zero(),
            1 => factors.remove(0),
            _ => Self::Product(factors),
        }
    }

    fn is_zero_quotient(&self) -> bool {
        match self {
            Self::Quotient(above, _) => above.is_zero(),
            other => other.is_zero(),
        }
    }

    /// The same formula with `f` applied to its direct parts.
    #[must_use]
    pub fn map_parts(&self, f: &mut impl FnMut(&Self) -> Self) -> Self {
        match self {
            Self::Number(_) | Self::Symbol(_) | Self::Pi => self.clone(),
            Self::Sum(terms) => Self::Sum(
                terms
                    .iter()
                    .map(|(minus, term)| (*minus, f(term)))
                    .collect(),
            ),
            Self::Product(factors) => Self::Product(factors.iter().map(f).collect()),
            Self::Quotient(above, below) => Self::Quotient(Box::new(f(above)), Box::new(f(below))),
            Self::Negative(inner) => Self::Negative(Box::new(f(inner))),
            Self::Call(function, arguments) => {
                Self::Call(*function, arguments.iter().map(f).collect())
            }
        }
    }

    /// Calls `visit` for this formula and all its parts, outermost first.
    pub fn visit(&self, visit: &mut impl FnMut(&Self)) {
        visit(self);
        match self {
            Self::Number(_) | Self::Symbol(_) | Self::Pi => {}
            Self::Sum(terms) => terms.iter().for_each(|(_, term)| term.visit(visit)),
            Self::Product(parts) | Self::Call(_, parts) => {
                parts.iter().for_each(|part| part.visit(visit));
            }
            Self::Quotient(above, below) => [above, below].iter().for_each(|p| p.visit(visit)),
            Self::Negative(inner) => inner.visit(visit),
        }
    }

    /// Calls `change` for each direct part.
    pub(super) fn change_parts(&mut self, change: &mut impl FnMut(&mut Self)) {
        match self {
            Self::Number(_) | Self::Symbol(_) | Self::Pi => {}
            Self::Sum(terms) => terms.iter_mut().for_each(|(_, term)| change(term)),
            Self::Product(parts) | Self::Call(_, parts) => parts.iter_mut().for_each(change),
            Self::Quotient(above, below) => {
                [above, below].into_iter().for_each(|part| change(part))
            }
            Self::Negative(inner) => change(inner),
        }
    }

    /// Puts `make` of this formula in its place.
    pub(super) fn replace_by(&mut self, make: impl FnOnce(Self) -> Self) {
        *self = make(std::mem::replace(self, Self::Pi));
    }

    /// Puts the value in the place of the symbol; whether it occurs.
    pub(super) fn put(&mut self, symbol: &Symbol, value: &Self) -> bool {
        match self {
            Self::Symbol(own) if own == symbol => {
                *self = value.clone();
                true
            }
            other => {
                let mut occurs = false;
                other.change_parts(&mut |part| occurs |= part.put(symbol, value));
                occurs
            }
        }
    }

    /// Puts symbols in the places of others.
    pub(super) fn rename(&mut self, names: &FxHashMap<Symbol, Symbol>) {
        match self {
            Self::Symbol(own) => {
                if let Some(name) = names.get(own) {
                    *own = name.clone();
                }
            }
            other => other.change_parts(&mut |part| part.rename(names)),
        }
    }

    /// The same value without sums as terms of sums, nor products and quotients as factors.
    #[must_use]
    pub fn opened(mut self) -> Self {
        self.change_parts(&mut |part| part.replace_by(Self::opened));
        match self {
            Self::Sum(terms) => Self::sum(terms.into_iter().map(|(minus, term)| match minus {
                true => term.negated(),
                false => term,
            })),
            Self::Product(factors) => Self::product(factors),
            other => other,
        }
    }

    /// The same value as it is best read: `b − a` instead of `−(a − b)`, a positive term first.
    #[must_use]
    pub fn polished(mut self) -> Self {
        match self {
            Self::Negative(inner) => inner
                .flipped()
                .unwrap_or_else(|| Self::Negative(Box::new(inner.polished()))),
            _ => {
                self.change_parts(&mut |part| part.replace_by(Self::polished));
                self
            }
        }
    }

    /// The opposite without a sign in front, where a sum with both signs can take it up.
    fn flipped(&self) -> Option<Self> {
        match self {
            Self::Sum(terms) => {
                let flipped = terms
                    .iter()
                    .map(|(minus, term)| (!minus, term.clone().polished()));
                let mut flipped: Vec<_> = flipped.collect();
                let first = flipped.iter().position(|(subtracted, _)| !subtracted)?;
                flipped.rotate_left(first);
                Some(Self::Sum(flipped))
            }
            Self::Product(factors) => {
                let (at, flipped) = factors
                    .iter()
                    .enumerate()
                    .find_map(|(at, factor)| Some((at, factor.flipped()?)))?;
                let factors = factors.iter().cloned();
                let mut factors: Vec<Self> = factors.map(Self::polished).collect();
                factors[at] = flipped;
                Some(Self::Product(factors))
            }
            _ => None,
        }
    }
}

/// Takes out terms that are added and subtracted.
fn cancel(signed: &mut Vec<(bool, Node)>) {
    let mut place = 0;
    while let Some((minus, term)) = signed.get(place) {
        let opposite = |(other, same): &(bool, Node)| other != minus && same == term;
        match signed[place + 1..].iter().position(opposite) {
            Some(after) => {
                signed.remove(place + 1 + after);
                signed.remove(place);
            }
            None => place += 1,
        }
    }
}

fn push_term(signed: &mut Vec<(bool, Node)>, minus: bool, term: Node) {
    match term {
        Node::Negative(inner) => push_term(signed, !minus, *inner),
        Node::Sum(terms) => {
            for (subtracted, inner) in terms {
                push_term(signed, minus ^ subtracted, inner);
            }
        }
        zero if zero.is_zero() => {}
        other => signed.push((minus, other)),
    }
}

/// A product taken apart.
#[derive(Default)]
struct Parts {
    negative: bool,
    above: Vec<Node>,
    below: Vec<Node>,
}

impl Parts {
    fn multiply(&mut self, factor: Node) {
        match factor {
            Node::Negative(inner) => {
                self.negative ^= true;
                self.multiply(*inner);
            }
            Node::Product(factors) => factors.into_iter().for_each(|factor| self.multiply(factor)),
            Node::Quotient(above, below) => {
                self.multiply(*above);
                self.divide(*below);
            }
            one if one.is_one() => {}
            other => self.above.push(other),
        }
    }

    /// Takes out what stands above and below.
    fn cancel(&mut self) {
        let Self { above, below, .. } = self;
        below.retain(
            |divisor| match above.iter().position(|factor| factor == divisor) {
                Some(place) => {
                    above.remove(place);
                    false
                }
                None => true,
            },
        );
    }

    fn divide(&mut self, divisor: Node) {
        match divisor {
            Node::Product(factors) => self.below.extend(factors),
            one if one.is_one() => {}
            other => self.below.push(other),
        }
    }
}
