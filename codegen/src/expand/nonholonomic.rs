//! A, S̄ and ∂S̄/∂ϕ: either may be declared, the other follows.

use super::motion::Motion;
use super::rank;
use crate::diagnostic::Diagnostic;
use crate::expr::Expr;
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use crate::model::JointSpec;
use crate::spec::code;

/// The nonholonomic parts of a joint; trivial for a holonomic one.
#[derive(Clone, Debug)]
pub struct Nonholonomic {
    /// A, k×(k−k̄).
    pub constraint: Matrix,
    /// S̄, k×k̄.
    pub speed_basis: Matrix,
    /// ∂S̄/∂ϕ_k.
    pub slopes: Vec<Matrix>,
}

impl Nonholonomic {
    /// Takes what is declared, derives what is missing.
    pub fn new(spec: &JointSpec, motion: &Motion, ideal: &Ideal) -> Result<Self, Vec<Diagnostic>> {
        let size = motion.freedoms();
        let (constraint, speed_basis) = match (&spec.constraint, &spec.speed_basis) {
            (None, None) => (Matrix::zeros(size, 0), Matrix::identity(size)),
            (Some(a), Some(s)) => (a.value.clone(), s.value.clone()),
            (Some(a), None) => (
                a.value.clone(),
                complement(&a.value, ideal)
                    .ok_or_else(|| vec![no_complement("A", "S_bar", a.span.clone(), &a.value)])?,
            ),
            (None, Some(s)) => (
                complement(&s.value, ideal)
                    .ok_or_else(|| vec![no_complement("S_bar", "A", s.span.clone(), &s.value)])?,
                s.value.clone(),
            ),
        };
        let slopes = (0..size)
            .map(|k| ideal.normal_forms(&motion.along_each(&speed_basis, k)))
            .collect();
        Ok(Self {
            constraint,
            speed_basis,
            slopes,
        })
    }
}

/// A basis of the vectors orthogonal to the columns: from rows whose minor is a constant, the others are free.
fn complement(columns: &Matrix, ideal: &Ideal) -> Option<Matrix> {
    let simplify = |e: &Expr| ideal.normal_form(e);
    let (size, count) = columns.shape();
    rank::combinations(size, count)
        .into_iter()
        .rev()
        .find_map(|rows| {
            let square = columns.select_rows(&rows);
            let determinant = square.determinant(&simplify);
            if !rank::is_unit(&determinant) {
                return None;
            }
            let inverse = square.adjugate(&simplify).scale(&determinant.recip()?);
            let free: Vec<usize> = (0..size).filter(|row| !rows.contains(row)).collect();
            // Mᵀx = 0 with M = [square; rest]: x on the chosen rows is −(rest square⁻¹)ᵀ times x on the free ones.
            let solved =
                ideal.normal_forms(&columns.select_rows(&free).times(&inverse).transpose());
            Some(Matrix::from_fn(size, free.len(), |i, j| {
                match rows.iter().position(|&row| row == i) {
                    Some(place) => -solved.at(place, j),
                    None => Expr::integer((free[j] == i).into()),
                }
            }))
        })
}

fn no_complement(
    declared: &str,
    missing: &str,
    span: std::ops::Range<usize>,
    value: &Matrix,
) -> Diagnostic {
    Diagnostic::new(
        code::NO_COMPLEMENT,
        span,
        format!("{missing} cannot be found from {declared} by one formula for every configuration"),
    )
    .label("no choice of rows has a constant determinant")
    .note(format!("{declared} =\n{value}"))
    .help(format!("declare {missing} as well; it is then checked"))
}

/// Names of the speeds: as declared; the velocity's where S̄ selects one; else `s1`, `s2`, ….
pub fn speed_names(spec: &JointSpec) -> Vec<String> {
    let freedoms: Vec<String> = spec
        .freedoms
        .value
        .iter()
        .map(|freedom| freedom.name.clone())
        .collect();
    if let Some(names) = &spec.speed_names {
        return names.value.clone();
    }
    match (&spec.speed_basis, &spec.constraint) {
        (None, None) => freedoms,
        (Some(basis), _) => (0..basis.value.columns())
            .map(|j| selected(&basis.value.column(j), &freedoms).unwrap_or(format!("s{}", j + 1)))
            .collect(),
        (None, Some(a)) => (1..=freedoms.len().saturating_sub(a.value.columns()))
            .map(|j| format!("s{j}"))
            .collect(),
    }
}

fn selected(column: &[Expr], names: &[String]) -> Option<String> {
    let place = column.iter().position(Expr::is_one)?;
    let alone = column
        .iter()
        .enumerate()
        .all(|(i, entry)| i == place || entry.is_zero());
    alone.then(|| names[place].clone())
}
