//! A, S̄ and ∂S̄/∂ϕ: either may be declared, the other follows.

use super::complement::{NoComplement, complement};
use super::motion::Motion;
use crate::diagnostic::Diagnostic;
use crate::domain::Domain;
use crate::expr::Expr;
use crate::matrix::Matrix;
use crate::model::JointSpec;
use crate::prepare::Prepared;
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
    pub fn new(
        joint: &Prepared,
        motion: &Motion,
        domain: &Domain<'_>,
    ) -> Result<Self, Vec<Diagnostic>> {
        let size = motion.freedoms();
        let (constraint, speed_basis) = match (&joint.spec.constraint, &joint.spec.speed_basis) {
            (None, None) => (Matrix::zeros(size, 0), Matrix::identity(size)),
            (Some(a), Some(s)) => (a.value.clone(), s.value.clone()),
            (Some(a), None) => (
                a.value.clone(),
                complement(&a.value, domain)
                    .map_err(|why| vec![no_complement("A", "S_bar", a.span.clone(), &why)])?,
            ),
            (None, Some(s)) => (
                complement(&s.value, domain)
                    .map_err(|why| vec![no_complement("S_bar", "A", s.span.clone(), &why)])?,
                s.value.clone(),
            ),
        };
        let slopes = (0..size)
            .map(|k| {
                domain
                    .ideal()
                    .simplest_entries(&motion.along_each(&speed_basis, k))
            })
            .collect();
        Ok(Self {
            constraint,
            speed_basis,
            slopes,
        })
    }
}

fn no_complement(
    declared: &str,
    missing: &str,
    span: std::ops::Range<usize>,
    why: &NoComplement,
) -> Diagnostic {
    let error = Diagnostic::new(
        code::NO_COMPLEMENT,
        span,
        format!("{missing} cannot be found from {declared} by one formula for every configuration"),
    )
    .label("its rank changes, or the solution changes form");
    match &why.case {
        Some((pivot, basis)) => error
            .note(format!("where {pivot} ≠ 0, {missing} =\n{basis}"))
            .help(format!(
                "declare {missing} as well, it is then checked; or `except {pivot} = 0;`"
            )),
        None => error.help(format!("declare {missing} as well; it is then checked")),
    }
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
