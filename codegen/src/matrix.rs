//! Matrices of symbolic scalars.

use crate::expr::{Expr, Symbol};
use std::fmt::{Display, Formatter};

/// A dense matrix of expressions, stored row by row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Matrix {
    rows: usize,
    columns: usize,
    entries: Vec<Expr>,
}

impl Matrix {
    /// The matrix with entry `(i, j)` from a function.
    pub fn from_fn(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> Expr) -> Self {
        let entries = (0..rows * columns)
            .map(|n| entry(n / columns, n % columns))
            .collect();
        Self {
            rows,
            columns,
            entries,
        }
    }

    /// The matrix with the given entries, row by row; `None` where their number does not fit.
    pub fn from_entries(rows: usize, columns: usize, entries: Vec<Expr>) -> Option<Self> {
        (entries.len() == rows * columns).then_some(Self {
            rows,
            columns,
            entries,
        })
    }

    /// The column vector of the given entries.
    pub fn column_vector(entries: Vec<Expr>) -> Self {
        Self {
            rows: entries.len(),
            columns: 1,
            entries,
        }
    }

    /// The column vector of symbols.
    pub fn symbols(symbols: &[Symbol]) -> Self {
        Self::column_vector(symbols.iter().map(Expr::symbol).collect())
    }

    /// The matrix of integers, row by row.
    pub fn integers<const C: usize>(rows: &[[i64; C]]) -> Self {
        Self::from_fn(rows.len(), C, |i, j| Expr::integer(rows[i][j]))
    }

    /// Zero.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self::from_fn(rows, columns, |_, _| Expr::zero())
    }

    /// The identity.
    pub fn identity(size: usize) -> Self {
        Self::from_fn(size, size, |i, j| Expr::integer((i == j).into()))
    }

    /// The cross-product matrix of a 3-vector: `tilde(a) b = a × b`, (5).
    pub fn tilde(a: &[Expr]) -> Self {
        let zero = Expr::zero;
        let entries = vec![
            zero(),
            -&a[2],
            a[1].clone(),
            a[2].clone(),
            zero(),
            -&a[0],
            -&a[1],
            a[0].clone(),
            zero(),
        ];
        Self {
            rows: 3,
            columns: 3,
            entries,
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Rows and columns.
    pub fn shape(&self) -> (usize, usize) {
        (self.rows, self.columns)
    }

    /// Entry in row `i` and column `j`.
    pub fn at(&self, i: usize, j: usize) -> &Expr {
        &self.entries[i * self.columns + j]
    }

    /// The entries, row by row.
    pub fn entries(&self) -> &[Expr] {
        &self.entries
    }

    /// Column `j`.
    pub fn column(&self, j: usize) -> Vec<Expr> {
        (0..self.rows).map(|i| self.at(i, j).clone()).collect()
    }

    /// The block of `rows × columns` that starts at `(i, j)`.
    pub fn block(&self, i: usize, j: usize, rows: usize, columns: usize) -> Self {
        Self::from_fn(rows, columns, |r, c| self.at(i + r, j + c).clone())
    }

    /// The given rows, in that order.
    pub fn select_rows(&self, rows: &[usize]) -> Self {
        Self::from_fn(rows.len(), self.columns, |i, j| self.at(rows[i], j).clone())
    }

    /// The six rows of one body in a stack of twists.
    pub fn rows_of_body(&self, body: usize) -> Self {
        self.block(6 * body, 0, 6, self.columns)
    }

    /// Columns side by side.
    pub fn from_columns(rows: usize, columns: &[Vec<Expr>]) -> Self {
        Self::from_fn(rows, columns.len(), |i, j| columns[j][i].clone())
    }

    /// `self` above `other`.
    pub fn stack(&self, other: &Self) -> Self {
        let entries = self.entries.iter().chain(&other.entries).cloned().collect();
        Self {
            rows: self.rows + other.rows,
            columns: self.columns,
            entries,
        }
    }

    /// `self` to the left of `other`.
    pub fn beside(&self, other: &Self) -> Self {
        Self::from_fn(self.rows, self.columns + other.columns, |i, j| {
            match j < self.columns {
                true => self.at(i, j).clone(),
                false => other.at(i, j - self.columns).clone(),
            }
        })
    }

    /// Entry by entry.
    pub fn map(&self, f: impl FnMut(&Expr) -> Expr) -> Self {
        Self {
            rows: self.rows,
            columns: self.columns,
            entries: self.entries.iter().map(f).collect(),
        }
    }

    /// Transpose.
    pub fn transpose(&self) -> Self {
        Self::from_fn(self.columns, self.rows, |i, j| self.at(j, i).clone())
    }

    /// Product.
    pub fn times(&self, other: &Self) -> Self {
        Self::from_fn(self.rows, other.columns, |i, j| {
            (0..self.columns)
                .map(|k| self.at(i, k) * other.at(k, j))
                .sum()
        })
    }

    /// Sum.
    pub fn plus(&self, other: &Self) -> Self {
        Self::from_fn(self.rows, self.columns, |i, j| {
            self.at(i, j) + other.at(i, j)
        })
    }

    /// Difference.
    pub fn minus(&self, other: &Self) -> Self {
        Self::from_fn(self.rows, self.columns, |i, j| {
            self.at(i, j) - other.at(i, j)
        })
    }

    /// The matrix times a scalar.
    pub fn scale(&self, factor: &Expr) -> Self {
        self.map(|entry| entry * factor)
    }

    /// Sum of the diagonal.
    pub fn trace(&self) -> Expr {
        (0..self.rows.min(self.columns))
            .map(|i| self.at(i, i).clone())
            .sum()
    }

    /// Whether every entry is zero as it stands.
    pub fn is_zero(&self) -> bool {
        self.entries.iter().all(Expr::is_zero)
    }

    /// Whether this is the identity as it stands.
    pub fn is_identity(&self) -> bool {
        *self == Self::identity(self.rows)
    }

    /// Whether no entry depends on anything but parameters.
    pub fn is_constant(&self) -> bool {
        self.entries.iter().all(Expr::is_constant)
    }

    /// Partial derivative of each entry.
    pub fn derivative(&self, symbol: &Symbol) -> Self {
        self.map(|entry| entry.derivative(symbol))
    }

    /// The matrix without row `i` and column `j`.
    pub fn minor(&self, i: usize, j: usize) -> Self {
        let skip = |n: usize, removed: usize| n + usize::from(n >= removed);
        Self::from_fn(self.rows - 1, self.columns - 1, |r, c| {
            self.at(skip(r, i), skip(c, j)).clone()
        })
    }

    /// Determinant of a square matrix, each sub-determinant simplified by `simplify`.
    pub fn determinant(&self, simplify: &impl Fn(&Expr) -> Expr) -> Expr {
        if self.rows == 0 {
            return Expr::one();
        }
        // Expanding along the sparsest column keeps the number of sub-determinants small.
        let zeros = |j: &usize| {
            self.column(*j)
                .iter()
                .filter(|entry| entry.is_zero())
                .count()
        };
        let j = (0..self.columns)
            .max_by_key(|j| (zeros(j), self.columns - j))
            .unwrap_or(0);
        let expansion = (0..self.rows)
            .filter(|&i| !self.at(i, j).is_zero())
            .map(|i| {
                let product = self.at(i, j) * &self.minor(i, j).determinant(simplify);
                if (i + j) % 2 == 0 { product } else { -product }
            });
        simplify(&expansion.sum())
    }

    /// Transposed matrix of cofactors: `M adj(M) = det(M) I`.
    pub fn adjugate(&self, simplify: &impl Fn(&Expr) -> Expr) -> Self {
        Self::from_fn(self.rows, self.columns, |i, j| {
            let cofactor = self.minor(j, i).determinant(simplify);
            if (i + j) % 2 == 0 {
                cofactor
            } else {
                -cofactor
            }
        })
    }
}

impl Display for Matrix {
    /// As a spec writes it, rows on lines of their own, columns aligned.
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let texts: Vec<String> = self.entries.iter().map(Expr::to_string).collect();
        let width = |j: usize| {
            (0..self.rows)
                .map(|i| texts[i * self.columns + j].chars().count())
                .max()
                .unwrap_or(0)
        };
        for i in 0..self.rows {
            f.write_str(if i == 0 { "[" } else { ";\n " })?;
            for j in 0..self.columns {
                let text = &texts[i * self.columns + j];
                // Not by a width of the format: that ends at 65535.
                let gap = " ".repeat(width(j) - text.chars().count());
                let comma = if j == 0 { "" } else { ", " };
                write!(f, "{comma}{gap}{text}")?;
            }
        }
        f.write_str("]")
    }
}

/// All ways to choose `size` of `0..count`, ascending.
pub fn combinations(count: usize, size: usize) -> Vec<Vec<usize>> {
    if size == 0 {
        return vec![vec![]];
    }
    (size - 1..count)
        .flat_map(|last| {
            combinations(last, size - 1)
                .into_iter()
                .map(move |mut chosen| {
                    chosen.push(last);
                    chosen
                })
        })
        .collect()
}

/// How many there are, or the largest number where they are more.
pub fn count_combinations(count: usize, size: usize) -> usize {
    let factors = (0..size.min(count)).map(|n| (count - n, n + 1));
    factors.fold(1, |all: usize, (above, below)| {
        all.checked_mul(above).map_or(usize::MAX, |all| all / below)
    })
}

#[cfg(test)]
mod tests {
    use super::Matrix;
    use crate::expr::{Expr, Role, Symbol};

    /// A format's width ends at 65 535, which long entries exceed.
    #[test]
    fn entries_of_any_length_are_aligned() {
        let x = |n: usize| Expr::symbol(&Symbol::new(Role::Coordinate, n, &format!("x{n}")));
        let long: Expr = (0..12_000).map(x).sum();
        let shown = Matrix::from_fn(2, 1, |i, _| match i {
            0 => long.clone(),
            _ => x(0),
        })
        .to_string();
        let lines: Vec<usize> = shown.lines().map(|line| line.chars().count()).collect();
        assert!(lines[0] > 65_536, "{lines:?}");
        assert_eq!(lines[0], lines[1]);
    }
}
