//! Kernels as calls of the runtime's groups: finite maps of Φ = Q exp(ϕ), projection and residual of known manifolds.
//!
//! A factor's part of Q and of ϕ goes to the functions of its group in `hamel::group`. Where ϕ is not in the group's standard basis, the
//! element goes there as a formula, and the logarithm comes back through one.

mod cost;
mod factor;

pub use cost::{FUNCTIONS, GroupFunction};
pub use factor::{Basis, Part, module};

use crate::derived::{Derived, Kernel, KernelKind, Method};
use crate::expr::{Expr, Symbol};
use crate::formula::Counts;
use crate::manifold::Kind;
use crate::matrix::Matrix;
use factor::{parts, parts_of_displacements};

/// A kernel that calls groups.
pub struct Calls<'a> {
    /// Which one; of displacements that of ϕ which does the same.
    pub kind: KernelKind,
    /// The name of ϕ, or of ξ.
    pub element: &'static str,
    /// The factors of the manifold.
    pub parts: Vec<Part<'a>>,
    /// N and K.
    pub sizes: [usize; 2],
}

impl<'a> Calls<'a> {
    /// The kernel as calls; nothing where a factor has no function for it.
    pub fn new(derived: &'a Derived, kernel: &Kernel) -> Option<Self> {
        if let Some(kind) = of_displacements(kernel.kind) {
            return Self::of_displacements(derived, kind);
        }
        let spec = &derived.spec;
        let is_finite = matches!(
            kernel.kind,
            KernelKind::Retract
                | KernelKind::Local
                | KernelKind::RetractDifferential
                | KernelKind::RetractDifferentialInverse
        );
        let is_rate = kernel.kind == KernelKind::ConfigurationRate;
        let is_of_manifold = matches!(kernel.kind, KernelKind::Project | KernelKind::Residual);
        let serves = match is_finite {
            true => derived
                .kernel(KernelKind::Local)
                .is_some_and(|local| local.method == Method::Formula),
            false if is_rate => true,
            false => is_of_manifold && derived.space.manifold.declared().is_empty(),
        };
        if !serves || kernel.method != Method::Formula {
            return None;
        }
        let parts = parts(spec);
        let called = parts
            .iter()
            .any(|part| part.function(kernel.kind).is_some());
        let fits = |part: &Part<'_>| match kernel.kind {
            KernelKind::Retract | KernelKind::Local => part.basis != Basis::Subalgebra,
            KernelKind::RetractDifferential | KernelKind::RetractDifferentialInverse => {
                part.function(kernel.kind).is_none() || part.basis == Basis::Standard
            }
            KernelKind::ConfigurationRate => part.basis == Basis::Standard,
            _ => true,
        };
        let sizes = [derived.shape.configuration, derived.shape.freedoms];
        let fits =
            called && parts.iter().all(fits) && (!is_rate || are_rates(derived, &parts, kernel));
        fits.then_some(Self {
            kind: kernel.kind,
            element: "phi",
            parts,
            sizes,
        })
    }

    /// That of displacements in the standard basis: nothing where a factor is no group.
    fn of_displacements(derived: &'a Derived, kind: KernelKind) -> Option<Self> {
        let parts = parts_of_displacements(&derived.spec);
        let are_groups = parts.iter().all(|part| part.kind() != Kind::S2);
        are_groups.then_some(Self {
            kind,
            element: "xi",
            parts,
            sizes: [derived.shape.configuration, derived.shape.displacements],
        })
    }

    /// The operations of the functions that are called.
    pub fn counts(&self) -> Counts {
        let mut counts = Counts::default();
        let called = self
            .parts
            .iter()
            .filter_map(|part| part.function(self.kind).map(|name| (part, name)));
        for (part, name) in called {
            counts += cost::of(part.kind(), name);
        }
        if self.kind == KernelKind::Residual {
            let relations = self
                .parts
                .iter()
                .filter(|part| part.function(self.kind).is_some())
                .count();
            counts += Counts {
                additions: relations.saturating_sub(1),
                calls: 1,
                ..Counts::default()
            };
        }
        counts
    }

    /// The names of logarithms, for the formulas that take them to the declared basis.
    pub fn bound(&self) -> Vec<Symbol> {
        match self.kind {
            KernelKind::Local if !self.is_in_order() => {
                self.parts.iter().flat_map(Part::logarithm).collect()
            }
            _ => vec![],
        }
    }

    /// The formulas that the calls need: algebra elements that are not parts of ϕ, or ϕ from logarithms that are not.
    pub fn expressions(&self) -> Vec<Expr> {
        match self.kind {
            KernelKind::Retract => {
                let others = self
                    .parts
                    .iter()
                    .filter(|part| part.basis != Basis::Standard);
                others.flat_map(Part::element).collect()
            }
            KernelKind::Local if !self.is_in_order() => {
                let mut locals = vec![Expr::zero(); self.sizes[1]];
                for (place, value) in self.parts.iter().flat_map(Part::in_declared_basis) {
                    locals[place] = value;
                }
                locals
            }
            _ => vec![],
        }
    }

    /// Whether ϕ is the logarithms one after the other.
    pub fn is_in_order(&self) -> bool {
        self.parts.iter().all(|part| part.basis == Basis::Standard)
            && self.parts.is_sorted_by_key(|part| part.freedoms.first())
    }

    /// Whether Φ adds ϕ to Q.
    pub fn is_sum(&self) -> bool {
        self.is_in_order()
            && self
                .parts
                .iter()
                .all(|part| matches!(part.kind(), Kind::Real(_)))
    }
}

/// What does with ϕ what the kernel does with a displacement ξ.
fn of_displacements(kind: KernelKind) -> Option<KernelKind> {
    Some(match kind {
        KernelKind::Displaced => KernelKind::Retract,
        KernelKind::Displacement => KernelKind::Local,
        KernelKind::DisplacedDifferential => KernelKind::RetractDifferential,
        _ => return None,
    })
}

/// Whether Q̇ is `Q v^` on every factor.
fn are_rates(derived: &Derived, parts: &[Part<'_>], kernel: &Kernel) -> bool {
    let velocity = &derived.arguments.velocity;
    let rates = parts.iter().flat_map(|part| part.rates(velocity));
    let entries = kernel.outputs.iter().flat_map(Matrix::entries).cloned();
    kernel.steps.is_empty() && rates.eq(entries)
}
