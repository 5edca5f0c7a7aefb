//! Kernels whose value no formula gives: calls of the runtime's Newton iterations and solves with Φ and the relations.

use crate::derived::{Derived, Kernel, KernelKind, Method};
use crate::expr::Symbol;
use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// The call that computes the kernel; `None` where its formulas do. A projection begins at the value `start`.
pub fn call(derived: &Derived, kernel: &Kernel, start: &TokenStream) -> Option<TokenStream> {
    if kernel.method == Method::Formula {
        return None;
    }
    let retract = quote! { |q, phi| self.retract(q, phi) };
    let bases = quote! { (self.tangent_basis(q), self.normal_basis(q)) };
    let [declared, own] = relations(derived).map(Literal::usize_unsuffixed);
    let implicit = quote! {
        |q| #bases,
        |q, xi| self.displaced(q, xi),
        |q| self.relations(q).fixed_rows::<#declared>(#own).into_owned(),
    };
    let is_implicit = derived.spec.implicit.is_some();
    Some(match kernel.kind {
        KernelKind::Retract => quote! {
            ::hamel::finite::retract((q, phi), #implicit)
        },
        KernelKind::Local if is_implicit => quote! {
            ::hamel::finite::along_tangent(&self.displacement(q, target), #bases)
        },
        KernelKind::RetractDifferential if is_implicit => quote! {
            ::hamel::finite::retract_differential((q, phi), #implicit)
        },
        KernelKind::RetractDifferentialInverse if is_implicit => quote! {
            ::hamel::finite::retract_differential_inverse((q, phi, rate), #implicit)
        },
        KernelKind::Local => quote! {
            ::hamel::finite::local(q, target, #retract)
        },
        KernelKind::RetractDifferential => quote! {
            ::hamel::finite::differential(q, phi, #retract)
        },
        KernelKind::RetractDifferentialInverse => quote! {
            ::hamel::finite::differential_inverse(q, phi, rate, #retract)
        },
        KernelKind::Home | KernelKind::Project => {
            let codimension = Literal::usize_unsuffixed(codimension(derived));
            quote! { ::hamel::finite::project(#start, #codimension, |q| self.relations(q)) }
        }
        _ => return None,
    })
}

/// How many relations the spec declares, and how many those of the factors are, which stand before them.
fn relations(derived: &Derived) -> [usize; 2] {
    let declared = derived.space.manifold.declared().len();
    let relations = derived.kernel(KernelKind::Relations);
    let all = relations.and_then(|kernel| kernel.outputs.first());
    [declared, all.map_or(0, |column| column.rows() - declared)]
}

/// Whether a kernel is a method of the joint's type alone: one that only these calls need.
pub fn is_beside_the_trait(kind: KernelKind) -> bool {
    matches!(
        kind,
        KernelKind::Relations
            | KernelKind::TangentBasis
            | KernelKind::NormalBasis
            | KernelKind::Displaced
            | KernelKind::Displacement
    )
}

/// Rank of the derivatives of the relations on the manifold: N less the dimension that they cut out, without what known factors
/// that no relation names contribute to it.
fn codimension(derived: &Derived) -> usize {
    let relations = derived.kernel(KernelKind::Relations);
    let entries = relations.iter().flat_map(|kernel| &kernel.outputs);
    let named: Vec<Symbol> = entries
        .flat_map(|column| column.entries())
        .flat_map(|entry| entry.symbols())
        .collect();
    let factors = derived.space.manifold.factors().iter();
    let apart: usize = factors
        .filter(|factor| !factor.coordinates.iter().any(|q| named.contains(q)))
        .map(|factor| factor.coordinates.len() - factor.kind.dimension())
        .sum();
    derived.shape.configuration - derived.cut_out - apart
}

/// How the value is found, in a sentence of a doc comment.
pub fn sentence(kernel: &Kernel) -> Option<&'static str> {
    match (kernel.method, kernel.kind) {
        (Method::Formula, _) => None,
        (Method::Newton, KernelKind::Local) => Some(
            "By Newton's method from ϕ = 0, in at most `finite::LOCAL_ITERATIONS` steps; NaN where it \
             does not converge.",
        ),
        (Method::Newton, KernelKind::Home) => Some(
            "The configuration nearest to these numbers, by Newton's method in at most \
             `finite::PROJECT_ITERATIONS` steps; NaN where it does not converge.",
        ),
        (Method::Newton, KernelKind::Project) => Some(
            "By Newton's method, in at most `finite::PROJECT_ITERATIONS` steps; NaN where it does \
             not converge.",
        ),
        (Method::Newton, KernelKind::Retract) => Some(
            "Q exp(B ϕ + N λ), with λ by Newton's method from 0 so that the relations hold, in \
             `finite::RETRACT_ITERATIONS` steps; NaN where it does not converge.",
        ),
        (Method::Solve, KernelKind::Local) => {
            Some("The part along B of the displacement from Q to Q′, by a solve with [B, N].")
        }
        _ => Some("By a least-squares solve with ∂Φ/∂ϕ at (Q, ϕ) and at (Q′, 0)."),
    }
}
