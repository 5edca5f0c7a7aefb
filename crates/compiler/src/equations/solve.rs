//! Systems of equations on the graph, solved without a choice that would depend on numbers.

use crate::graph::Sym;
use num_traits::Zero;

/// The largest system that is solved by its adjugate.
const LARGEST: usize = 3;

/// What is left of a system.
struct Rest {
    rows: Vec<usize>,
    columns: Vec<usize>,
}

impl Rest {
    /// A row with one unknown, or with `of_columns` an unknown of one row: row and column.
    fn single(&self, matrix: &[Vec<Sym>], of_columns: bool) -> Option<(usize, usize)> {
        let entries = |i: usize, j: usize| match of_columns {
            false => (i, j),
            true => (j, i),
        };
        let (lines, others) = match of_columns {
            false => (&self.rows, &self.columns),
            true => (&self.columns, &self.rows),
        };
        lines.iter().find_map(|&line| {
            let places = others.iter().map(|&other| entries(line, other));
            let mut filled = places.filter(|&(i, j)| !matrix[i][j].is_zero());
            let first = filled.next()?;
            filled.next().is_none().then_some(first)
        })
    }

    fn without(&mut self, (row, column): (usize, usize)) {
        self.rows.retain(|&i| i != row);
        self.columns.retain(|&j| j != column);
    }
}

/// `X` with `matrix · X = right`, both by rows: by substitution as far as that goes, then up to three unknowns by the adjugate, and more by orthogonal columns.
pub fn square(matrix: &[Vec<Sym>], right: &[Vec<Sym>]) -> Vec<Vec<Sym>> {
    let size = matrix.len();
    let width = right.first().map_or(0, Vec::len);
    let mut right = right.to_vec();
    let mut solution = vec![vec![Sym::zero(); width]; size];
    let mut rest = Rest {
        rows: (0..size).collect(),
        columns: (0..size).collect(),
    };
    let mut postponed: Vec<(usize, usize, Vec<usize>)> = vec![];
    loop {
        if let Some((row, column)) = rest.single(matrix, false) {
            rest.without((row, column));
            solution[column] = over(&right[row], matrix[row][column]);
            for &other in &rest.rows {
                subtract(&mut right[other], matrix[other][column], &solution[column]);
            }
        } else if let Some((row, column)) = rest.single(matrix, true) {
            rest.without((row, column));
            postponed.push((row, column, rest.columns.clone()));
        } else {
            break;
        }
    }
    match rest.rows.len() > LARGEST {
        true => by_columns(matrix, &right, &rest, &mut solution),
        false => together(matrix, &right, &rest, &mut solution),
    }
    for (row, column, others) in postponed.into_iter().rev() {
        for other in others {
            let known = solution[other].clone();
            subtract(&mut right[row], matrix[row][other], &known);
        }
        solution[column] = over(&right[row], matrix[row][column]);
    }
    solution
}

fn over(row: &[Sym], divisor: Sym) -> Vec<Sym> {
    row.iter().map(|&entry| entry / divisor).collect()
}

fn subtract(row: &mut [Sym], factor: Sym, other: &[Sym]) {
    for (entry, &other) in row.iter_mut().zip(other) {
        *entry -= factor * other;
    }
}

/// Solves what is left by the adjugate.
fn together(matrix: &[Vec<Sym>], right: &[Vec<Sym>], rest: &Rest, solution: &mut [Vec<Sym>]) {
    let size = rest.rows.len();
    let at = |i: usize, j: usize| matrix[rest.rows[i % size]][rest.columns[j % size]];
    // Cyclic indices make the signs of 3×3 minors come out by themselves.
    let cofactor = |i: usize, j: usize| match (size, i == j) {
        (1, _) => Sym::Number(1.0),
        (2, true) => at(i + 1, j + 1),
        (2, false) => -at(i + 1, j + 1),
        _ => at(i + 1, j + 1) * at(i + 2, j + 2) - at(i + 1, j + 2) * at(i + 2, j + 1),
    };
    if size == 0 {
        return;
    }
    let determinant: Sym = (0..size).map(|j| at(0, j) * cofactor(0, j)).sum();
    let inverse = Sym::Number(1.0) / determinant;
    for (j, &column) in rest.columns.iter().enumerate() {
        let weights: Vec<Sym> = (0..size).map(|i| cofactor(i, j) * inverse).collect();
        let entry = |k: usize| {
            let terms = weights.iter().zip(&rest.rows);
            terms.map(|(&weight, &row)| weight * right[row][k]).sum()
        };
        solution[column] = (0..solution[column].len()).map(entry).collect();
    }
}

/// Solves what is left by columns that are made orthogonal one after the other (Gram and Schmidt, modified), those of few entries first, and the right sides with them.
///
/// An elimination would have to choose pivots by numbers: one that is good at one state is 0 at another. Lengths of columns are 0 where the matrix is singular alone, and the
/// solution is that of a system that differs from this by rounding, as with reflections.
fn by_columns(matrix: &[Vec<Sym>], right: &[Vec<Sym>], rest: &Rest, solution: &mut [Vec<Sym>]) {
    let own =
        |column: usize| -> Vec<Sym> { rest.rows.iter().map(|&i| matrix[i][column]).collect() };
    let filled = |column: &usize| own(*column).iter().filter(|entry| !entry.is_zero()).count();
    let mut order = rest.columns.clone();
    order.sort_by_key(filled);
    let width = order.first().map_or(0, |&column| solution[column].len());
    let sides = (0..width).map(|k| rest.rows.iter().map(|&i| right[i][k]).collect());
    let mut columns: Vec<Vec<Sym>> = order.iter().map(|&j| own(j)).chain(sides).collect();
    let mut shares: Vec<Vec<Sym>> = vec![];
    for k in 0..order.len() {
        let (done, later) = columns.split_at_mut(k + 1);
        let inverse = Sym::Number(1.0) / product(&done[k], &done[k]);
        let share = later.iter_mut().map(|column| {
            let share = product(&done[k], column) * inverse;
            subtract(column, share, &done[k]);
            share
        });
        shares.push(share.collect());
    }
    for (k, &column) in order.iter().enumerate().rev() {
        let (after, sought) = shares[k].split_at(order.len() - k - 1);
        let mut row = sought.to_vec();
        for (&share, &other) in after.iter().zip(&order[k + 1..]) {
            subtract(&mut row, share, &solution[other]);
        }
        solution[column] = row;
    }
}

fn product(a: &[Sym], b: &[Sym]) -> Sym {
    a.iter().zip(b).map(|(&a, &b)| a * b).sum()
}

/// `M⁻¹ x` of a symmetric positive definite matrix, as `L D Lᵀ`.
pub fn definite(mut matrix: Vec<Vec<Sym>>, mut x: Vec<Sym>) -> Vec<Sym> {
    let size = x.len();
    let mut inverses = vec![Sym::zero(); size];
    for k in 0..size {
        inverses[k] = Sym::Number(1.0) / matrix[k][k];
        let column: Vec<Sym> = matrix.iter().map(|row| row[k]).collect();
        for i in k + 1..size {
            let factor = column[i] * inverses[k];
            let row = matrix[i][k + 1..=i].iter_mut();
            for (entry, &other) in row.zip(&column[k + 1..]) {
                *entry -= factor * other;
            }
            let less = factor * x[k];
            x[i] -= less;
        }
    }
    for k in (0..size).rev() {
        let carried: Sym = (k + 1..size).map(|i| matrix[i][k] * x[i]).sum();
        x[k] = (x[k] - carried) * inverses[k];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::square;
    use crate::graph::{Sym, record};
    use nalgebra::{DMatrix, DVector};

    /// As numbers, which are folded as they arise.
    fn solved(matrix: &DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
        let rows = |of: &DMatrix<f64>| -> Vec<Vec<Sym>> {
            let rows = of.row_iter();
            rows.map(|row| row.iter().map(|&entry| Sym::from(entry)).collect())
                .collect()
        };
        let right = DMatrix::from_columns(std::slice::from_ref(right));
        let (solution, _) = record(|| square(&rows(matrix), &rows(&right)));
        let numbers = solution.concat().into_iter().map(Sym::number);
        DVector::from_vec(numbers.map(|number| number.expect("a number")).collect())
    }

    /// The system that a solution solves differs from the one that was given by a few roundings of its entries, however near to singular that is.
    #[test]
    fn solutions_are_those_of_a_system_nearby() {
        for size in 1..=8 {
            for near in [1.0, 1e-3, 1e-8] {
                let entry = |i: usize, j: usize| {
                    let x = (3 * i + 5 * j) as f64;
                    (0.4 + 1.3 * x * x + 0.7 * j as f64).sin()
                };
                let mut matrix = DMatrix::from_fn(size, size, entry);
                if size > 3 {
                    // Two columns that nearly are one, and zeros where an elimination would divide first.
                    let others = matrix.column(1) * near + matrix.column(2);
                    matrix.set_column(1, &others);
                    (0..size - 1).for_each(|i| matrix[(i, i)] = 0.0);
                }
                let right = DVector::from_fn(size, |i, _| (0.3 + i as f64).cos());
                let found = solved(&matrix, &right);
                let left = (&matrix * &found - &right).norm();
                let terms = matrix.norm() * found.norm();
                assert!(
                    left < 10.0 * f64::EPSILON * terms,
                    "{size}, {near:e}: {left:e}"
                );
            }
        }
    }
}
