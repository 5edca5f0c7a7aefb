//! The search for a shorter sum: multiples of relations that are subtracted one after the other.

use super::laurent::{Product, Relation, Sum, over, times};
use crate::expr::{Rational, budget};
use num_traits::{One, Zero};
use rustc_hash::{FxHashMap, FxHashSet};

/// A multiple of a relation: its number, the product, and the coefficient.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Multiple {
    relation: usize,
    product: Product,
    coefficient: Rational,
}

/// Most multiples that one division subtracts.
const LONGEST_DIVISION: usize = 64;

/// The sum with the multiples of the relations that shorten it most, one after the other, until none does.
pub fn shortened(mut sum: Sum, relations: &[Relation]) -> Sum {
    let floor = lowest_powers(&sum);
    loop {
        if let Some(shorter) = best_division(&sum, relations, &floor) {
            sum = shorter;
        } else if let Some(multiple) = best(&sum, relations, &floor) {
            subtract(&mut sum, relations, &multiple);
        } else {
            return sum;
        }
        if budget::is_exhausted() {
            return sum;
        }
    }
}

fn subtract(sum: &mut Sum, relations: &[Relation], multiple: &Multiple) {
    for (product, coefficient) in relations[multiple.relation].sum.iter() {
        let change = -(coefficient * &multiple.coefficient);
        budget::spend(1 + change.excess());
        sum.add(times(product, &multiple.product), change);
    }
}

/// The shortest remainder of dividing the sum by one of the relations, with any of its terms as the leading one: what is a polynomial in
/// `a + b + c` becomes one in its name at once, which single multiples may miss. None where no remainder is shorter than the sum.
fn best_division(sum: &Sum, relations: &[Relation], floor: &FxHashMap<u16, i16>) -> Option<Sum> {
    let mut least = length(sum);
    let mut best = None;
    for relation in 0..relations.len() {
        let terms = relations[relation].sum.len() as u64;
        budget::spend(terms * terms / 8);
        for lead in leads(&relations[relation].sum) {
            if let Some(remainder) = remainder(sum, relations, relation, lead, floor)
                && length(&remainder) < least
                && is_whole(sum, &remainder, relations[relation].defined)
            {
                least = length(&remainder);
                best = Some(remainder);
            }
        }
    }
    best
}

/// Whether a name stands for whole sums: what is new in the remainder holds it, unless all that it replaces did, as where a sum is divided by its square.
fn is_whole(before: &Sum, after: &Sum, defined: Option<u16>) -> bool {
    let Some(defined) = defined else {
        return true;
    };
    let holds = |product: &Product| product.iter().any(|(variable, _)| *variable == defined);
    let is_old = |product: &Product, number: &Rational| before.get(product) == Some(number);
    let mut replaced = before
        .iter()
        .filter(|(product, number)| after.get(*product) != Some(number));
    if replaced.all(|(product, _)| holds(product)) {
        return true;
    }
    after
        .iter()
        .all(|(product, number)| holds(product) || is_old(product, number))
}

/// The terms of a relation that divide none of the others: a division by one of those would not end.
fn leads(relation: &Sum) -> impl Iterator<Item = &Product> {
    let divides = |a: &Product, b: &Product| over(b, a).iter().all(|(_, power)| *power > 0);
    relation.keys().filter(move |lead| {
        let mut others = relation.keys().filter(|other| other != lead);
        !others.any(|other| divides(lead, other))
    })
}

/// What is left where every multiple of the leading term is replaced; none where that takes fewer than two or too many steps.
fn remainder(
    sum: &Sum,
    relations: &[Relation],
    relation: usize,
    lead: &Product,
    floor: &FxHashMap<u16, i16>,
) -> Option<Sum> {
    let divisible = |term: &&Product| !is_below(&over(term, lead), floor);
    budget::spend(sum.len() as u64 / 4);
    sum.keys().filter(divisible).nth(1)?;
    let (mut rest, mut steps) = (sum.clone(), 0);
    while let Some((product, factor)) = first_divided(&rest, lead, floor) {
        let coefficient = &factor / &relations[relation].sum[lead];
        let multiple = Multiple {
            relation,
            product,
            coefficient,
        };
        subtract(&mut rest, relations, &multiple);
        // What is divisible is looked for from the first term on.
        budget::spend(relations[relation].sum.len() as u64 + rest.len() as u64 / 4);
        steps += 1;
        if steps > LONGEST_DIVISION || budget::is_exhausted() {
            return None;
        }
    }
    (steps > 1).then_some(rest)
}

/// The quotient by the leading term of the first term that it divides, and the coefficient of that.
fn first_divided(
    sum: &Sum,
    lead: &Product,
    floor: &FxHashMap<u16, i16>,
) -> Option<(Product, Rational)> {
    sum.iter().find_map(|(term, factor)| {
        let product = over(term, lead);
        (!is_below(&product, floor)).then(|| (product, factor.clone()))
    })
}

/// Operations to write the sum term by term.
fn length(sum: &Sum) -> i64 {
    sum.iter()
        .map(|(product, number)| cost(product, number))
        .sum()
}

/// Whether a power is lower than the sum has it: something more would be divided by.
fn is_below(product: &Product, floor: &FxHashMap<u16, i16>) -> bool {
    let low = |(variable, power): &(u16, i16)| *power < floor.get(variable).copied().unwrap_or(0);
    product.iter().any(low)
}

/// The lowest power of each variable in the sum, where it is negative.
fn lowest_powers(sum: &Sum) -> FxHashMap<u16, i16> {
    let mut lowest = FxHashMap::default();
    for &(variable, power) in sum.keys().flatten().filter(|(_, power)| *power < 0) {
        let known: &mut i16 = lowest.entry(variable).or_default();
        *known = power.min(*known);
    }
    lowest
}

/// The multiple that shortens the sum most, when it is subtracted; none where none shortens it.
fn best(sum: &Sum, relations: &[Relation], floor: &FxHashMap<u16, i16>) -> Option<Multiple> {
    let present: FxHashSet<&Product> = sum.keys().collect();
    let mut seen = FxHashSet::default();
    let mut best: Option<(i64, Multiple)> = None;
    for (term, factor) in sum.iter() {
        for (
            relation,
            Relation {
                sum: terms,
                defined,
            },
        ) in relations.iter().enumerate()
        {
            for (part, coefficient) in terms.iter() {
                let product = over(term, part);
                budget::spend(1);
                if is_below(&product, floor) || !covers_half(&present, terms, &product) {
                    continue;
                }
                let coefficient = factor / coefficient;
                let multiple = Multiple {
                    relation,
                    product,
                    coefficient,
                };
                if !seen.insert(multiple.clone()) {
                    continue;
                }
                let gain = gain(sum, terms, &multiple, *defined);
                if gain > 0 && best.as_ref().is_none_or(|(most, _)| gain > *most) {
                    best = Some((gain, multiple));
                }
            }
        }
        if budget::is_exhausted() {
            return None;
        }
    }
    best.map(|(_, multiple)| multiple)
}

/// Whether at least half of the relation's terms are in the sum, once multiplied: else more come than go.
fn covers_half(present: &FxHashSet<&Product>, relation: &Sum, factor: &Product) -> bool {
    budget::spend(relation.len() as u64 / 2);
    let is_found = |part: &&Product| present.contains(&times(part, factor));
    let needed = relation.len().div_ceil(2);
    relation.keys().filter(is_found).take(needed).count() == needed
}

/// The operations that subtracting the multiple saves; none where a name would stand for a part of its sum: of five terms it may lack one.
fn gain(sum: &Sum, relation: &Sum, multiple: &Multiple, defined: Option<u16>) -> i64 {
    let (mut saved, mut lacking) = (0, 0);
    for (part, coefficient) in relation.iter() {
        let product = times(part, &multiple.product);
        let before = sum.get(&product);
        let change = coefficient * &multiple.coefficient;
        let after = match before {
            Some(before) => before - &change,
            None => -change,
        };
        let is_name = defined.is_none_or(|name| part.iter().any(|(v, _)| *v == name));
        lacking += usize::from(!is_name && !after.is_zero());
        saved += before.map_or(0, |before| cost(&product, before));
        saved -= match after.is_zero() {
            true => 0,
            false => cost(&product, &after),
        };
    }
    match 5 * lacking < relation.len() {
        true => saved,
        false => 0,
    }
}

/// Operations for one more term: an addition, and a multiplication for each factor.
fn cost(product: &Product, coefficient: &Rational) -> i64 {
    let powers = product.iter().map(|(_, power)| i64::from(power.abs()));
    1 + powers.sum::<i64>() + i64::from(!coefficient.abs().is_one())
}
