//! Functions of many states side by side: types whose function of eight states is loops over them.

use super::RESERVED;
use super::lines::{line, value};
use super::pairs;
use crate::emit::parts::{Part, parts};
use crate::emit::{Function, Lowered};
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::{format_ident, quote};

/// The type of a function.
pub fn item(function: &Function, bodies: &[String]) -> TokenStream {
    let kind = kind(function);
    let lowered = Lowered::new(function, bodies, &RESERVED);
    let outputs = lowered.outputs.unwrap_or_default();
    let parts = parts(&lowered.lines, &outputs);
    let parts = parts.iter().map(part);
    let sizes = sizes(function);
    let own = function
        .arguments
        .iter()
        .map(|(argument, _)| argument.name());
    let own: Vec<&str> = own.collect();
    let parameters = [0, 1, 2].map(|i| {
        let name = own.get(i).copied().unwrap_or(["q", "_v", "_u"][i]);
        let (name, size) = (format_ident!("{name}"), &sizes[i]);
        quote! { #name: &[::hamel::compiled::Lanes; #size] }
    });
    let count = Literal::usize_unsuffixed(function.results());
    let numbers = function.outputs.len();
    let (target, before, after) = match &function.pairs {
        None => (format_ident!("results"), quote! {}, quote! {}),
        Some(tables) => {
            let size = Literal::usize_unsuffixed(numbers);
            let before = quote! {
                let mut results = [::hamel::compiled::Lanes([0.0; ::hamel::compiled::LANES]); #size];
            };
            let after = pairs::rows_in_lanes(tables, numbers);
            (format_ident!("rows"), before, after)
        }
    };
    let docs = format!(" `{}` of many states.", function.name);
    quote! {
        #[doc = #docs]
        struct #kind;
        impl ::hamel::compiled::OfEight<#(#sizes,)* #count> for #kind {
            #[inline(always)]
            #[allow(clippy::all, unused_variables, reason = "written by a machine, for a machine")]
            fn eight<T: ::hamel::compiled::LaneScalar, I: ::hamel::compiled::Registers>(simd: I, #(#parameters,)* #target: &mut [::hamel::compiled::Lanes; #count]) {
                let n = T::from_f64;
                #before
                #(#parts)*
                #after
            }
        }
    }
}

/// A loop over the states.
fn part(part: &Part) -> TokenStream {
    let array = format_ident!("{}", part.array);
    let size = Literal::usize_unsuffixed(part.kept.len());
    let room = (!part.kept.is_empty())
        .then(|| quote! { let mut #array = [::hamel::compiled::Lanes([0.0; ::hamel::compiled::LANES]); #size]; });
    let lines = part.lines.iter().map(line);
    let kept = part.kept.iter().enumerate().map(|(place, name)| {
        let (place, name) = (Literal::usize_unsuffixed(place), format_ident!("{name}"));
        quote! { #array[#place].0[lane] = #name.number(); }
    });
    let results = part.results.iter().map(|(place, result)| {
        let (place, result) = (Literal::usize_unsuffixed(*place), value(result));
        quote! { results[#place].0[lane] = (#result).number(); }
    });
    quote! {
        #room
        for lane in 0..::hamel::compiled::LANES {
            #(#lines)*
            #(#kept)*
            #(#results)*
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
