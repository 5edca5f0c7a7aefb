//! The functions that kernels of a joint share, as methods of its type.

use super::docs;
use super::program::Lines;
use super::tokens::{Writer, ident};
use crate::derived::Derived;
use crate::emit::method::Argument;
use crate::emit::method::shared::{self, Function};
use crate::expr::Symbol;
use crate::formula::{Counts, Names};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// All of them; each may ask those before it.
pub fn tokens(derived: &Derived, functions: &[Function], names: &Names) -> Vec<TokenStream> {
    let method = |n: usize| method(derived, &functions[n], &functions[..n], names);
    (0..functions.len()).map(method).collect()
}

fn method(
    derived: &Derived,
    function: &Function,
    before: &[Function],
    names: &Names,
) -> TokenStream {
    let bound: Vec<_> = before
        .iter()
        .flat_map(|other| &other.steps)
        .chain(&function.steps)
        .cloned()
        .collect();
    let (program, names) = shared::program(&bound, &function.steps, &[function.outputs()], names);
    let writer = Writer::new(&names, &program);
    let outputs = program.outputs.iter().map(|output| writer.formula(output));
    let result = quote! { [#(#outputs),*] };
    let lines = Lines {
        derived,
        names: &names,
        program: &program,
        asked: before,
        arguments: &[Argument::Configuration],
    };
    let body = lines.tokens(&writer, None, &result);
    let docs = docs::outer(&[
        format!(
            "The values of {}, for other kernels.",
            listed(&function.words, &names)
        ),
        format!("Operations: {}.", Counts::of_program(&program)),
    ]);
    let (name, count) = (
        ident(function.name),
        Literal::usize_unsuffixed(function.words.len()),
    );
    let size = Literal::usize_unsuffixed(derived.shape.configuration);
    quote! { #docs fn #name<T: Scalar>(&self, q: &SVector<T, #size>) -> [T; #count] { #body } }
}

fn listed(words: &[Symbol], names: &Names) -> String {
    let words = words.iter().map(|word| format!("`{}`", names.get(word)));
    words.collect::<Vec<_>>().join(", ")
}
