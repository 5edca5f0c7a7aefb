//! Calls of the runtime's groups, as they are written.

use super::tokens::{Writer, ident};
use crate::derived::KernelKind;
use crate::emit::method::group::{Basis, Calls, Part, module};
use crate::formula::Node;
use crate::formula::names::NameSet;
use crate::manifold::Kind;
use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

impl Calls<'_> {
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
                let phi = |part: &Part<'_>| self.of_freedoms(self.element, part);
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

    fn retract(&self, writer: &Writer<'_>, values: &[Node]) -> TokenStream {
        if self.is_sum() {
            let element = ident(self.element);
            return quote! { q + #element };
        }
        let mut rest = values;
        let elements = self.parts.iter().map(|part| match part.basis {
            Basis::Standard => self.of_freedoms(self.element, part),
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
        // Names of factors may differ in capitals alone.
        let mut taken = NameSet::default();
        let names = self.parts.iter();
        let names = names.map(|part| ident(&taken.claim(&part.wish(name))));
        let names: Vec<Ident> = names.collect();
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
            let (path, phi) = (
                only.path("differential"),
                self.of_freedoms(self.element, only),
            );
            return quote! { #path(#phi) };
        }
        let size = Literal::usize_unsuffixed(self.sizes[1]);
        let lines = self.parts.iter().filter_map(|part| {
            let path = part.path(part.function(self.kind)?);
            let (start, phi) = (
                Literal::usize_unsuffixed(part.freedoms[0]),
                self.of_freedoms(self.element, part),
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

impl Part<'_> {
    /// The path of a function of its group; of real vectors with their size.
    fn path(&self, function: &str) -> TokenStream {
        let (module, function) = (ident(module(self.factor.kind)), ident(function));
        match self.factor.kind {
            Kind::Real(size) => {
                let size = Literal::usize_unsuffixed(size);
                quote! { #module::#function::<T, #size> }
            }
            _ => quote! { #module::#function },
        }
    }

    /// The name wished for something of this factor: `r_moved`.
    fn wish(&self, what: &str) -> String {
        format!("{}_{what}", self.factor.name.to_ascii_lowercase())
    }
}
