//! One kernel as a method of the trait `Joint`.

use super::collect_identifiers;
use super::numeric;
use super::program::Lines;
use super::result;
use super::tokens::{Writer, ident};
use crate::derived::{self, Shape};
use crate::emit::method::{Argument, Method, Output, Signature};
use crate::expr::Symbol;
use crate::matrix::Matrix;
use proc_macro2::{Literal, TokenStream};
use quote::quote;
use std::collections::BTreeSet;

impl Method<'_> {
    /// The method, with its documentation.
    pub fn tokens(&self, docs: &TokenStream) -> TokenStream {
        let whole = self.returned_argument();
        let body = match whole {
            Some(argument) => {
                let name = ident(argument.name());
                quote! { *#name }
            }
            None => self.body(),
        };
        let read = identifiers(&body);
        let arguments = self.signature.arguments.iter().map(|&argument| {
            let is_read = read.contains(argument.name());
            let name = ident(&format!(
                "{}{}",
                if is_read { "" } else { "_" },
                argument.name()
            ));
            let size = Literal::usize_unsuffixed(argument.size(self.derived.shape));
            quote! { #name: &SVector<T, #size> }
        });
        let name = ident(self.signature.name);
        let output = self.signature.output_type(self.derived.shape);
        let visibility = numeric::is_beside_the_trait(self.kernel.kind).then(|| quote! { pub });
        quote! { #docs #visibility fn #name<T: Scalar>(&self, #(#arguments),*) -> #output { #body } }
    }

    /// The argument that is returned as it stands, if the kernel does just that.
    fn returned_argument(&self) -> Option<Argument> {
        let is_formula = self.kernel.method == derived::Method::Formula && self.calls.is_none();
        self.whole_argument().filter(|_| is_formula)
    }

    /// The argument that the formulas are, if they are just that.
    fn whole_argument(&self) -> Option<Argument> {
        let [output] = self.kernel.outputs.as_slice() else {
            return None;
        };
        let is_it = |argument: &&Argument| {
            let symbols = argument.symbols(&self.derived.arguments);
            let same =
                |(entry, symbol): (&crate::expr::Expr, &Symbol)| entry.as_symbol() == Some(symbol);
            output.columns() == 1
                && output.rows() == symbols.len()
                && output.entries().iter().zip(symbols).all(same)
        };
        let returns_vector = matches!(self.signature.output, Output::Vector(_));
        self.signature
            .arguments
            .iter()
            .find(is_it)
            .copied()
            .filter(|_| returns_vector)
    }

    fn body(&self) -> TokenStream {
        if let Some(factor) = numeric::factor(self.kernel.kind) {
            return self.times(&factor);
        }
        if self.asks_relations {
            let count: usize = self.kernel.outputs.iter().map(Matrix::rows).sum();
            let count = Literal::usize_unsuffixed(count);
            let norm = result::norm();
            return quote! { let relations: [T; #count] = self.relations(q).into(); #norm };
        }
        let start = self.start();
        let begins_at_value = start.is_none() && !self.kernel.outputs.is_empty();
        let start = start.unwrap_or_else(|| quote! { &start });
        match numeric::call(self.derived, self.kernel, &start) {
            None => self.formulas(),
            Some(call) if begins_at_value => {
                let value = self.formulas();
                let size = Literal::usize_unsuffixed(self.derived.shape.configuration);
                quote! { let start: SVector<T, #size> = { #value }; #call }
            }
            Some(call) => call,
        }
    }

    /// The formulas as a matrix, times another kernel; column by column.
    fn times(&self, factor: &TokenStream) -> TokenStream {
        let value = self.formulas();
        let along = self.kernel.outputs.first();
        let (rows, columns) = along.map_or((0, 0), |along| along.shape());
        let relations = columns - self.derived.shape.freedoms;
        let product = quote! { along * #factor };
        let [size, rows, columns, relations] =
            [rows * relations, rows, columns, relations].map(Literal::usize_unsuffixed);
        let result = match self.signature.output {
            Output::List(_) => quote! {
                let rates = #product;
                let rates: [T; #size] = ::core::array::from_fn(|n| rates[n]);
                rates
            },
            _ => quote! { let twists: [[T; #rows]; #relations] = (#product).into(); twists },
        };
        quote! { let along: SMatrix<T, #rows, #columns> = { #value }; #result }
    }

    /// Where an iteration begins, if that is at an argument rather than at a value of the formulas.
    fn start(&self) -> Option<TokenStream> {
        let argument = match self.kernel.outputs.as_slice() {
            [] => Argument::Configuration,
            _ => self.whole_argument()?,
        };
        let name = ident(argument.name());
        Some(quote! { #name })
    }

    fn formulas(&self) -> TokenStream {
        let writer = Writer::new(&self.names, &self.program);
        let lines = Lines {
            derived: self.derived,
            names: &self.names,
            program: &self.program,
            asked: &self.asked,
            arguments: &self.signature.arguments,
        };
        let groups = self.calls.as_ref().map(|calls| calls.lines(&writer));
        let outputs = &self.program.outputs;
        let result = match &self.calls {
            Some(calls) => calls.result(&writer, outputs),
            None => result::tokens(&writer, self.kernel, &self.signature, outputs),
        };
        lines.tokens(&writer, groups, &result)
    }
}

/// Every identifier in the tokens.
fn identifiers(tokens: &TokenStream) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    collect_identifiers(tokens.clone(), &mut found);
    found
}

impl Signature {
    /// The type that the method returns.
    pub fn output_type(&self, shape: Shape) -> TokenStream {
        let size = Literal::usize_unsuffixed;
        match self.output {
            Output::Pose => quote! { Pose<T> },
            Output::Scalar => quote! { T },
            Output::List(_) => quote! { impl AsRef<[T]> },
            Output::Rows(_, columns) => {
                let columns = size(columns);
                quote! { impl AsRef<[[T; #columns]]> }
            }
            Output::Vector(rows) => {
                let rows = size(rows);
                quote! { SVector<T, #rows> }
            }
            Output::Matrix(rows, columns) => {
                let (rows, columns) = (size(rows), size(columns));
                quote! { SMatrix<T, #rows, #columns> }
            }
            Output::Slices(rows, columns) => {
                let (rows, columns, count) = (size(rows), size(columns), size(shape.freedoms));
                quote! { [SMatrix<T, #rows, #columns>; #count] }
            }
        }
    }
}
