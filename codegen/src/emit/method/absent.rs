//! Kernels that are not written, because the defaults of the trait `Joint` serve: the identity, zero, products of other kernels.

use super::bias;
use crate::derived::{Derived, Kernel, KernelKind, Structure};

/// Why a kernel is not written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Absent {
    /// It is the identity.
    Identity,
    /// It is zero.
    Zero,
    /// It follows from others by products.
    ByProducts,
}

/// Why the kernel is not written; nothing for one that is.
pub fn absent(derived: &Derived, kernel: &Kernel) -> Option<Absent> {
    let structure_of = |kind| derived.kernel(kind).map(|kernel| kernel.structure);
    match kernel.kind {
        KernelKind::TwistMapChildGradient
        | KernelKind::VelocityMapGradient
        | KernelKind::SpeedBasisGradient
        | KernelKind::Gamma
        | KernelKind::Residual => zero(kernel),
        KernelKind::J22 if structure_of(KernelKind::Gamma) == Some(Structure::Zero) => zero(kernel),
        KernelKind::Constraint if derived.shape.constraints == 0 => Some(Absent::Zero),
        KernelKind::Singularity if derived.space.loci.is_empty() => Some(Absent::Identity),
        KernelKind::VelocityMap | KernelKind::VelocityMapInverse => identity(kernel)
            .filter(|_| structure_of(KernelKind::VelocityMap) == Some(Structure::Identity)),
        KernelKind::RetractDifferential | KernelKind::RetractDifferentialInverse => {
            identity(kernel).filter(|_| {
                structure_of(KernelKind::RetractDifferentialInverse) == Some(Structure::Identity)
            })
        }
        KernelKind::SpeedBasis | KernelKind::Project => identity(kernel),
        KernelKind::BiasAcceleration | KernelKind::BiasMomentum => match kernel.structure {
            Structure::Zero => Some(Absent::Zero),
            _ => bias::is_by_products(derived, kernel).then_some(Absent::ByProducts),
        },
        _ => None,
    }
}

/// The kernels that are written of a body after the first: its own, but c and its dual, which come by products.
pub fn of_further_body(derived: &Derived) -> impl Iterator<Item = &Kernel> {
    let is_product = |kind| {
        matches!(
            kind,
            KernelKind::BiasAcceleration | KernelKind::BiasMomentum
        )
    };
    derived.kernels.iter().filter(move |kernel| {
        kernel.kind.is_of_body() && !is_product(kernel.kind) && absent(derived, kernel).is_none()
    })
}

fn zero(kernel: &Kernel) -> Option<Absent> {
    (kernel.structure == Structure::Zero).then_some(Absent::Zero)
}

fn identity(kernel: &Kernel) -> Option<Absent> {
    (kernel.structure == Structure::Identity).then_some(Absent::Identity)
}

/// What is not written, in a line for each reason.
pub fn in_words(derived: &Derived) -> Vec<String> {
    let reasons = [
        (Absent::Identity, "The identity, and not written"),
        (Absent::Zero, "Zero, and not written"),
        (
            Absent::ByProducts,
            "By products of other kernels, and not written",
        ),
    ];
    let line = |(reason, words): (Absent, &str)| {
        let kernels = derived.kernels.iter();
        let those = kernels.filter(|kernel| absent(derived, kernel) == Some(reason));
        let names: Vec<&str> = those.filter_map(|kernel| symbol(kernel.kind)).collect();
        (!names.is_empty()).then(|| format!("- {words}: {}.", names.join(", ")))
    };
    reasons.into_iter().filter_map(line).collect()
}

/// How the kernel is called in formulas.
fn symbol(kind: KernelKind) -> Option<&'static str> {
    Some(match kind {
        KernelKind::TwistMapChildGradient => "∂X^c/∂ϕ",
        KernelKind::VelocityMap => "S₀",
        KernelKind::VelocityMapInverse => "S₀⁻¹",
        KernelKind::VelocityMapGradient => "∂S/∂ϕ",
        KernelKind::Gamma => "γ",
        KernelKind::J22 => "J22",
        KernelKind::Constraint => "A",
        KernelKind::SpeedBasis => "S̄",
        KernelKind::SpeedBasisGradient => "∂S̄/∂ϕ",
        KernelKind::RetractDifferential => "D",
        KernelKind::RetractDifferentialInverse => "D⁻¹",
        KernelKind::Project => "the projection",
        KernelKind::Residual => "the residual",
        KernelKind::BiasAcceleration => "c",
        KernelKind::BiasMomentum => "the dual of c",
        _ => return None,
    })
}
