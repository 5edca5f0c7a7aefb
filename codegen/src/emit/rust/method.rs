//! One kernel as a method of the trait `Joint`.

use super::collect_identifiers;
use super::numeric;
use super::result;
use super::tokens::{Writer, ident};
use crate::derived::{self, Primitive, Shape};
use crate::emit::method::{Argument, Method, Output, Signature};
use crate::expr::{Role, Symbol};
use crate::formula::Binding;
use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;
use std::collections::BTreeSet;

/// Up to this many scalars are read one by one where an argument has more.
const FEW: usize = 3;

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
        let parameters = self
            .used
            .iter()
            .filter(|symbol| symbol.role == Role::Parameter)
            .map(|symbol| {
                let (local, field) = (writer.symbol(symbol), ident(&symbol.name));
                quote! { let #local = T::from_f64(self.#field); }
            });
        let arguments = self
            .signature
            .arguments
            .iter()
            .map(|argument| self.read(*argument));
        let lines = self.calls.as_ref().map(|calls| calls.lines(&writer));
        let bindings = self.bindings(&writer);
        let outputs = &self.program.outputs;
        let result = match &self.calls {
            Some(calls) => calls.result(&writer, outputs),
            None => result::tokens(&writer, self.kernel, &self.signature, outputs),
        };
        let constants = writer.constants();
        quote! { #(#parameters)* #(#arguments)* #lines #constants #bindings #result }
    }

    /// The lines before the result.
    fn bindings(&self, writer: &Writer<'_>) -> TokenStream {
        let bindings = self.program.bindings.iter();
        bindings
            .map(|binding| self.binding(writer, binding))
            .collect()
    }

    /// Reads from an argument the scalars that are used.
    fn read(&self, argument: Argument) -> TokenStream {
        let symbols = argument.symbols(&self.derived.arguments);
        let source = ident(argument.name());
        let read: Vec<usize> = (0..symbols.len())
            .filter(|&i| self.used.contains(&symbols[i]))
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
                let all = symbols.iter().map(|symbol| self.pattern_of(symbol));
                quote! { let [#(#all),*]: [T; #size] = (*#source).into(); }
            }
        }
    }

    fn binding(&self, writer: &Writer<'_>, binding: &Binding) -> TokenStream {
        match binding {
            Binding::Value { name, value } => {
                let (name, value) = (writer.symbol(name), writer.formula(value));
                quote! { let #name = #value; }
            }
            Binding::SinCos { sin, cos, angle } => {
                let pattern = |symbol: &Option<Symbol>| {
                    symbol
                        .as_ref()
                        .map_or_else(|| quote! { _ }, |symbol| self.pattern_of(symbol))
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
                    .map(|symbol| self.pattern_of(symbol))
                    .collect();
                call(*primitive, &argument, &names)
            }
        }
    }

    /// The name of a value, or `_` where it is not used.
    fn pattern_of(&self, symbol: &Symbol) -> TokenStream {
        match self.used.contains(symbol) {
            true => {
                let name = ident(self.names.get(symbol));
                quote! { #name }
            }
            false => quote! { _ },
        }
    }
}

/// Every identifier in the tokens.
fn identifiers(tokens: &TokenStream) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    collect_identifiers(tokens.clone(), &mut found);
    found
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
