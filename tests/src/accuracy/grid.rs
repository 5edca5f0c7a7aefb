//! Small dense matrices of any arithmetic, and least squares in high precision.

use super::tracked::{Tracked, larger};
use super::wide::Wide;
use hamel_codegen::expr::{Number, Rational};

/// A matrix, row by row.
#[derive(Clone, Debug)]
pub struct Grid<T> {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    entries: Vec<T>,
}

impl<T: Clone> Grid<T> {
    /// The matrix with entry `(i, j)` from a function.
    pub fn from_fn(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> T) -> Self {
        let entries = (0..rows * columns).map(|n| entry(n / columns, n % columns));
        Self {
            rows,
            columns,
            entries: entries.collect(),
        }
    }

    /// The matrix with these entries, row by row.
    pub fn of_entries(rows: usize, columns: usize, entries: Vec<T>) -> Self {
        Self {
            rows,
            columns,
            entries,
        }
    }

    /// A column.
    pub fn column(entries: Vec<T>) -> Self {
        Self {
            rows: entries.len(),
            columns: 1,
            entries,
        }
    }

    /// Entry in row `i` and column `j`.
    pub fn at(&self, i: usize, j: usize) -> &T {
        &self.entries[i * self.columns + j]
    }

    /// All entries, row by row.
    pub fn entries(&self) -> &[T] {
        &self.entries
    }

    /// Entry by entry.
    pub fn map<U>(&self, f: impl Fn(&T) -> U) -> Grid<U> {
        Grid {
            rows: self.rows,
            columns: self.columns,
            entries: self.entries.iter().map(f).collect(),
        }
    }

    /// Matrices of as many columns, one below the other; at least one.
    pub fn below(parts: impl IntoIterator<Item = Self>) -> Self {
        let parts: Vec<Self> = parts.into_iter().collect();
        let columns = parts.first().map_or(0, |part| part.columns);
        let entries: Vec<T> = parts.into_iter().flat_map(|part| part.entries).collect();
        Self {
            rows: entries.len().checked_div(columns).unwrap_or_default(),
            columns,
            entries,
        }
    }

    /// So many rows from the first on.
    pub fn rows_of(&self, first: usize, count: usize) -> Self {
        Self::from_fn(count, self.columns, |i, j| self.at(first + i, j).clone())
    }

    /// Transpose.
    pub fn transpose(&self) -> Self {
        Self::from_fn(self.columns, self.rows, |i, j| self.at(j, i).clone())
    }
}

impl<T: Number> Grid<T> {
    /// Product; the inner dimension is at least 1.
    pub fn times(&self, other: &Self) -> Self {
        Self::from_fn(self.rows, other.columns, |i, j| {
            let first = self.at(i, 0).times(other.at(0, j));
            (1..self.columns).fold(first, |sum, k| {
                sum.plus(&self.at(i, k).times(other.at(k, j)))
            })
        })
    }

    /// Sum.
    pub fn plus(&self, other: &Self) -> Self {
        Self::from_fn(self.rows, self.columns, |i, j| {
            self.at(i, j).plus(other.at(i, j))
        })
    }

    /// Difference.
    pub fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negative())
    }

    /// `−self`.
    pub fn negative(&self) -> Self {
        let minus = Rational::from_integer((-1).into());
        self.map(|entry| entry.rational(&minus).times(entry))
    }
}

/// What the reference itself loses, relative to the largest factors of a product: 256 bits, less 106 for normal equations where
/// columns are 1e8 times apart (offsets in m, squared twice), less 10 for sums: 2⁻¹⁴⁰. Doubles see nothing of it.
const NOISE: f64 = 7e-43;

impl Grid<Tracked> {
    /// The values alone.
    pub fn values(&self) -> Grid<Wide> {
        self.map(|entry| entry.value)
    }

    /// `(AᵀA)⁻¹Aᵀ`, NaN where the rank drops.
    pub fn left_inverse(&self) -> Self {
        let inverse = self.values().left_inverse();
        inverse.map(|entry| Tracked::computed(*entry, 0.0))
    }

    /// The least-squares solution of `self · x = right` by `left`, the left inverse of `self`. An entry's scale is the largest
    /// change that one entry of `self` or `right` makes by an error of its own scale.
    pub fn solve_by(&self, left: &Self, right: &Self) -> Self {
        let x = left.values().times(&right.values());
        let gains = left.map(|entry| entry.scale);
        let sizes = x.map(|entry| entry.to_f64().abs());
        // Row r of the system is off by this much in column j.
        let shaken = Grid::from_fn(self.rows, right.columns, |r, j| {
            let of_matrix = (0..self.columns).map(|m| self.at(r, m).scale * sizes.at(m, j));
            of_matrix.fold(right.at(r, j).scale, larger)
        });
        let of_row = |i: usize| (0..left.columns).map(|r| *gains.at(i, r)).fold(0.0, larger);
        let of_column = |j: usize| {
            (0..right.rows)
                .map(|r| right.at(r, j).scale)
                .fold(0.0, larger)
        };
        Self::from_fn(x.rows, x.columns, |i, j| {
            let noise = NOISE * of_row(i) * of_column(j);
            let moved = (0..self.rows).map(|r| gains.at(i, r) * shaken.at(r, j));
            Tracked::computed(*x.at(i, j), moved.fold(noise, larger))
        })
    }

    /// The inverse of a square matrix, scales as in [`Grid::solve_by`].
    pub fn inverse(&self) -> Self {
        let identity = Self::from_fn(self.rows, self.rows, |i, j| {
            Tracked::input(f64::from(u8::from(i == j)))
        });
        self.solve_by(&self.left_inverse(), &identity)
    }
}

impl Grid<Wide> {
    /// Product; the inner dimension is at least 1.
    pub fn times(&self, other: &Self) -> Self {
        Self::from_fn(self.rows, other.columns, |i, j| {
            (0..self.columns).fold(Wide::ZERO, |sum, k| sum + *self.at(i, k) * *other.at(k, j))
        })
    }

    /// `(AᵀA)⁻¹Aᵀ`, NaN where the rank drops.
    pub fn left_inverse(&self) -> Self {
        let transposed = self.transpose();
        solve(transposed.times(self), transposed)
    }
}

/// Gauss elimination with row pivoting of a square system.
fn solve(mut a: Grid<Wide>, mut b: Grid<Wide>) -> Grid<Wide> {
    let size = a.rows;
    let width = b.columns;
    let mut inverses = vec![];
    for k in 0..size {
        let by_size = |&i: &usize, &j: &usize| a.at(i, k).compare_sizes(*a.at(j, k));
        let pivot = (k..size).max_by(by_size).unwrap_or(k);
        for j in 0..size {
            a.entries.swap(k * size + j, pivot * size + j);
        }
        for j in 0..width {
            b.entries.swap(k * width + j, pivot * width + j);
        }
        let inverse = a.at(k, k).recip();
        for i in (0..size).filter(|&i| i != k) {
            let factor = *a.at(i, k) * inverse;
            if factor.is_zero() {
                continue;
            }
            for j in k..size {
                a.entries[i * size + j] = *a.at(i, j) - factor * *a.at(k, j);
            }
            for j in 0..width {
                b.entries[i * width + j] = *b.at(i, j) - factor * *b.at(k, j);
            }
        }
        inverses.push(inverse);
    }
    Grid::from_fn(size, width, |i, j| *b.at(i, j) * inverses[i])
}
