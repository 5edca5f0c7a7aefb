//! The directions δ_k = ∂Φ/∂ϕ_k at ϕ = 0, as a matrix of stored scalars: what moves factors apart from each other is inverted apart.

use super::complement::parts;
use super::motion::Motion;
use crate::domain::Domain;
use crate::expr::Expr;
use crate::matrix::{Matrix, combinations};

/// Most minors of one part that are tried.
const MOST_MINORS: usize = 120;

/// A left inverse of the matrix of directions, K×N; `None` where a part has none that is defined on the whole domain.
pub fn left_inverse(motion: &Motion, domain: &Domain<'_>) -> Option<Matrix> {
    let columns: Vec<Vec<Expr>> = (0..motion.freedoms())
        .map(|k| motion.direction(k).to_vec())
        .collect();
    let size = columns.first()?.len();
    let directions = Matrix::from_columns(size, &columns);
    let mut entries = vec![vec![Expr::zero(); size]; columns.len()];
    for (rows, own) in parts(&directions) {
        if own.is_empty() {
            continue;
        }
        let part = Matrix::from_fn(rows.len(), own.len(), |i, j| {
            directions.at(rows[i], own[j]).clone()
        });
        let inverse = of_part(&part, domain)?;
        for (i, &k) in own.iter().enumerate() {
            for (j, &n) in rows.iter().enumerate() {
                entries[k][n] = inverse.at(i, j).clone();
            }
        }
    }
    Some(Matrix::from_fn(columns.len(), size, |i, j| {
        entries[i][j].clone()
    }))
}

/// `(MᵀM)⁻¹Mᵀ` where det(MᵀM) is a constant, as that of a group is; else from rows whose determinant is never 0.
fn of_part(part: &Matrix, domain: &Domain<'_>) -> Option<Matrix> {
    let simplify = |e: &Expr| domain.ideal().normal_form(e);
    let gram = part.transpose().times(part).map(&simplify);
    let determinant = gram.determinant(&simplify);
    if domain.is_unit(&determinant) {
        let inverse = gram.adjugate(&simplify).scale(&determinant.recip()?);
        return Some(inverse.times(&part.transpose()));
    }
    let chosen = combinations(part.rows(), part.columns()).into_iter();
    chosen.take(MOST_MINORS).find_map(|rows| {
        let square = part.select_rows(&rows);
        let determinant = square.determinant(&simplify);
        domain.nonzero(&determinant)?;
        let inverse = square.adjugate(&simplify).scale(&determinant.recip()?);
        Some(Matrix::from_fn(part.columns(), part.rows(), |i, j| {
            let place = rows.iter().position(|&row| row == j);
            place.map_or_else(Expr::zero, |place| inverse.at(i, place).clone())
        }))
    })
}

/// How the directions differ from straight ones: slice l holds δ_li − ∂δ_i/∂ϕ_l in column i.
pub fn bends(motion: &Motion) -> Vec<Matrix> {
    let count = motion.freedoms();
    let column = |l: usize, i: usize| {
        let pairs = motion.curvature(l, i).iter().zip(motion.direction(i));
        pairs
            .map(|(curved, straight)| curved - &motion.along(straight, l))
            .collect()
    };
    let slice = |l: usize| {
        let columns: Vec<Vec<Expr>> = (0..count).map(|i| column(l, i)).collect();
        Matrix::from_columns(columns.first().map_or(0, Vec::len), &columns)
    };
    (0..count).map(slice).collect()
}
