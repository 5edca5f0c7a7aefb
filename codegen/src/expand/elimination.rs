//! A left inverse by elimination: columns that have a constant pivot are eliminated with it, and `(YᵀY)⁻¹Yᵀ` of the rest Y, which is
//! smaller and simpler than the whole matrix, does the others.

use crate::domain::Domain;
use crate::expr::Expr;
use crate::manifold::Ideal;
use crate::matrix::Matrix;

/// Most terms of det(YᵀY).
const LONGEST_GRAM: usize = 6;

/// A left inverse of the matrix; `None` where no column has a constant pivot, or det(YᵀY) is long or not shown to be never 0.
pub fn left_inverse(m: &Matrix, domain: &Domain<'_>) -> Option<Matrix> {
    let eliminated = Eliminated::new(m, domain);
    (!eliminated.pivots.is_empty()).then_some(())?;
    eliminated.left_inverse(domain)
}

/// What elimination by constant pivots leaves: it has full column rank where the matrix has. `None` where there is no such pivot.
pub fn remainder(m: &Matrix, domain: &Domain<'_>) -> Option<Matrix> {
    let eliminated = Eliminated::new(m, domain);
    (!eliminated.pivots.is_empty()).then(|| eliminated.rest())
}

/// Rows of `E m` and of E, where elimination has got to.
struct Eliminated {
    rows: Vec<Vec<Expr>>,
    operations: Vec<Vec<Expr>>,
    /// Row and column of each pivot.
    pivots: Vec<(usize, usize)>,
}

impl Eliminated {
    fn new(m: &Matrix, domain: &Domain<'_>) -> Self {
        let row = |m: &Matrix, i: usize| (0..m.columns()).map(|j| m.at(i, j).clone()).collect();
        let identity = Matrix::identity(m.rows());
        let mut eliminated = Self {
            rows: (0..m.rows()).map(|i| row(m, i)).collect(),
            operations: (0..m.rows()).map(|i| row(&identity, i)).collect(),
            pivots: vec![],
        };
        while let Some(pivot) = eliminated.next_pivot(domain) {
            eliminated.eliminate(pivot, domain);
        }
        eliminated
    }

    fn next_pivot(&self, domain: &Domain<'_>) -> Option<(usize, usize)> {
        let free = |i: usize, j: usize| self.pivots.iter().all(|(p, q)| *p != i && *q != j);
        let columns = self.rows.first().map_or(0, Vec::len);
        let mut places = (0..self.rows.len()).flat_map(|i| (0..columns).map(move |j| (i, j)));
        places.find(|&(i, j)| free(i, j) && domain.is_unit(&self.rows[i][j]))
    }

    fn eliminate(&mut self, (i, j): (usize, usize), domain: &Domain<'_>) {
        self.pivots.push((i, j));
        let inverse = self.rows[i][j].recip().unwrap_or_default();
        let (pivot, operation) = (self.rows[i].clone(), self.operations[i].clone());
        for other in (0..self.rows.len()).filter(|other| *other != i) {
            let factor = &self.rows[other][j] * &inverse;
            if factor.is_zero() {
                continue;
            }
            let subtract = |row: &mut Vec<Expr>, from: &[Expr]| {
                for (entry, x) in row.iter_mut().zip(from) {
                    *entry = domain.ideal().normal_form(&(&*entry - &(&factor * x)));
                }
            };
            subtract(&mut self.rows[other], &pivot);
            subtract(&mut self.operations[other], &operation);
        }
    }

    /// Rows and columns without a pivot.
    fn left(&self) -> (Vec<usize>, Vec<usize>) {
        let columns = self.rows.first().map_or(0, Vec::len);
        let is_row = |i: &usize| self.pivots.iter().all(|(p, _)| p != i);
        let is_column = |j: &usize| self.pivots.iter().all(|(_, q)| q != j);
        let rows = (0..self.rows.len()).filter(is_row).collect();
        (rows, (0..columns).filter(is_column).collect())
    }

    fn rest(&self) -> Matrix {
        let (rows, left) = self.left();
        Matrix::from_fn(rows.len(), left.len(), |i, j| {
            self.rows[rows[i]][left[j]].clone()
        })
    }

    fn left_inverse(&self, domain: &Domain<'_>) -> Option<Matrix> {
        let columns = self.rows.first().map_or(0, Vec::len);
        let (rows, left) = self.left();
        let rest = self.rest();
        let operations = Matrix::from_fn(rows.len(), self.rows.len(), |i, j| {
            self.operations[rows[i]][j].clone()
        });
        let good =
            |gram: &Expr| gram.terms().len() <= LONGEST_GRAM && domain.nonzero(gram).is_some();
        let of_rest = pseudo_inverse(&rest, domain.ideal(), good)?.times(&operations);
        let entry = |i: usize, n: usize| match left.iter().position(|j| *j == i) {
            Some(place) => of_rest.at(place, n).clone(),
            None => self.of_pivot(i, n, &left, &of_rest),
        };
        Some(Matrix::from_fn(columns, self.rows.len(), entry))
    }

    /// Row i of the left inverse, of a column with a pivot: what the pivot's row leaves beside the other columns.
    fn of_pivot(&self, i: usize, n: usize, left: &[usize], of_rest: &Matrix) -> Expr {
        let Some((p, _)) = self.pivots.iter().find(|(_, q)| *q == i) else {
            return Expr::zero();
        };
        let others = left.iter().enumerate();
        let others: Expr = others
            .map(|(place, j)| &self.rows[*p][*j] * of_rest.at(place, n))
            .sum();
        let inverse = self.rows[*p][i].recip().unwrap_or_default();
        &(&self.operations[*p][n] - &others) * &inverse
    }
}

/// `(MᵀM)⁻¹Mᵀ`; `None` where det(MᵀM) vanishes, or is not good. No columns have one without rows.
pub fn pseudo_inverse(m: &Matrix, ideal: &Ideal, good: impl Fn(&Expr) -> bool) -> Option<Matrix> {
    if m.columns() == 0 {
        return Some(Matrix::zeros(0, m.rows()));
    }
    let simplify = |e: &Expr| ideal.normal_form(e);
    let gram = ideal.normal_forms(&m.transpose().times(m));
    let determinant = gram.determinant(&simplify);
    let inverse = determinant.recip()?;
    if !good(&determinant) {
        return None;
    }
    let adjugate = gram.adjugate(&simplify);
    Some(adjugate.times(&m.transpose()).scale(&inverse))
}
