//! Kernels whose value no formula gives: calls of the runtime's Newton iterations and solves with Φ and the relations.

use crate::derived::{Derived, Kernel, KernelKind, Method};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// The call that computes the kernel; `None` where its formulas do. A projection begins at the value `start`.
pub fn call(derived: &Derived, kernel: &Kernel, start: &TokenStream) -> Option<TokenStream> {
    if kernel.method == Method::Formula {
        return None;
    }
    if derived.spec.implicit.is_some() {
        return by_relations(derived, kernel.kind, start);
    }
    let retract = quote! { |q, phi| self.retract(q, phi) };
    Some(match kernel.kind {
        KernelKind::Local => quote! {
            ::hamel::finite::local(q, target, #retract)
        },
        KernelKind::RetractDifferential => quote! {
            ::hamel::finite::differential(q, phi, #retract)
        },
        KernelKind::RetractDifferentialInverse => quote! {
            ::hamel::finite::differential_inverse(q, phi, rate, #retract)
        },
        KernelKind::Home | KernelKind::Project => projection(derived, start),
        _ => return None,
    })
}

fn projection(derived: &Derived, start: &TokenStream) -> TokenStream {
    let codimension = Literal::usize_unsuffixed(derived.codimension());
    quote! { ::hamel::finite::project(#start, #codimension, |q| self.relations(q)) }
}

/// The call where relations alone give Φ.
fn by_relations(derived: &Derived, kind: KernelKind, start: &TokenStream) -> Option<TokenStream> {
    let bases = quote! { (self.tangent_basis(q), self.normal_basis(q)) };
    let [declared, own] = derived.relation_counts().map(Literal::usize_unsuffixed);
    let relations = quote! { self.relations(q).fixed_rows::<#declared>(#own).into_owned() };
    let is_bent = derived.kernel(KernelKind::DisplacedDifferential).is_some();
    Some(match kind {
        KernelKind::Retract => {
            let along = match is_bent {
                true => quote! {
                    |q, xi| (#relations, self.relation_gradient(q) * self.displaced_differential(xi))
                },
                false => quote! { |q, _xi| (#relations, self.relation_gradient(q)) },
            };
            quote! {
                ::hamel::finite::retract(phi, #bases, |xi| self.displaced(q, xi), #along)
            }
        }
        KernelKind::Local => quote! {
            ::hamel::finite::along_tangent(&self.displacement(q, target), #bases)
        },
        KernelKind::RetractDifferential => {
            let rates = displacement_rates(is_bent, &quote! { self.tangent_basis(&moved) });
            quote! { #rates ::hamel::finite::inverse(&::hamel::finite::along_tangent(&rates, #bases)) }
        }
        KernelKind::RetractDifferentialInverse => {
            let rates = displacement_rates(is_bent, &quote! { self.tangent_basis(&moved) * rate });
            quote! { #rates ::hamel::finite::along_tangent(&rates, #bases) }
        }
        KernelKind::RelationDisplacements => quote! {
            let normal = self.normal_basis(q);
            normal * ::hamel::finite::inverse(&(self.relation_gradient(q) * normal))
        },
        // A guess may be far away, and off the factors.
        KernelKind::Home => {
            let codimension = Literal::usize_unsuffixed(derived.codimension());
            quote! {
                ::hamel::finite::assemble(
                    #start,
                    #codimension,
                    |q| self.relations(q),
                    |q| self.relation_gradient(q) * self.normal_basis(q),
                )
            }
        }
        KernelKind::Project => quote! {
            ::hamel::finite::project_by_displacements(
                #start,
                |q, xi| self.displaced(q, xi),
                |q| (#relations, self.relation_gradient(q)),
            )
        },
        _ => return None,
    })
}

/// The rates of the displacement from Q to Q′ = Φ(Q, ϕ), where Q′⁻¹Q̇′ has the values `there`.
fn displacement_rates(is_bent: bool, there: &TokenStream) -> TokenStream {
    let bent = is_bent.then(|| {
        quote! {
            let differential = self.displaced_differential(&self.displacement(q, &moved));
            let rates = ::hamel::finite::least_squares(&differential, &rates);
        }
    });
    quote! { let moved = self.retract(q, phi); let rates = #there; #bent }
}

/// The kernel by which the formulas of another are multiplied.
pub fn factor(kind: KernelKind) -> Option<TokenStream> {
    matches!(kind, KernelKind::RelationTwists | KernelKind::RelationPorts)
        .then(|| quote! { self.relation_displacements(q) })
}

/// Whether a kernel is a method of the joint's type alone: one that only these calls need.
pub fn is_beside_the_trait(kind: KernelKind) -> bool {
    matches!(
        kind,
        KernelKind::Relations
            | KernelKind::TangentBasis
            | KernelKind::NormalBasis
            | KernelKind::RelationGradient
            | KernelKind::RelationDisplacements
            | KernelKind::Displaced
            | KernelKind::DisplacedDifferential
            | KernelKind::Displacement
    )
}

/// How the value is found, in a sentence of a doc comment.
pub fn sentence(derived: &Derived, kernel: &Kernel) -> Option<&'static str> {
    match (kernel.method, kernel.kind) {
        (Method::Formula, _) => None,
        (Method::Newton, KernelKind::Local) => Some(
            "By Newton's method from ϕ = 0, in at most `finite::LOCAL_ITERATIONS` steps; NaN where it \
             does not converge.",
        ),
        (Method::Newton, KernelKind::Home) => Some(
            "The configuration nearest to these numbers and on their branch, by Newton's method; NaN where it does not converge.",
        ),
        (Method::Newton, KernelKind::Project) => Some(
            "By Newton's method, in at most `finite::PROJECT_ITERATIONS` steps; NaN where it does \
             not converge.",
        ),
        (Method::Newton, KernelKind::Retract) => Some(
            "Q exp(B ϕ + N λ), with λ by Newton's method from 0 so that the relations hold, in \
             `finite::RETRACT_ITERATIONS` steps; NaN where it does not converge or leaves the branch of Q.",
        ),
        (Method::Solve, KernelKind::Local) => {
            Some("The part along B of the displacement from Q to Q′, by a solve with [B, N].")
        }
        (_, KernelKind::RelationDisplacements) => Some("By a solve with ∂φ N."),
        (_, KernelKind::RelationTwists | KernelKind::RelationPorts) => {
            Some("By a product with `relation_displacements`.")
        }
        _ if derived.spec.implicit.is_some() => Some(
            "From B at Q′ = Φ(Q, ϕ), by a solve with [B, N] at Q; the displacement from Q to Q′ is the shortest.",
        ),
        _ => Some("By a least-squares solve with ∂Φ/∂ϕ at (Q, ϕ) and at (Q′, 0)."),
    }
}
