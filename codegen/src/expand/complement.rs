//! The null space of A, or of S̄ᵀ, in symbols: one formula that holds at every configuration.
//!
//! Rows and columns that do not share an entry are solved apart. A part with as many rows as columns has no solutions; one with a row more has
//! the vector of its signed minors, which never vanishes where the part has full rank; any other is solved for the rows of
//! a minor that is nowhere 0, the other rows being free.

use crate::domain::Domain;
use crate::expr::Expr;
use crate::matrix::{Matrix, combinations};

/// Why there is no formula.
#[derive(Clone, Debug)]
pub struct NoComplement {
    /// A minor, and the solution where it is not 0.
    pub case: Option<(Expr, Matrix)>,
}

/// A basis of the vectors orthogonal to the columns.
pub fn complement(columns: &Matrix, domain: &Domain<'_>) -> Result<Matrix, NoComplement> {
    let size = columns.rows();
    let mut solutions: Vec<(usize, Vec<Expr>)> = vec![];
    for (rows, own) in parts(columns) {
        let part = Matrix::from_fn(rows.len(), own.len(), |i, j| {
            columns.at(rows[i], own[j]).clone()
        });
        let spread = |basis: &Matrix, j: usize| {
            let mut column = vec![Expr::zero(); size];
            for (i, &row) in rows.iter().enumerate() {
                column[row] = basis.at(i, j).clone();
            }
            (rows[j.min(rows.len() - 1)], column)
        };
        let basis = of_part(&part, domain).map_err(|why| NoComplement {
            case: why.case.map(|(pivot, basis)| {
                let all: Vec<Vec<Expr>> =
                    (0..basis.columns()).map(|j| spread(&basis, j).1).collect();
                (pivot, Matrix::from_columns(size, &all))
            }),
        })?;
        solutions.extend((0..basis.columns()).map(|j| spread(&basis, j)));
    }
    solutions.sort_by_key(|(place, _)| *place);
    let solutions: Vec<Vec<Expr>> = solutions.into_iter().map(|(_, column)| column).collect();
    Ok(Matrix::from_columns(size, &solutions))
}

/// Rows and columns in connected parts: two rows belong together where a column has entries in both.
pub(super) fn parts(m: &Matrix) -> Vec<(Vec<usize>, Vec<usize>)> {
    let mut part: Vec<usize> = (0..m.rows()).collect();
    for j in 0..m.columns() {
        let rows: Vec<usize> = (0..m.rows()).filter(|&i| !m.at(i, j).is_zero()).collect();
        let Some(least) = rows.iter().map(|&i| part[i]).min() else {
            continue;
        };
        let merged: Vec<usize> = rows.iter().map(|&i| part[i]).collect();
        part.iter_mut()
            .filter(|p| merged.contains(p))
            .for_each(|p| *p = least);
    }
    let roots: std::collections::BTreeSet<usize> = part.iter().copied().collect();
    let of_root = |root: usize| {
        let rows: Vec<usize> = (0..m.rows()).filter(|&i| part[i] == root).collect();
        let touches = |&j: &usize| rows.iter().any(|&i| !m.at(i, j).is_zero());
        let columns = (0..m.columns()).filter(touches).collect();
        (rows, columns)
    };
    roots.into_iter().map(of_root).collect()
}

fn of_part(part: &Matrix, domain: &Domain<'_>) -> Result<Matrix, NoComplement> {
    let (rows, count) = part.shape();
    if count == 0 {
        return Ok(Matrix::identity(rows));
    }
    let simplify = |e: &Expr| domain.ideal().normal_form(e);
    let choices: Vec<(Vec<usize>, Expr)> = combinations(rows, count)
        .into_iter()
        .rev()
        .map(|chosen| {
            let minor = part.select_rows(&chosen).determinant(&simplify);
            (chosen, minor)
        })
        .filter(|(_, minor)| !minor.is_zero())
        .collect();
    let Some(first) = choices.first() else {
        return Err(NoComplement { case: None });
    };
    if let Some((chosen, minor)) = choices.iter().find(|(_, minor)| domain.is_unit(minor)) {
        return Ok(solved(part, chosen, minor, domain).unwrap_or_else(|| Matrix::zeros(rows, 0)));
    }
    if rows == count + 1 {
        return Ok(signed_minors(part, domain));
    }
    if let Some((chosen, minor)) = choices
        .iter()
        .find(|(_, minor)| domain.nonzero(minor).is_some())
        && let Some(basis) = solved(part, chosen, minor, domain)
    {
        return Ok(basis);
    }
    let case = solved(part, &first.0, &first.1, domain).map(|basis| (first.1.clone(), basis));
    Err(NoComplement { case })
}

/// `Mᵀx = 0` with M = [square; rest]: x on the chosen rows is −(rest square⁻¹)ᵀ times x on the free ones.
fn solved(m: &Matrix, rows: &[usize], minor: &Expr, domain: &Domain<'_>) -> Option<Matrix> {
    let simplify = |e: &Expr| domain.ideal().normal_form(e);
    let square = m.select_rows(rows);
    let inverse = square.adjugate(&simplify).scale(&minor.recip()?);
    let free: Vec<usize> = (0..m.rows()).filter(|row| !rows.contains(row)).collect();
    let solved = domain
        .ideal()
        .simplest_entries(&m.select_rows(&free).times(&inverse).transpose());
    Some(Matrix::from_fn(m.rows(), free.len(), |i, j| {
        match rows.iter().position(|&row| row == i) {
            Some(place) => -solved.at(place, j),
            None => Expr::integer((free[j] == i).into()),
        }
    }))
}

/// The vector orthogonal to n columns of n + 1 rows: entry i is the minor without row i, with alternating sign.
fn signed_minors(m: &Matrix, domain: &Domain<'_>) -> Matrix {
    let simplify = |e: &Expr| domain.ideal().normal_form(e);
    let entry = |i: usize| {
        let rows: Vec<usize> = (0..m.rows()).filter(|&row| row != i).collect();
        let minor = m.select_rows(&rows).determinant(&simplify);
        // The last entry keeps its sign, so that a unit vector is its own kind of answer.
        match (m.rows() - 1 - i) % 2 {
            0 => minor,
            _ => -minor,
        }
    };
    Matrix::from_fn(m.rows(), 1, |i, _| entry(i))
}
