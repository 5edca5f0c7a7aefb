//! The lines of a program as Rust: parameters and arguments that it reads, what it asks the joint's shared functions for, its bindings.

use super::tokens::{Writer, ident};
use crate::derived::{Derived, Primitive};
use crate::emit::method::Argument;
use crate::emit::method::shared::Function;
use crate::expr::{Role, Symbol};
use crate::formula::{Binding, Names, Program};
use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;
use std::collections::BTreeSet;

/// Up to this many scalars are read one by one where an argument has more.
const FEW: usize = 3;

/// A program in the names of its symbols.
pub struct Lines<'a> {
    pub derived: &'a Derived,
    pub names: &'a Names,
    pub program: &'a Program,
    /// The shared functions whose words it may use.
    pub asked: &'a [Function],
    pub arguments: &'a [Argument],
}

impl Lines<'_> {
    /// All lines, with those of calls of groups where there are some, before `result`.
    pub fn tokens(
        &self,
        writer: &Writer<'_>,
        groups: Option<TokenStream>,
        result: &TokenStream,
    ) -> TokenStream {
        let used = self.program.symbols();
        let is_parameter = |symbol: &&Symbol| symbol.role == Role::Parameter;
        let parameters = used.iter().filter(is_parameter).map(|symbol| {
            let (local, field) = (writer.symbol(symbol), ident(symbol.name()));
            quote! { let #local = T::from_f64(self.#field); }
        });
        let arguments = self
            .arguments
            .iter()
            .map(|argument| self.read(*argument, &used));
        let asked = self
            .asked
            .iter()
            .filter_map(|function| self.ask(function, &used));
        let bindings = self.program.bindings.iter();
        let bindings: Vec<TokenStream> = bindings
            .map(|binding| self.binding(writer, binding, &used))
            .collect();
        let constants = writer.constants();
        quote! { #(#parameters)* #(#arguments)* #groups #constants #(#asked)* #(#bindings)* #result }
    }

    /// `let [a, _, b] = self.first_derivatives(q);`
    fn ask(&self, function: &Function, used: &BTreeSet<Symbol>) -> Option<TokenStream> {
        function.words.iter().find(|word| used.contains(*word))?;
        let patterns = function
            .words
            .iter()
            .map(|word| self.pattern_of(word, used));
        let name = ident(function.name);
        Some(quote! { let [#(#patterns),*] = self.#name(q); })
    }

    /// Reads from an argument the scalars that are used.
    fn read(&self, argument: Argument, used: &BTreeSet<Symbol>) -> TokenStream {
        let symbols = argument.symbols(&self.derived.arguments);
        let source = ident(argument.name());
        let read: Vec<usize> = (0..symbols.len())
            .filter(|&i| used.contains(&symbols[i]))
            .collect();
        let local = |i: &usize| ident(self.names.get(&symbols[*i]));
        let locals: Vec<Ident> = read.iter().map(local).collect();
        let indices: Vec<Literal> = read.iter().map(|&i| Literal::usize_unsuffixed(i)).collect();
        match read.len() {
            0 => TokenStream::new(),
            1 => quote! { #(let #locals = #source[#indices];)* },
            count if count <= FEW && count < symbols.len() => {
                quote! { let (#(#locals),*) = (#(#source[#indices]),*); }
            }
            _ => {
                let size = Literal::usize_unsuffixed(symbols.len());
                let all = symbols.iter().map(|symbol| self.pattern_of(symbol, used));
                quote! { let [#(#all),*]: [T; #size] = (*#source).into(); }
            }
        }
    }

    fn binding(
        &self,
        writer: &Writer<'_>,
        binding: &Binding,
        used: &BTreeSet<Symbol>,
    ) -> TokenStream {
        match binding {
            Binding::Value { name, value } => {
                let (name, value) = (writer.symbol(name), writer.formula(value));
                quote! { let #name = #value; }
            }
            Binding::SinCos { sin, cos, angle } => {
                let pattern = |symbol: &Option<Symbol>| {
                    symbol
                        .as_ref()
                        .map_or_else(|| quote! { _ }, |symbol| self.pattern_of(symbol, used))
                };
                let (sin, cos) = (pattern(sin), pattern(cos));
                let call = writer.method(angle, "sin_cos");
                quote! { let (#sin, #cos) = #call; }
            }
            Binding::Call {
                primitive,
                argument,
                outputs,
            } => {
                let argument = match primitive {
                    Primitive::QuaternionVector => writer.list(argument),
                    _ => writer.rows(argument, 3),
                };
                let names: Vec<TokenStream> = outputs
                    .iter()
                    .map(|symbol| self.pattern_of(symbol, used))
                    .collect();
                call(*primitive, &argument, &names)
            }
        }
    }

    /// The name of a value, or `_` where it is not used.
    fn pattern_of(&self, symbol: &Symbol, used: &BTreeSet<Symbol>) -> TokenStream {
        match used.contains(symbol) {
            true => {
                let name = ident(self.names.get(symbol));
                quote! { #name }
            }
            false => quote! { _ },
        }
    }
}

/// A call of the runtime; `names` are its results, row by row.
fn call(primitive: Primitive, argument: &TokenStream, names: &[TokenStream]) -> TokenStream {
    match primitive {
        Primitive::RotationVector => {
            let size = Literal::usize_unsuffixed(names.len());
            quote! {
                let rotation = #argument;
                let [#(#names),*]: [T; #size] = T::rotation_vector(&rotation).into();
            }
        }
        Primitive::QuaternionVector => quote! {
            let [#(#names),*]: [T; 3] = T::quaternion_vector(#argument).into();
        },
        Primitive::NearestRotation => {
            // Nested arrays of a matrix are its columns.
            let columns = (0..3).map(|j| {
                let column = names.iter().skip(j).step_by(3);
                quote! { [#(#column),*] }
            });
            quote! {
                let rotation = nearest_rotation(&#argument);
                let [#(#columns),*]: [[T; 3]; 3] = rotation.into();
            }
        }
    }
}
