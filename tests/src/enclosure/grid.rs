//! Matrices of jets.

use super::ball::Ball;
use super::jet::Jet;

/// A matrix, row by row.
#[derive(Clone, Debug)]
pub struct Grid {
    pub rows: usize,
    pub columns: usize,
    pub entries: Vec<Jet>,
}

impl Grid {
    pub fn new(rows: usize, columns: usize, entries: Vec<Jet>) -> Self {
        Self {
            rows,
            columns,
            entries,
        }
    }

    pub fn from_fn(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> Jet) -> Self {
        let places = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
        Self::new(rows, columns, places.map(|(i, j)| entry(i, j)).collect())
    }

    pub fn identity(size: usize) -> Self {
        Self::from_fn(size, size, |i, j| {
            Jet::constant(if i == j { Ball::one() } else { Ball::zero() })
        })
    }

    pub fn column(entries: Vec<Jet>) -> Self {
        Self::new(entries.len(), 1, entries)
    }

    pub fn at(&self, i: usize, j: usize) -> &Jet {
        &self.entries[i * self.columns + j]
    }

    pub fn map(&self, f: impl Fn(&Jet) -> Jet) -> Self {
        Self::new(
            self.rows,
            self.columns,
            self.entries.iter().map(f).collect(),
        )
    }

    /// The derivative by variable `k` alone.
    pub fn slope(&self, k: usize) -> Self {
        self.map(|entry| Jet::constant(entry.slope(k)))
    }

    /// The values alone.
    pub fn values(&self) -> Self {
        self.map(|entry| Jet::constant(entry.value.clone()))
    }

    pub fn transpose(&self) -> Self {
        Self::from_fn(self.columns, self.rows, |i, j| self.at(j, i).clone())
    }

    pub fn times(&self, other: &Self) -> Self {
        Self::from_fn(self.rows, other.columns, |i, j| {
            let zero = Jet::constant(Ball::zero());
            (0..self.columns).fold(zero, |sum, k| {
                sum.plus(&self.at(i, k).times(other.at(k, j)))
            })
        })
    }

    pub fn plus(&self, other: &Self) -> Self {
        Self::from_fn(self.rows, self.columns, |i, j| {
            self.at(i, j).plus(other.at(i, j))
        })
    }

    pub fn minus(&self, other: &Self) -> Self {
        Self::from_fn(self.rows, self.columns, |i, j| {
            self.at(i, j).minus(other.at(i, j))
        })
    }

    /// Columns beside each other.
    pub fn beside(columns: &[Self]) -> Self {
        let rows = columns.first().map_or(0, |column| column.rows);
        Self::from_fn(rows, columns.len(), |i, k| columns[k].at(i, 0).clone())
    }

    /// The determinants of as many rows as there are columns: of each choice of them, in order.
    pub fn minors(&self) -> impl Iterator<Item = Ball> {
        let choices =
            (0_u32..1 << self.rows).filter(|choice| choice.count_ones() as usize == self.columns);
        choices.map(|choice| {
            let rows: Vec<usize> = (0..self.rows)
                .filter(|row| choice >> row & 1 == 1)
                .collect();
            Self::from_fn(rows.len(), self.columns, |i, j| self.at(rows[i], j).clone())
                .determinant()
        })
    }

    /// The determinant, by the first row.
    pub fn determinant(&self) -> Ball {
        if self.rows == 0 {
            return Ball::one();
        }
        let minor = |j: usize| {
            let columns: Vec<usize> = (0..self.columns).filter(|c| *c != j).collect();
            Self::from_fn(self.rows - 1, self.columns - 1, |a, b| {
                self.at(a + 1, columns[b]).clone()
            })
        };
        (0..self.columns).fold(Ball::zero(), |sum, j| {
            let entry = &self.at(0, j).value;
            if entry.is_zero() {
                return sum;
            }
            let term = entry.times(&minor(j).determinant());
            if j % 2 == 0 {
                sum.plus(&term)
            } else {
                sum.minus(&term)
            }
        })
    }
}
