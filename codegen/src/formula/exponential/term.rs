//! Terms of sums with exponentials: one exponent each, and half powers of sums of exponentials.

use super::power_of_sum;
use super::sums::Sums;
use crate::expr::{Atom, Expr, Function, Monomial, Rational};
use num_traits::{One, Zero};
use std::collections::BTreeMap;

/// What terms that are added up have in common.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    /// Twice the powers of the sums, by their numbers; none is 0.
    pub powers: BTreeMap<usize, i32>,
    /// Factors without exponentials.
    pub rest: Monomial,
    /// The exponent of e.
    pub exponent: Expr,
}

/// A sum of terms.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Terms(pub BTreeMap<Key, Rational>);

impl Key {
    fn times(&self, other: &Self) -> Self {
        let mut powers = self.powers.clone();
        for (sum, power) in &other.powers {
            *powers.entry(*sum).or_default() += power;
        }
        powers.retain(|_, power| *power != 0);
        Self {
            powers,
            rest: self.rest.times(&other.rest),
            exponent: &self.exponent + &other.exponent,
        }
    }
}

impl Terms {
    /// The terms of an expression without groups of exponentials; hyperbolic functions are exponentials here.
    pub fn new(sums: &mut Sums, expression: &Expr) -> Self {
        let mut terms = Self::default();
        for (monomial, coefficient) in by_exponentials(expression).terms() {
            let mut key = Key::default();
            let rest = monomial.factors().filter(|(atom, power)| {
                let Atom::Apply(application) = atom else {
                    return true;
                };
                if application.function == Function::Exp {
                    let argument = application.arguments.iter().cloned().sum::<Expr>();
                    key.exponent +=
                        &argument.scaled(&Rational::from(i64::from(*power)), &Monomial::one());
                    return false;
                }
                let Some((sum, halves)) = power_of_sum(atom) else {
                    return true;
                };
                for (number, times) in sums.factors(sum) {
                    *key.powers.entry(number).or_default() += halves * times * power;
                }
                false
            });
            key.rest = Monomial::of_factors(rest.collect::<Vec<_>>());
            key.powers.retain(|_, power| *power != 0);
            terms.add(key, coefficient);
        }
        terms
    }

    /// The terms without the whole powers of sums that all of them are divided by, and those powers.
    pub fn without_common_powers(self) -> (Self, Vec<(usize, i32)>) {
        let lowest = |number: &usize| {
            let powers = self.0.keys().map(|key| key.powers.get(number).copied());
            powers.map(Option::unwrap_or_default).max().unwrap_or(0)
        };
        let first = self.0.keys().next();
        let numbers = first.into_iter().flat_map(|key| key.powers.keys());
        let common = numbers.map(|number| (*number, lowest(number) / 2));
        let common: Vec<(usize, i32)> = common.filter(|(_, power)| *power < 0).collect();
        let mut terms = Self::default();
        for (mut key, coefficient) in self.0.clone() {
            for (number, power) in &common {
                *key.powers.entry(*number).or_default() -= 2 * power;
            }
            key.powers.retain(|_, power| *power != 0);
            terms.add(key, &coefficient);
        }
        (terms, common)
    }

    fn add(&mut self, key: Key, coefficient: &Rational) {
        let sum = self.0.entry(key.clone()).or_default();
        *sum += coefficient;
        if sum.is_zero() {
            self.0.remove(&key);
        }
    }

    /// The product.
    pub fn times(&self, other: &Self) -> Self {
        let mut product = Self::default();
        for (a, x) in &self.0 {
            for (b, y) in &other.0 {
                product.add(a.times(b), &(x * y));
            }
        }
        product
    }

    /// The sum.
    pub fn plus(mut self, other: &Self) -> Self {
        for (key, coefficient) in &other.0 {
            self.add(key.clone(), coefficient);
        }
        self
    }

    /// The number 1.
    pub fn one() -> Self {
        Self(BTreeMap::from([(Key::default(), Rational::one())]))
    }
}

/// Hyperbolic functions by exponentials.
fn by_exponentials(expression: &Expr) -> Expr {
    let half = Expr::fraction(1, 2);
    let value = |atom: Atom| {
        let Atom::Apply(application) = &atom else {
            return None;
        };
        let x = application.arguments.first()?;
        let (up, down) = (x.exp(), (-x).exp());
        let value = match application.function {
            Function::Sinh => &half * &(&up - &down),
            Function::Cosh => &half * &(&up + &down),
            Function::Sech => &Expr::integer(2) * &(&up + &down).recip()?,
            Function::Tanh => &(&up - &down) * &(&up + &down).recip()?,
            _ => return None,
        };
        Some((atom, value))
    };
    let values = expression.atoms().into_iter().filter_map(value);
    expression.replace_atoms(&values.collect())
}
