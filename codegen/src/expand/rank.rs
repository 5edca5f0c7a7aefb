//! Certificates that a matrix has full rank at every configuration.

use crate::expr::Expr;
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use num_traits::Signed;

/// Why a matrix has full rank everywhere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Certificate {
    /// The minor of these rows is a constant that is not zero.
    Minor(Vec<usize>, Expr),
    /// `det(MᵀM)` is a positive constant.
    Gram(Expr),
    /// The minors and the relations of the manifold generate 1: they have no common zero.
    NoCommonZero(usize),
}

impl std::fmt::Display for Certificate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Minor(rows, value) => {
                let rows: Vec<String> = rows.iter().map(|row| (row + 1).to_string()).collect();
                write!(f, "the minor of rows {} is {value}", rows.join(", "))
            }
            Self::Gram(value) => write!(f, "det(MᵀM) = {value}"),
            Self::NoCommonZero(count) => write!(
                f,
                "the {count} minors and the manifold's relations generate 1"
            ),
        }
    }
}

/// Whether the expression is one term of a rational and parameters: never zero.
pub fn is_unit(e: &Expr) -> bool {
    e.terms().len() == 1 && e.leading().is_some_and(|(monomial, _)| monomial.is_unit())
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

/// A certificate that the columns are independent everywhere; `Err` holds det(MᵀM), whose zeros are where they may not be.
pub fn full_column_rank(m: &Matrix, ideal: &Ideal) -> Result<Certificate, Expr> {
    let simplify = |e: &Expr| ideal.normal_form(e);
    let mut minors = vec![];
    for rows in combinations(m.rows(), m.columns()) {
        let minor = m.select_rows(&rows).determinant(&simplify);
        if is_unit(&minor) {
            return Ok(Certificate::Minor(rows, minor));
        }
        if !minor.is_zero() {
            minors.push(minor);
        }
    }
    // Cauchy–Binet: det(MᵀM) is the sum of the squares of the minors.
    let gram = simplify(&minors.iter().map(Expr::square).sum());
    if is_unit(&gram) && gram.leading().is_some_and(|(_, c)| c.is_positive()) {
        return Ok(Certificate::Gram(gram));
    }
    match !minors.is_empty() && ideal.has_no_zero_with(&minors) {
        true => Ok(Certificate::NoCommonZero(minors.len())),
        false => Err(gram),
    }
}
