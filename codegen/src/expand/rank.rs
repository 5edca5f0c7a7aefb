//! Certificates that a matrix has full rank at every configuration.

use super::elimination;
use crate::domain::Domain;
use crate::expr::Expr;
use crate::matrix::{Matrix, combinations};

/// Why the columns are independent everywhere, in words; `Err` holds det(MᵀM), whose zeros are where they may not be.
pub fn full_column_rank(m: &Matrix, domain: &Domain<'_>) -> Result<String, Expr> {
    let simplify = |e: &Expr| domain.ideal().normal_form(e);
    let mut minors = vec![];
    for rows in combinations(m.rows(), m.columns()) {
        let minor = m.select_rows(&rows).determinant(&simplify);
        if domain.is_unit(&minor) {
            let rows: Vec<String> = rows.iter().map(|row| (row + 1).to_string()).collect();
            return Ok(format!("the minor of rows {} is {minor}", rows.join(", ")));
        }
        if !minor.is_zero() {
            minors.push(minor);
        }
    }
    // Cauchy–Binet: det(MᵀM) is the sum of the squares of the minors.
    let gram = simplify(&minors.iter().map(Expr::square).sum());
    if domain.is_unit(&gram) && gram.leading().is_some_and(|(_, c)| c.is_positive()) {
        return Ok(format!("det(MᵀM) = {gram}"));
    }
    if let Some(certificate) = of_half(m, domain) {
        return Ok(certificate);
    }
    if minors.is_empty() {
        return Err(gram);
    }
    if minors.iter().all(|minor| domain.ideal().vanishes(minor)) {
        return Err(Expr::zero());
    }
    match domain.no_common_zero(&minors) {
        Some(certificate) => Ok(format!("minors: {certificate}")),
        None if domain.is_positive(&gram) => Ok(format!("det(MᵀM) = {gram}, which is of one sign")),
        None => behind_pivots(m, domain).ok_or(gram),
    }
}

/// The same for the angular or the linear rows of a twist map: the speed of a point may be constant.
fn of_half(m: &Matrix, domain: &Domain<'_>) -> Option<String> {
    let simplify = |e: &Expr| domain.ideal().normal_form(e);
    let half = |first: usize| {
        let rows = m.block(first, 0, 3, m.columns());
        let gram = simplify(&rows.transpose().times(&rows).determinant(&simplify));
        let (from, to) = (first + 1, first + 3);
        // Of a number, the sum of all rows tells as much.
        let certificate = match gram.symbols().is_empty() {
            true => return None,
            false => domain.nonzero(&gram)?,
        };
        Some(format!("det(MᵀM) of rows {from} to {to}: {certificate}"))
    };
    (m.rows() == 6 && m.columns() <= 3)
        .then(|| [0, 3].into_iter().find_map(half))
        .flatten()
}

/// The same for what is left behind constant pivots.
fn behind_pivots(m: &Matrix, domain: &Domain<'_>) -> Option<String> {
    let rest = elimination::remainder(m, domain)?;
    let why = full_column_rank(&rest, domain).ok()?;
    Some(format!("behind constant pivots, {why}"))
}
