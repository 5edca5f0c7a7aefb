//! The formulas of a report: names, matrices, and what they mean.

use super::layout;
use super::notation::{Notation, subscript};
use super::series::series;
use super::statement;
use crate::derived::{Derived, Kernel, KernelKind};
use crate::expr::Expr;
use crate::matrix::Matrix;

/// A formula on lines of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Formula {
    /// What it is.
    pub title: String,
    /// The formula, aligned, over several lines.
    pub text: String,
    /// The statement that declares it, where one does.
    pub statement: String,
}

/// H, X and S: what the documentation of a module shows.
pub fn main_formulas(derived: &Derived) -> Vec<Formula> {
    let notation = Notation::new(derived);
    let kernels = [KernelKind::Pose, KernelKind::TwistMap];
    let mut shown: Vec<Formula> = kernels
        .iter()
        .filter_map(|kind| of_kernel(derived, &notation, *kind))
        .collect();
    shown.push(velocity_map(derived, &notation));
    shown
}

/// All formulas of a page.
pub(super) fn formulas(derived: &Derived, notation: &Notation) -> Vec<Formula> {
    let before = [
        KernelKind::Pose,
        KernelKind::TwistMap,
        KernelKind::TwistMapChild,
    ];
    let after = [
        KernelKind::VelocityMapInverse,
        KernelKind::VelocityMapGradient,
        KernelKind::Gamma,
        KernelKind::J22,
        KernelKind::Constraint,
        KernelKind::SpeedBasis,
        KernelKind::SpeedBasisGradient,
        KernelKind::ConfigurationRate,
        KernelKind::BiasAcceleration,
        KernelKind::BiasMomentum,
    ];
    let of = |kind: &KernelKind| of_kernel(derived, notation, *kind);
    let first: Vec<Formula> = before.iter().filter_map(of).collect();
    let series = std::iter::once(velocity_map(derived, notation));
    first
        .into_iter()
        .chain(series)
        .chain(after.iter().filter_map(of))
        .collect()
}

fn velocity_map(derived: &Derived, notation: &Notation) -> Formula {
    let series = series(derived, notation);
    let higher = if derived
        .kernel(KernelKind::VelocityMapGradient)
        .is_some_and(all_zero)
    {
        ""
    } else {
        " + O(ϕ²)"
    };
    let mut text = format!("S(Q, ϕ) = {}{higher}", series.product);
    for (name, matrix) in &series.parts {
        text += "\n\n";
        text += &shown(notation, name, matrix);
    }
    Formula {
        title: "ϕ̇ to v, to first order in ϕ, (32)".into(),
        text,
        statement: String::new(),
    }
}

/// The formula of a kernel; nothing for parts of nonholonomic joints where there are none.
fn of_kernel(derived: &Derived, notation: &Notation, kind: KernelKind) -> Option<Formula> {
    // What the runtime solves for has no formula.
    let kernel = derived
        .kernel(kind)
        .filter(|kernel| !kernel.outputs.is_empty())?;
    let (name, title) = heading(kind)?;
    let holonomic = derived.shape.constraints == 0;
    let only_nonholonomic = [
        KernelKind::Constraint,
        KernelKind::SpeedBasis,
        KernelKind::SpeedBasisGradient,
    ];
    if holonomic && only_nonholonomic.contains(&kind) {
        return None;
    }
    let statement = statement(&derived.spec, kind).unwrap_or_default();
    let name = match cross_product(derived, kernel) {
        Some(short) => format!("{name} = {short}"),
        None => name.to_owned(),
    };
    Some(Formula {
        title: title.into(),
        text: text(notation, kernel, &name),
        statement,
    })
}

/// `p~` or `−v~`, where a Boltzmann–Hamel term is a cross product, as (32) makes it for a ball.
fn cross_product(derived: &Derived, kernel: &Kernel) -> Option<String> {
    let (symbols, letter) = match kernel.kind {
        KernelKind::Gamma => (&derived.arguments.velocity, 'v'),
        KernelKind::J22 => (&derived.arguments.momentum, 'p'),
        _ => return None,
    };
    let vector: Vec<Expr> = symbols.iter().map(Expr::symbol).collect();
    let (matrix, tilde) = (kernel.outputs.first()?, Matrix::tilde(vector.get(..3)?));
    let negative = tilde.map(|entry| -entry);
    match (vector.len(), *matrix == tilde, *matrix == negative) {
        (3, true, _) => Some(format!("{letter}~")),
        (3, _, true) => Some(format!("−{letter}~")),
        _ => None,
    }
}

fn heading(kind: KernelKind) -> Option<(&'static str, &'static str)> {
    Some(match kind {
        KernelKind::Pose => ("H", "Pose: child coordinates to parent coordinates"),
        KernelKind::TwistMap => ("X", "v to twist, in the parent frame"),
        KernelKind::TwistMapChild => ("Ad_H⁻¹ X", "v to twist, in the child frame"),
        KernelKind::VelocityMapInverse => ("S₀⁻¹", "v to ϕ̇ at ϕ = 0"),
        KernelKind::VelocityMapGradient => ("∂S/∂ϕ", "Derivatives of S at ϕ = 0"),
        KernelKind::Gamma => (
            "Σ γₖ vₖ",
            "Boltzmann–Hamel term of the Lagrangian form, (17)",
        ),
        KernelKind::J22 => ("J22", "Gyroscopic matrix of the Hamiltonian form, (28)"),
        KernelKind::Constraint => ("A", "Constraint: Aᵀ v = 0"),
        KernelKind::SpeedBasis => ("S\u{304}", "Speeds to v"),
        KernelKind::SpeedBasisGradient => (
            "∂S\u{304}/∂ϕ",
            "Derivatives of the basis of speeds at ϕ = 0",
        ),
        KernelKind::ConfigurationRate => ("Q\u{307}", "Rate of the stored scalars, (31)"),
        KernelKind::BiasAcceleration => (
            "c",
            "Velocity product term of the recursive forms, in the child frame",
        ),
        KernelKind::BiasMomentum => (
            "X\u{307}\u{304}ᵀ h",
            "Its dual, for a momentum h in the child frame",
        ),
        _ => return None,
    })
}

fn text(notation: &Notation, kernel: &Kernel, name: &str) -> String {
    match (kernel.kind, kernel.outputs.as_slice()) {
        (KernelKind::Pose, [rotation, translation]) => {
            shown(notation, name, &homogeneous(rotation, translation))
        }
        (KernelKind::VelocityMapGradient | KernelKind::SpeedBasisGradient, slices) => {
            match all_zero(kernel) {
                true => format!("{name} = 0"),
                false => {
                    let each = slices.iter().enumerate();
                    let each = each.map(|(k, slice)| {
                        shown(notation, &format!("{name}{}", subscript(k + 1)), slice)
                    });
                    each.collect::<Vec<_>>().join("\n\n")
                }
            }
        }
        (_, [only]) => shown(notation, name, only),
        _ => String::new(),
    }
}

fn homogeneous(rotation: &Matrix, translation: &Matrix) -> Matrix {
    let last = Matrix::from_fn(1, 4, |_, j| Expr::integer((j == 3).into()));
    rotation.beside(translation).stack(&last)
}

fn all_zero(kernel: &Kernel) -> bool {
    kernel.outputs.iter().all(Matrix::is_zero)
}

/// `name = matrix`, short where the matrix is 0 or I.
fn shown(notation: &Notation, name: &str, matrix: &Matrix) -> String {
    if matrix.is_zero() {
        return format!("{name} = 0");
    }
    if matrix.rows() == matrix.columns() && matrix.rows() > 1 && matrix.is_identity() {
        return format!("{name} = I");
    }
    let entries: Vec<String> = matrix
        .entries()
        .iter()
        .map(|entry| notation.expression(entry))
        .collect();
    let lines = match entries.as_slice() {
        [only] => vec![only.clone()],
        _ => layout::matrix(&entries, matrix.columns()),
    };
    layout::equation(name, &lines)
}
