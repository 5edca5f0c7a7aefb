//! Small dense linear systems for Newton's method.

/// A pivot below this part of the largest one belongs to a redundant row: rows of relations are either independent at angles of
/// order 1, or dependent up to how far the point is from the manifold.
const SMALLEST_PIVOT: f64 = 1e-6;

/// The shortest `x` with `rows · x = right` for as many rows as are independent; the others are left alone.
///
/// Rows are orthogonalised one by one, the longest remainder first (Gram–Schmidt with row pivoting).
pub(super) fn shortest_solution(rows: Vec<Vec<f64>>, right: Vec<f64>) -> Vec<f64> {
    let mut solution = vec![0.0; rows.first().map_or(0, Vec::len)];
    let mut rest: Vec<(Vec<f64>, f64)> = rows.into_iter().zip(right).collect();
    let mut largest = 0.0;
    while let Some((row, value)) = take_longest(&mut rest) {
        let square = dot(&row, &row);
        let length = square.sqrt();
        largest = f64::max(largest, length);
        if length <= SMALLEST_PIVOT * largest || length == 0.0 || !length.is_finite() {
            break;
        }
        // `row` is orthogonal to all rows used before, so that what they have solved stays solved.
        for (x, entry) in solution.iter_mut().zip(&row) {
            *x += value / square * entry;
        }
        for (other, other_value) in &mut rest {
            let part = dot(other, &row) / square;
            *other_value -= part * value;
            for (entry, used) in other.iter_mut().zip(&row) {
                *entry -= part * used;
            }
        }
    }
    solution
}

fn take_longest(rows: &mut Vec<(Vec<f64>, f64)>) -> Option<(Vec<f64>, f64)> {
    let lengths: Vec<f64> = rows.iter().map(|(row, _)| dot(row, row)).collect();
    let longest = (0..rows.len()).max_by(|&a, &b| lengths[a].total_cmp(&lengths[b]))?;
    Some(rows.swap_remove(longest))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
