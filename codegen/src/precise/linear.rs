//! Small dense linear systems in high precision.

use super::Precise;
use std::cmp::Ordering;

/// A pivot below this part of the largest one belongs to a redundant row: rows of relations are either independent at angles of
/// order 1, or dependent up to how far the point is from the manifold.
const SMALLEST_PIVOT: f64 = 1e-6;

/// The shortest `x` with `rows · x = right` for as many rows as are independent; the others are left alone.
///
/// Rows are orthogonalised one by one, the longest remainder first (Gram–Schmidt with row pivoting, each row twice).
pub(super) fn shortest_solution(rows: &[Vec<Precise>], right: &[Precise]) -> Vec<Precise> {
    let Some(zero) = right.first().map(|value| value.same(0)) else {
        return vec![];
    };
    let mut rest: Vec<(Vec<Precise>, Precise)> =
        rows.iter().cloned().zip(right.iter().cloned()).collect();
    let mut solution = vec![zero; rows.first().map_or(0, Vec::len)];
    let mut largest = 0.0;
    while let Some((row, value)) = take_longest(&mut rest) {
        let square = dot(&row, &row);
        let length = square.to_f64().sqrt();
        largest = f64::max(largest, length);
        if length <= SMALLEST_PIVOT * largest || length == 0.0 || !length.is_finite() {
            break;
        }
        // `row` is orthogonal to all rows used before, so that what they have solved stays solved.
        let step = &value / &square;
        for (x, entry) in solution.iter_mut().zip(&row) {
            *x = &*x + &(&step * entry);
        }
        for (other, other_value) in &mut rest {
            let part = &dot(other, &row) / &square;
            *other_value = &*other_value - &(&part * &value);
            for (entry, used) in other.iter_mut().zip(&row) {
                *entry = &*entry - &(&part * used);
            }
        }
    }
    solution
}

fn take_longest(rows: &mut Vec<(Vec<Precise>, Precise)>) -> Option<(Vec<Precise>, Precise)> {
    let length = |(row, _): &(Vec<Precise>, Precise)| dot(row, row);
    let order = |a: &Precise, b: &Precise| a.compare(b).unwrap_or(Ordering::Equal);
    let lengths: Vec<Precise> = rows.iter().map(length).collect();
    let longest = (0..rows.len()).max_by(|&a, &b| order(&lengths[a], &lengths[b]))?;
    Some(rows.swap_remove(longest))
}

fn dot(a: &[Precise], b: &[Precise]) -> Precise {
    let Some(first) = a.first() else {
        return Precise::integer(0, 64);
    };
    a.iter()
        .zip(b)
        .fold(first.same(0), |sum, (x, y)| sum + x * y)
}
