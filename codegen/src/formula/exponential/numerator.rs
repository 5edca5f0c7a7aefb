//! Terms with exponentials over a common denominator, as they are written.

use super::sums::{Sum, Sums, power};
use super::term::{Key, Terms};
use crate::expr::{Expr, Monomial, Rational};
use num_traits::One;
use std::collections::BTreeMap;

/// Most terms over a common denominator: what would be longer is left as it stands.
const MOST_TERMS: usize = 400;
/// Most ways tried to divide an exponent among the sums below the fraction line.
const MOST_TRIES: usize = 2000;

/// The expression, whose groups are opened, as it is written.
pub fn written(sums: &mut Sums, expression: &Expr) -> Expr {
    let terms = Terms::new(sums, expression);
    let terms = over_common_denominator(sums, terms);
    paired(&terms, &|key| in_range(sums, key))
}

/// The same with the lowest power of each sum in every term, which the others are multiplied up to.
pub fn over_common_denominator(sums: &Sums, terms: Terms) -> Terms {
    let mut lowest: BTreeMap<usize, i32> = BTreeMap::new();
    for (number, power) in terms.0.keys().flat_map(|key| &key.powers) {
        let lowest = lowest.entry(*number).or_default();
        *lowest = (*lowest).min(*power);
    }
    let mut whole = Terms::default();
    for (key, coefficient) in &terms.0 {
        let mut key = key.clone();
        let mut product = Terms::one();
        for (number, lowest) in &lowest {
            let above = key.powers.get(number).copied().unwrap_or(0) - lowest;
            for _ in 0..above / 2 {
                product = product.times(&sums.sum(*number).terms);
                if whole.0.len() + product.0.len() > MOST_TERMS {
                    return terms;
                }
            }
            key.powers.insert(*number, lowest + above % 2);
        }
        key.powers.retain(|_, power| *power != 0);
        let single = Terms(BTreeMap::from([(key, coefficient.clone())]));
        whole = whole.plus(&product.times(&single));
    }
    whole
}

/// The sum of the terms, each `value` times its coefficient; differences of exponentials as products with a tangent.
pub fn paired(terms: &Terms, value: &impl Fn(&Key) -> Expr) -> Expr {
    let mut left: Vec<(&Key, &Rational)> = terms.0.iter().collect();
    let mut sum = Expr::zero();
    while let Some((key, coefficient)) = left.pop() {
        let is_opposite = |(other, number): &(&Key, &Rational)| {
            other.rest == key.rest && other.powers == key.powers && **number == -coefficient
        };
        let term = match left.iter().position(is_opposite) {
            None => value(key),
            Some(place) => {
                let (other, _) = left.remove(place);
                let half = Rational::new(1.into(), 2.into());
                let distance = &key.exponent - &other.exponent;
                let tangent = distance.scaled(&half, &Monomial::one()).tanh();
                &(&value(key) + &value(other)) * &tangent
            }
        };
        sum += &term.scaled(coefficient, &Monomial::one());
    }
    sum
}

/// A term as a product of factors that are in range, or of one exponential with such.
fn in_range(sums: &Sums, key: &Key) -> Expr {
    let slots = slots(sums, key);
    let divided = divided(&slots, &key.exponent).or_else(|| growing(&slots, &key.exponent));
    let exponentials = divided.unwrap_or_else(|| sums.exponent(key).exp());
    product(sums, key, &exponentials)
}

/// The term with its exponentials and the scales of its sums given.
pub fn product(sums: &Sums, key: &Key, exponentials: &Expr) -> Expr {
    let start = &Expr::term(Rational::one(), key.rest.clone()) * exponentials;
    let powers = key.powers.iter();
    powers.fold(start, |product, (number, halves)| {
        &product * &power(&sums.sum(*number).scaled, *halves)
    })
}

/// A sum below the fraction line, once for each power, with 2; with 1 for a root.
type Slot<'a> = (&'a Sum, i64);

/// The sums below the fraction line; none where some stand above.
fn slots<'a>(sums: &'a Sums, key: &Key) -> Vec<Slot<'a>> {
    let mut slots = vec![];
    for (number, halves) in &key.powers {
        if *halves > 0 {
            return vec![];
        }
        let sum = sums.sum(*number);
        slots.extend(std::iter::repeat_n(
            (sum, 2),
            halves.unsigned_abs() as usize / 2,
        ));
        slots.extend((halves % 2 != 0).then_some((sum, 1)));
    }
    slots
}

/// The exponential and the scales of the sums below as factors `e^(a − m)`, a an exponent of the sum with scale m: each is at most 1, and
/// stands in S′ too. `None` where the exponent is no sum of theirs.
fn divided(slots: &[Slot<'_>], exponent: &Expr) -> Option<Expr> {
    let chosen = choose(slots, exponent, 0, &mut 0)?;
    (!slots.is_empty()).then(|| factors(slots, &chosen))
}

/// The same with an exponential left over that grows: times factors that are 1 where it does, the largest of each sum. Exponents are
/// multiples of one.
fn growing(slots: &[Slot<'_>], exponent: &Expr) -> Option<Expr> {
    let (_, first) = exponent.leading()?;
    let direction = exponent.scaled(&first.abs().recip(), &Monomial::one());
    let multiple = |exponent: &Expr| match (exponent.leading(), direction.leading()) {
        (None, _) => Some(Rational::default()),
        (Some((_, number)), Some((_, unit))) => {
            let multiple = number / unit;
            (direction.scaled(&multiple, &Monomial::one()) == *exponent).then_some(multiple)
        }
        _ => None,
    };
    let largest = |(sum, _): &Slot<'_>| {
        let multiples = sum.exponents.iter().map(multiple);
        multiples.collect::<Option<Vec<_>>>()?.into_iter().max()
    };
    let multiples: Vec<Rational> = slots.iter().map(largest).collect::<Option<_>>()?;
    let along = |multiple: &Rational| direction.scaled(multiple, &Monomial::one());
    let chosen: Vec<Expr> = multiples.iter().map(along).collect();
    let used = slots.iter().zip(&chosen);
    let used: Expr = used.map(|((_, halves), of)| halves_of(of, *halves)).sum();
    let left = exponent - &used;
    let grows = multiple(&left).is_some_and(|multiple| !multiple.is_negative());
    (grows && !slots.is_empty()).then(|| &factors(slots, &chosen) * &left.exp())
}

fn factors(slots: &[Slot<'_>], chosen: &[Expr]) -> Expr {
    let factors = slots
        .iter()
        .zip(chosen)
        .map(|((sum, halves), exponent)| halves_of(&(exponent - &sum.scale), *halves).exp());
    factors.fold(Expr::one(), |product, factor| &product * &factor)
}

/// One exponent for each slot, which together are `whole`; slots of one sum in ascending order.
fn choose(slots: &[Slot<'_>], whole: &Expr, first: usize, tries: &mut usize) -> Option<Vec<Expr>> {
    let Some(((sum, halves), others)) = slots.split_first() else {
        return whole.is_zero().then(Vec::new);
    };
    for (place, exponent) in sum.exponents.iter().enumerate().skip(first) {
        *tries += 1;
        if *tries > MOST_TRIES {
            return None;
        }
        let rest = whole - &halves_of(exponent, *halves);
        let same = others
            .first()
            .is_some_and(|(next, size)| std::ptr::eq(*next, *sum) && size == halves);
        let next = if same { place } else { 0 };
        if let Some(mut chosen) = choose(others, &rest, next, tries) {
            chosen.insert(0, exponent.clone());
            return Some(chosen);
        }
    }
    None
}

fn halves_of(exponent: &Expr, halves: i64) -> Expr {
    exponent.scaled(&Rational::new(halves.into(), 2.into()), &Monomial::one())
}
