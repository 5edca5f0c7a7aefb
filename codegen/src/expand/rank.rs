//! Certificates that a matrix has full rank at every configuration.

use super::complement::parts;
use super::elimination;
use crate::domain::Domain;
use crate::expr::Expr;
use crate::matrix::{Matrix, combinations, count_combinations};
use std::collections::BTreeSet;

/// Why the columns are independent everywhere, in words; `Err` holds det(MᵀM), whose zeros are where they may not be.
pub fn full_column_rank(m: &Matrix, domain: &Domain<'_>) -> Result<String, Expr> {
    let rows: Vec<usize> = (0..m.rows()).collect();
    match m.rows() > LONGEST_WHOLE {
        true => by_parts(m, domain),
        false => whole(m, &rows, domain),
    }
}

/// Most rows of a matrix of which the minors are looked at as a whole.
const LONGEST_WHOLE: usize = 6;

/// The same for a long matrix, which has many minors: connected parts have their columns to themselves.
fn by_parts(m: &Matrix, domain: &Domain<'_>) -> Result<String, Expr> {
    let parts = parts(m);
    let touched: usize = parts.iter().map(|(_, columns)| columns.len()).sum();
    if touched < m.columns() {
        return Err(Expr::zero());
    }
    let mut certificates: Vec<String> = vec![];
    for (rows, columns) in parts.iter().filter(|(_, columns)| !columns.is_empty()) {
        let part = Matrix::from_fn(rows.len(), columns.len(), |i, j| {
            m.at(rows[i], columns[j]).clone()
        });
        let certificate = of_part(&part, rows, domain)?;
        if !certificates.contains(&certificate) {
            certificates.push(certificate);
        }
    }
    Ok(certificates.join("; "))
}

/// Most minors that are looked at as a whole.
pub(super) const MOST_MINORS: usize = 5_000;

/// The same for a connected part, whose rows have these places: of rows that are alike one, and behind constant pivots where there are very
/// many minors.
fn of_part(m: &Matrix, places: &[usize], domain: &Domain<'_>) -> Result<String, Expr> {
    let row = |i: usize| (0..m.columns()).map(move |j| m.at(i, j));
    let is_new = |&i: &usize| (0..i).all(|other| !row(i).eq(row(other)));
    let rows: Vec<usize> = (0..m.rows()).filter(is_new).collect();
    let (short, places): (Matrix, Vec<usize>) = (
        m.select_rows(&rows),
        rows.iter().map(|&i| places[i]).collect(),
    );
    if count_combinations(short.rows(), short.columns()) <= MOST_MINORS {
        return whole(&short, &places, domain);
    }
    behind_pivots(&short, domain).ok_or_else(|| {
        let simplify = |e: &Expr| domain.ideal().normal_form(e);
        let gram = domain
            .ideal()
            .normal_forms(&short.transpose().times(&short));
        gram.determinant(&simplify)
    })
}

/// The same by all minors, whose rows have these places.
fn whole(m: &Matrix, places: &[usize], domain: &Domain<'_>) -> Result<String, Expr> {
    let simplify = |e: &Expr| domain.ideal().normal_form(e);
    let mut minors = vec![];
    for rows in combinations(m.rows(), m.columns()) {
        let minor = m.select_rows(&rows).determinant(&simplify);
        if domain.is_unit(&minor) {
            let rows: Vec<String> = rows
                .iter()
                .map(|&row| (places[row] + 1).to_string())
                .collect();
            let which = if rows.len() == 1 { "row" } else { "rows" };
            return Ok(format!(
                "the minor of {which} {} is {minor}",
                rows.join(", ")
            ));
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
    if let Some(certificate) = of_half(m, places, domain) {
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

/// The same for the angular or the linear rows of the twist map of one body: the speed of a point may be constant.
fn of_half(m: &Matrix, places: &[usize], domain: &Domain<'_>) -> Option<String> {
    let simplify = |e: &Expr| domain.ideal().normal_form(e);
    let half = |number: usize| {
        let own = (0..m.rows()).filter(|&i| places[i] / 3 == number);
        let rows = m.select_rows(&own.collect::<Vec<_>>());
        let gram = simplify(&rows.transpose().times(&rows).determinant(&simplify));
        // Of a number, the sum of all rows of one body tells as much.
        if gram.symbols().is_empty() && m.rows() <= LONGEST_WHOLE {
            return None;
        }
        let certificate = domain.nonzero(&gram)?;
        let (from, to) = (3 * number + 1, 3 * number + 3);
        Some(format!("det(MᵀM) of rows {from} to {to}: {certificate}"))
    };
    let halves: BTreeSet<usize> = places.iter().map(|place| place / 3).collect();
    (m.columns() <= 3)
        .then(|| halves.into_iter().find_map(half))
        .flatten()
}

/// The same for what is left behind constant pivots.
fn behind_pivots(m: &Matrix, domain: &Domain<'_>) -> Option<String> {
    let rest = elimination::remainder(m, domain)?;
    let why = full_column_rank(&rest, domain).ok()?;
    Some(format!("behind constant pivots, {why}"))
}
