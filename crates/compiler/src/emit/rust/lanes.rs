//! Functions of many states side by side: types whose body a loop over states holds.

use super::RESERVED;
use super::lines::{line, value};
use crate::emit::{Function, Lowered};
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::{format_ident, quote};

/// The type of a function, which puts each result in its place.
pub fn item(function: &Function, bodies: &[String]) -> TokenStream {
    let kind = kind(function);
    let lowered = Lowered::new(function, bodies, &RESERVED);
    let lines = lowered.lines.iter().map(line);
    let outputs = lowered.outputs.iter().flatten().enumerate();
    let outputs = outputs.map(|(place, output)| {
        let (place, output) = (Literal::usize_unsuffixed(place), value(output));
        quote! { put(#place, #output); }
    });
    let sizes = sizes(function);
    let own = function
        .arguments
        .iter()
        .map(|(argument, _)| argument.name());
    let own: Vec<&str> = own.collect();
    let parameters = [0, 1, 2].map(|i| {
        let name = own.get(i).copied().unwrap_or(["q", "_v", "_u"][i]);
        let (name, size) = (format_ident!("{name}"), &sizes[i]);
        quote! { #name: &[T; #size] }
    });
    let count = Literal::usize_unsuffixed(function.outputs.len());
    let docs = format!(" `{}` of many states.", function.name);
    quote! {
        #[doc = #docs]
        struct #kind;
        impl ::hamel::compiled::OfState<#(#sizes,)* #count> for #kind {
            #[inline(always)]
            #[allow(clippy::all, unused_variables, reason = "written by a machine, for a machine")]
            fn value<T: Scalar>(#(#parameters,)* mut put: impl FnMut(usize, T)) {
                let n = T::from_f64;
                #(#lines)*
                #(#outputs)*
            }
        }
    }
}

/// What the runtime calls.
pub fn many_states(function: &Function) -> TokenStream {
    let (kind, sizes) = (kind(function), sizes(function));
    let results = Literal::usize_unsuffixed(function.results());
    quote! { ::hamel::compiled::many_states::<#kind, #(#sizes,)* #results> }
}

/// Sizes of Q, v̄ and inputs; of a function of Q alone, Q stands in the places of the others.
fn sizes(function: &Function) -> [Literal; 3] {
    let sizes = &function.arguments;
    let size = |i: usize| sizes.get(i).or(sizes.first()).map_or(0, |&(_, size)| size);
    [0, 1, 2].map(|i| Literal::usize_unsuffixed(size(i)))
}

/// The name of a function as a type.
fn kind(function: &Function) -> Ident {
    let words = function.name.split('_').map(|word| {
        let (first, rest) = word.split_at(1);
        first.to_ascii_uppercase() + rest
    });
    Ident::new(&words.collect::<String>(), Span::call_site())
}
