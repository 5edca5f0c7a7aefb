//! Sums of terms whose powers may be negative, over numbered variables.

use crate::expr::{Atom, Expr, Function, Monomial, Rational, Symbol, Terms};
use num_traits::One;
use rustc_hash::FxHashMap;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// A product of powers of variables, ascending by variable; no power is 0.
pub(super) type Product = Vec<(u16, i16)>;

/// A sum of terms.
pub type Sum = Terms<Product>;

/// A sum that is 0.
pub struct Relation {
    /// The sum.
    pub sum: Sum,
    /// The variable that it defines, if it does: that stands for the other terms as a whole, never for some of them.
    pub defined: Option<u16>,
}

/// What a variable stands for.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Meaning {
    /// A symbol or a function; its negative powers are quotients.
    Atom(Atom),
    /// A sum with leading coefficient 1 that is divided by.
    Divisor(Expr),
}

/// The variables of one expression.
#[derive(Default)]
pub struct Ring {
    meanings: Vec<Meaning>,
    numbers: FxHashMap<Meaning, u16>,
    /// For a divisor that is the square of a root up to a factor: that root, and `divisor / root²`.
    roots: Vec<(Expr, Atom, Rational)>,
}

impl Ring {
    /// No variables yet; the quotient of what stands under one of these roots is a power of that root.
    pub fn of(functions: &BTreeSet<Atom>) -> Self {
        let mut ring = Self::default();
        for atom in functions {
            let Atom::Apply(application) = &atom else {
                continue;
            };
            let (Function::Sqrt, [square]) = (application.function, &application.arguments[..])
            else {
                continue;
            };
            if let Some((_, leading)) = square.leading().filter(|_| square.terms().len() > 1) {
                let monic = square.scaled(&leading.recip(), &Monomial::one());
                ring.roots.push((monic, atom.clone(), leading.recip()));
            }
        }
        ring
    }

    /// The expression over these variables.
    pub fn sum(&mut self, expression: &Expr) -> Sum {
        let mut sum = Sum::default();
        for (monomial, coefficient) in expression.terms() {
            let mut coefficient = coefficient.clone();
            let mut powers: BTreeMap<u16, i16> = BTreeMap::new();
            for (atom, power) in monomial.factors() {
                let (variable, power) = self.power(atom, power, &mut coefficient);
                *powers.entry(variable).or_default() += power;
            }
            let product = powers.into_iter().filter(|(_, power)| *power != 0);
            sum.add(product.collect(), coefficient);
        }
        sum
    }

    /// The variable of an atom and its power; quotients are negative powers of what they divide by.
    fn power(&mut self, atom: &Atom, power: i32, coefficient: &mut Rational) -> (u16, i16) {
        // Powers beyond this do not pass the bounds on expressions.
        let small = |power: i32| i16::try_from(power).unwrap_or(i16::MAX);
        let divisor = match atom {
            Atom::Apply(application) if application.function == Function::Recip => {
                &application.arguments[0]
            }
            _ => return (self.number(Meaning::Atom(atom.clone())), small(power)),
        };
        if let Some((_, root, scale)) = self.roots.iter().find(|(square, ..)| square == divisor) {
            // 1 / divisor = 1 / (scale root²).
            for _ in 0..power {
                *coefficient = &*coefficient * &scale.recip();
            }
            let root = Meaning::Atom(root.clone());
            return (self.number(root), small(-2 * power));
        }
        let single = divisor.single_term().and_then(|(m, c)| match m.main() {
            [(atom, 1)] if c.is_one() && m.units().is_empty() => Some(atom.clone()),
            _ => None,
        });
        let meaning = single.map_or_else(|| Meaning::Divisor(divisor.clone()), Meaning::Atom);
        (self.number(meaning), small(-power))
    }

    fn number(&mut self, meaning: Meaning) -> u16 {
        if let Some(known) = self.numbers.get(&meaning) {
            return *known;
        }
        let next = u16::try_from(self.meanings.len()).unwrap_or(u16::MAX);
        self.meanings.push(meaning.clone());
        self.numbers.insert(meaning, next);
        next
    }

    /// A relation, or what a symbol is defined as.
    pub fn relation(&mut self, relation: &Expr, defined: Option<&Symbol>) -> Relation {
        let sum = self.sum(relation);
        let symbol = defined.map(|symbol| Meaning::Atom(Atom::Symbol(symbol.clone())));
        Relation {
            sum,
            defined: symbol.map(|symbol| self.number(symbol)),
        }
    }

    /// `d − (its sum)` for each divisor d.
    pub fn definitions(&mut self) -> Vec<Relation> {
        let divisors: Vec<(u16, Expr)> = self
            .meanings
            .iter()
            .enumerate()
            .filter_map(|(number, meaning)| match meaning {
                Meaning::Divisor(sum) => Some((u16::try_from(number).ok()?, sum.clone())),
                Meaning::Atom(_) => None,
            })
            .collect();
        let definition = |(number, sum): (u16, Expr)| {
            let mut definition = self.sum(&sum);
            definition.add(vec![(number, 1)], -Rational::one());
            Relation {
                sum: definition,
                defined: Some(number),
            }
        };
        divisors.into_iter().map(definition).collect()
    }

    /// The sum as an expression.
    pub fn expression(&self, sum: &Sum) -> Expr {
        let term = |(product, coefficient): (&Product, &Rational)| {
            let start = Expr::rational(coefficient.clone());
            product.iter().fold(start, |value, &(variable, power)| {
                let base = match &self.meanings[usize::from(variable)] {
                    Meaning::Atom(atom) => Expr::atom(atom.clone()),
                    Meaning::Divisor(sum) => sum.clone(),
                };
                // Only what divides already has negative powers, and that is not 0.
                let base = match power < 0 {
                    true => base.recip().unwrap_or_default(),
                    false => base,
                };
                &value * &base.pow(u32::from(power.unsigned_abs()))
            })
        };
        sum.iter().map(term).sum()
    }
}

/// The product of two.
pub(super) fn times(a: &Product, b: &Product) -> Product {
    merged(a, b, 1)
}

/// The quotient of two.
pub(super) fn over(a: &Product, b: &Product) -> Product {
    merged(a, b, -1)
}

fn merged(a: &Product, b: &Product, sign: i16) -> Product {
    let mut merged = Product::with_capacity(a.len() + b.len());
    let (mut i, mut j) = (0, 0);
    while let (Some(&(variable, power)), Some(&(other, change))) = (a.get(i), b.get(j)) {
        match variable.cmp(&other) {
            Ordering::Less => merged.push((variable, power)),
            Ordering::Greater => merged.push((other, sign * change)),
            Ordering::Equal if power + sign * change != 0 => {
                merged.push((variable, power + sign * change));
            }
            Ordering::Equal => {}
        }
        i += usize::from(variable <= other);
        j += usize::from(other <= variable);
    }
    merged.extend(&a[i..]);
    merged.extend(
        b[j..]
            .iter()
            .map(|(variable, power)| (*variable, sign * power)),
    );
    merged
}
