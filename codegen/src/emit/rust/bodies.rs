//! The bodies of a joint that carries several: their names, and an implementation of `Carries` for each after the first.
//!
//! What is used of the runtime here is written with its path: a joint may have the name of any of it.

use super::joint::{self, sizes};
use super::{docs, patterns, type_ident};
use crate::derived::Derived;
use crate::emit::method::shared::Function;
use crate::emit::method::{Method, of_further_body};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// `BODIES`, and the method that hands over the joint as each further body sees it; nothing for a joint whose body has no name.
pub fn names(derived: &Derived) -> Option<TokenStream> {
    let names = &derived.spec.bodies;
    if names.is_empty() {
        return None;
    }
    let members = derived.more.iter().map(|body| {
        let place = Literal::usize_unsuffixed(body.body);
        quote! { visit(::hamel::erased::erase(::hamel::joint::Member::<_, #place>(*self))); }
    });
    let more = (!derived.more.is_empty()).then(|| {
        quote! {
            fn more(&self, visit: &mut dyn FnMut(::hamel::erased::Shared)) { #(#members)* }
        }
    });
    Some(quote! {
        const BODIES: &'static [&'static str] = &[#(#names),*];
        #more
    })
}

/// The implementations of `Carries`.
pub fn carried(derived: &Derived, functions: &[Function]) -> TokenStream {
    let bodies = derived.more.iter();
    bodies.map(|derived| body(derived, functions)).collect()
}

fn body(derived: &Derived, functions: &[Function]) -> TokenStream {
    let name = type_ident(derived);
    let [n, k, s, c] = sizes(derived);
    let place = Literal::usize_unsuffixed(derived.body);
    let structures = joint::structures(derived);
    let patterns = patterns::tokens(derived);
    let inertias = joint::inertias(derived);
    let symbols = derived.names();
    let methods = of_further_body(derived).map(|kernel| {
        let method = Method::with_functions(derived, kernel, &symbols, functions);
        method.tokens(&docs::kernel(derived, kernel, &method))
    });
    quote! {
        impl ::hamel::joint::Carries<#place, #n, #k, #s, #c> for #name {
            const STRUCTURES: Structures = #structures;
            #patterns
            #inertias
            #(#methods)*
        }
    }
}
