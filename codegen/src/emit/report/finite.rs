//! How the maps that move the state are found: those at finite ϕ, and those onto the manifold.

use crate::derived::{Derived, Kernel, KernelKind, Method};
use crate::emit::method::{Signature, meaning};

/// A finite map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FiniteRow {
    /// Name of the method.
    pub kernel: String,
    /// What it maps to what.
    pub meaning: String,
    /// How its value is found.
    pub method: String,
}

const FINITE: [KernelKind; 14] = [
    KernelKind::Retract,
    KernelKind::Local,
    KernelKind::RetractDifferential,
    KernelKind::RetractDifferentialInverse,
    KernelKind::TangentBasis,
    KernelKind::NormalBasis,
    KernelKind::Displaced,
    KernelKind::DisplacedDifferential,
    KernelKind::Displacement,
    KernelKind::Relations,
    KernelKind::RelationGradient,
    KernelKind::Project,
    KernelKind::Residual,
    KernelKind::Singularity,
];

pub(super) fn rows(derived: &Derived) -> Vec<FiniteRow> {
    let row = |kernel: &Kernel| FiniteRow {
        kernel: Signature::new(kernel, derived.shape).name.to_owned(),
        meaning: meaning(kernel.kind).to_owned(),
        method: in_words(kernel.method).to_owned(),
    };
    let kernels = derived.kernels.iter();
    let finite = kernels.filter(|kernel| FINITE.contains(&kernel.kind));
    finite.map(row).collect()
}

fn in_words(method: Method) -> &'static str {
    match method {
        Method::Formula => "closed form",
        Method::Solve => "K×K solve in the runtime",
        Method::Newton => "Newton's method in the runtime",
    }
}
