//! Kernels as calls of the runtime's groups: finite maps of Φ = Q exp(ϕ), projection and residual of known manifolds.
//!
//! A factor's part of Q and of ϕ goes to the functions of its group in `hamel::group`. Where ϕ is not in the group's standard basis, the
//! element goes there as a formula, and the logarithm comes back through one.

mod cost;
mod factor;

pub use cost::{FUNCTIONS, GroupFunction};

use super::tokens::{Writer, ident};
use crate::derived::{Derived, Kernel, KernelKind, Method};
use crate::emit::formula::{Counts, Node};
use crate::expr::{Expr, Symbol};
use crate::manifold::Kind;
use crate::matrix::Matrix;
use factor::{Basis, Part, parts};
use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

/// A kernel that calls groups.
pub struct Calls<'a> {
    kind: KernelKind,
    parts: Vec<Part<'a>>,
    /// N and K.
    sizes: [usize; 2],
}

impl<'a> Calls<'a> {
    /// The kernel as calls; nothing where a factor has no function for it.
    pub fn new(derived: &'a Derived, kernel: &Kernel) -> Option<Self> {
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
            false => is_of_manifold && spec.manifold.value.declared().is_empty(),
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
            parts,
            sizes,
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
    fn is_in_order(&self) -> bool {
        self.parts.iter().all(|part| part.basis == Basis::Standard)
            && self.parts.is_sorted_by_key(|part| part.freedoms.first())
    }

    /// Lines before the formulas.
    pub fn lines(&self, writer: &Writer<'_>) -> TokenStream {
        if self.bound().is_empty() {
            return TokenStream::new();
        }
        let lines = self.parts.iter().map(|part| {
            let names = part.logarithm();
            let names = names.iter().map(|symbol| writer.symbol(symbol));
            let (size, call) = (
                Literal::usize_unsuffixed(part.dimension()),
                self.logarithm(part),
            );
            quote! { let [#(#names),*]: [T; #size] = #call.into(); }
        });
        lines.collect()
    }

    /// The result, with the values of [`Calls::expressions`].
    pub fn result(&self, writer: &Writer<'_>, values: &[Node]) -> TokenStream {
        match self.kind {
            KernelKind::Retract => self.retract(writer, values),
            KernelKind::Local if !self.is_in_order() => {
                let values = writer.list(values);
                quote! { SVector::from(#values) }
            }
            KernelKind::Local if self.is_sum() => quote! { target - q },
            KernelKind::Local => self.stacked("local", &|part| self.logarithm(part)),
            KernelKind::RetractDifferential => self.differential(),
            KernelKind::RetractDifferentialInverse => {
                let phi = |part: &Part<'_>| self.of_freedoms("phi", part);
                let rate = |part: &Part<'_>| self.of_freedoms("rate", part);
                self.replaced("rate", "local_rate", &|part| {
                    (part.freedoms[0], vec![phi(part), rate(part)])
                })
            }
            KernelKind::Project => self.replaced("q", "nearest", &|part| {
                (part.start, vec![self.stored("q", part)])
            }),
            KernelKind::ConfigurationRate => self.rate(),
            _ => self.residual(),
        }
    }

    /// Q̇, of real vectors v itself.
    fn rate(&self) -> TokenStream {
        self.stacked("rate", &|part| {
            let v = self.of_freedoms("v", part);
            match part.function(self.kind) {
                Some(name) => {
                    let (path, q) = (part.path(name), self.stored("q", part));
                    quote! { #path(#q, #v) }
                }
                None => {
                    let (size, start) = (
                        Literal::usize_unsuffixed(part.dimension()),
                        part.freedoms[0],
                    );
                    let start = Literal::usize_unsuffixed(start);
                    quote! { v.fixed_rows::<#size>(#start) }
                }
            }
        })
    }

    /// Whether Φ adds ϕ to Q.
    fn is_sum(&self) -> bool {
        self.is_in_order()
            && self
                .parts
                .iter()
                .all(|part| matches!(part.kind(), Kind::Real(_)))
    }

    fn retract(&self, writer: &Writer<'_>, values: &[Node]) -> TokenStream {
        if self.is_sum() {
            return quote! { q + phi };
        }
        let mut rest = values;
        let elements = self.parts.iter().map(|part| match part.basis {
            Basis::Standard => self.of_freedoms("phi", part),
            _ => {
                let (own, others) = rest.split_at(part.dimension().min(rest.len()));
                rest = others;
                let own = writer.list(own);
                quote! { &SVector::from(#own) }
            }
        });
        let elements: Vec<TokenStream> = elements.collect();
        self.stacked("moved", &|part| {
            let (path, element) = (part.path("times_exp"), &elements[part.number]);
            let q = self.stored("q", part);
            quote! { #path(#q, #element) }
        })
    }

    fn logarithm(&self, part: &Part<'_>) -> TokenStream {
        let (path, q, target) = (
            part.path("log_between"),
            self.stored("q", part),
            self.stored("target", part),
        );
        quote! { #path(#q, #target) }
    }

    /// A vector of one value a factor.
    fn stacked(&self, name: &str, value: &dyn Fn(&Part<'_>) -> TokenStream) -> TokenStream {
        if let [only] = self.parts.as_slice() {
            return value(only);
        }
        let names: Vec<Ident> = self.parts.iter().map(|part| part.named(name)).collect();
        let values = self.parts.iter().map(value);
        quote! { #(let #names = #values;)* stacked(&[#(#names.as_slice()),*]) }
    }

    /// An argument with the parts replaced for which there is a function.
    fn replaced(
        &self,
        argument: &str,
        name: &str,
        call: &dyn Fn(&Part<'_>) -> (usize, Vec<TokenStream>),
    ) -> TokenStream {
        let (argument, name) = (ident(argument), ident(name));
        let called = self.parts.iter().filter_map(|part| {
            let path = part.path(part.function(self.kind)?);
            let (start, arguments) = call(part);
            Some((
                Literal::usize_unsuffixed(start),
                quote! { #path(#(#arguments),*) },
            ))
        });
        let (starts, calls): (Vec<_>, Vec<_>) = called.unzip();
        match (self.parts.len(), calls.as_slice()) {
            (1, [only]) => quote! { #only },
            _ => {
                quote! { let mut #name = *#argument; #(put(&mut #name, #starts, &#calls);)* #name }
            }
        }
    }

    fn differential(&self) -> TokenStream {
        if let [only] = self.parts.as_slice() {
            let (path, phi) = (only.path("differential"), self.of_freedoms("phi", only));
            return quote! { #path(#phi) };
        }
        let size = Literal::usize_unsuffixed(self.sizes[1]);
        let lines = self.parts.iter().filter_map(|part| {
            let path = part.path(part.function(self.kind)?);
            let (start, phi) = (
                Literal::usize_unsuffixed(part.freedoms[0]),
                self.of_freedoms("phi", part),
            );
            Some(quote! { put_block(&mut differential, #start, &#path(#phi)); })
        });
        quote! { let mut differential = SMatrix::<T, #size, #size>::identity(); #(#lines)* differential }
    }

    fn residual(&self) -> TokenStream {
        let squares = self.parts.iter().filter_map(|part| {
            let (path, q) = (part.path(part.function(self.kind)?), self.stored("q", part));
            Some(quote! { #path(#q) })
        });
        let squares: Vec<TokenStream> = squares.collect();
        match squares.as_slice() {
            [only] => quote! { #only.sqrt() },
            several => quote! { (#(#several)+*).sqrt() },
        }
    }

    /// The part of Q or Q′.
    fn stored(&self, argument: &str, part: &Part<'_>) -> TokenStream {
        self.part_of(argument, part.start, part.stored_size(), self.sizes[0])
    }

    /// The part of ϕ or of a rate.
    fn of_freedoms(&self, argument: &str, part: &Part<'_>) -> TokenStream {
        let start = part.freedoms.first().copied().unwrap_or_default();
        self.part_of(argument, start, part.freedoms.len(), self.sizes[1])
    }

    fn part_of(&self, argument: &str, start: usize, size: usize, whole: usize) -> TokenStream {
        let (argument, start) = (ident(argument), Literal::usize_unsuffixed(start));
        match size == whole {
            true => quote! { #argument },
            false => quote! { &part(#argument, #start) },
        }
    }
}

/// Whether Q̇ is `Q v^` on every factor.
fn are_rates(derived: &Derived, parts: &[Part<'_>], kernel: &Kernel) -> bool {
    let velocity = &derived.arguments.velocity;
    let rates = parts.iter().flat_map(|part| part.rates(velocity));
    let entries = kernel.outputs.iter().flat_map(Matrix::entries).cloned();
    kernel.steps.is_empty() && rates.eq(entries)
}
