//! Sums with what their rounding lost, of six operations each, become one operation each.

use crate::program::{Operand, Operation, Two};
use std::collections::HashMap;

/// Operations of such a sum.
const LENGTH: usize = 6;

/// Puts one operation in place of each such sum of which nothing but the sum and the loss is read, neither by other operations nor as a result.
pub fn joined(operations: &mut Vec<Operation>, results: &[(u32, Operand)]) {
    let mut uses: HashMap<u32, usize> = HashMap::new();
    let mut count = |row: u32| *uses.entry(row).or_default() += 1;
    operations
        .iter()
        .flat_map(Operation::read)
        .for_each(&mut count);
    for (_, result) in results {
        if let Operand::Row(row) = result {
            count(*row);
        }
    }
    let mut place = 0;
    while place < operations.len() {
        let found = operations[place..]
            .first_chunk()
            .and_then(|six| sum(six, &uses));
        if let Some(sum) = found {
            operations.splice(place..place + LENGTH, [sum]);
        }
        place += 1;
    }
}

/// The sum of six operations: s = a + b, d = a − s, e = s + d, f = a − e, g = b + d, f + g.
fn sum(six: &[Operation; LENGTH], uses: &HashMap<u32, usize>) -> Option<Operation> {
    let [first, second, third, fourth, fifth, last] = six;
    let (Two::Add, [a, b], s) = two(first)? else {
        return None;
    };
    let (Two::Subtract, of_second, d) = two(second)? else {
        return None;
    };
    let (Two::Add, of_third, e) = two(third)? else {
        return None;
    };
    let (Two::Subtract, of_fourth, f) = two(fourth)? else {
        return None;
    };
    let (Two::Add, of_fifth, g) = two(fifth)? else {
        return None;
    };
    let (Two::Add, of_last, lost) = two(last)? else {
        return None;
    };
    let is_sum = of_second == [a, s]
        && of_third == [s, d]
        && of_fourth == [a, e]
        && of_fifth == [b, d]
        && of_last == [f, g];
    let used = |row: u32| uses.get(&row).copied().unwrap_or_default();
    let is_alone = used(d) == 2 && [e, f, g].iter().all(|row| used(*row) == 1);
    (is_sum && is_alone).then_some(Operation::ExactSum([a, b], [s, lost]))
}

/// An operation of two rows.
fn two(operation: &Operation) -> Option<(Two, [u32; 2], u32)> {
    match operation {
        Operation::Two(what, [Operand::Row(a), Operand::Row(b)], to) => {
            Some((*what, [*a, *b], *to))
        }
        _ => None,
    }
}
