//! Formulas as Rust tokens, generic in the scalar `T`.

use crate::expr::curve::Curve;
use crate::expr::{Function, Rational, Symbol};
use crate::formula::Names;
use crate::formula::names::{NameSet, is_number_word, number_name};
use crate::formula::{Binding, Chain, Node, Program};
use num_traits::{One, ToPrimitive, Zero};
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;

/// The identifier `name`.
pub fn ident(name: &str) -> Ident {
    Ident::new(name, Span::call_site())
}

/// How tightly an operator binds.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    Sum,
    Product,
    Sign,
    Atom,
}

/// Writes the formulas of one kernel, and remembers the constants that they use.
pub struct Writer<'a> {
    names: &'a Names,
    numbers: RefCell<BTreeMap<Rational, Ident>>,
    taken: RefCell<NameSet>,
    pi: Cell<bool>,
}

impl<'a> Writer<'a> {
    /// A writer of the program's formulas.
    pub fn new(names: &'a Names, program: &Program) -> Self {
        let mut taken = names.taken().clone();
        for name in program.bindings.iter().flat_map(Binding::names) {
            taken.claim(names.get(name));
        }
        Self {
            names,
            numbers: RefCell::default(),
            taken: RefCell::new(taken),
            pi: Cell::new(false),
        }
    }

    /// The identifier of a constant.
    fn number(&self, value: &Rational) -> Ident {
        let make = || {
            let name = number_name(value);
            let mut taken = self.taken.borrow_mut();
            // Single words are reserved for numbers; composed names may meet a name of the joint.
            let reads_on = !taken.is_free(&name) && name.ends_with(|c: char| c.is_ascii_digit());
            ident(&match is_number_word(&name) {
                true => name,
                // An index would read as further digits.
                false if reads_on => taken.claim("constant"),
                false => taken.claim(&name),
            })
        };
        self.numbers
            .borrow_mut()
            .entry(value.clone())
            .or_insert_with(make)
            .clone()
    }

    /// `let half = T::from_f64(0.5);` for each constant written so far.
    pub fn constants(&self) -> TokenStream {
        let numbers = self.numbers.borrow();
        let lines = numbers.iter().map(|(value, name)| match value {
            zero if zero.is_zero() => quote! { let #name = T::zero(); },
            one if one.is_one() => quote! { let #name = T::one(); },
            _ => {
                let literal = number_literal(value);
                quote! { let #name = T::from_f64(#literal); }
            }
        });
        let pi = self
            .pi
            .get()
            .then(|| quote! { let pi = T::from_f64(::core::f64::consts::PI); });
        quote! { #(#lines)* #pi }
    }

    /// The identifier of a symbol.
    pub fn symbol(&self, symbol: &Symbol) -> Ident {
        ident(self.names.get(symbol))
    }

    /// The formula.
    pub fn formula(&self, node: &Node) -> TokenStream {
        match node {
            Node::Number(value) => {
                let name = self.number(value);
                quote! { #name }
            }
            Node::Symbol(symbol) => {
                let name = self.symbol(symbol);
                quote! { #name }
            }
            Node::Pi => {
                self.pi.set(true);
                quote! { pi }
            }
            Node::Sum(terms) => self.sum(terms),
            Node::Product(factors) => self.product(factors),
            Node::Quotient(above, below) => {
                let (above, below) = (
                    self.at_least(above, Level::Product),
                    self.at_least(below, Level::Atom),
                );
                quote! { #above / #below }
            }
            Node::Negative(inner) => {
                let inner = self.at_least(inner, Level::Product);
                quote! { -#inner }
            }
            Node::Call(function, arguments) => self.call(*function, arguments),
        }
    }

    /// The sum; products in it as multiply–adds.
    fn sum(&self, terms: &[(bool, Node)]) -> TokenStream {
        let Some(chain) = Chain::new(terms) else {
            return self.plain_sum(terms.iter());
        };
        if let Some(pairs) = pairs(&chain) {
            return self.dot(&pairs);
        }
        let rest = self.plain_sum(chain.rest.iter().copied());
        let products = chain.products.iter().rev();
        products.fold(rest, |rest, (minus, factors, last)| {
            let receiver = match factors {
                [single] => self.at_least(single, Level::Atom),
                several => {
                    let several = self.product(several);
                    quote! { (#several) }
                }
            };
            let last = self.signed(*minus, last);
            quote! { #receiver.mul_add(#last, #rest) }
        })
    }

    /// `dot([a, b], [c, d])`: the sum of the products, fused.
    fn dot(&self, pairs: &[Pair<'_>]) -> TokenStream {
        let left = pairs.iter().map(|(_, factors, _)| self.product(factors));
        let right = pairs
            .iter()
            .map(|(minus, _, last)| self.signed(*minus, last));
        quote! { dot([#(#left),*], [#(#right),*]) }
    }

    fn signed(&self, minus: bool, node: &Node) -> TokenStream {
        match minus {
            true => self.formula(&node.clone().negated().polished()),
            false => self.formula(node),
        }
    }

    fn plain_sum<'n>(&self, terms: impl Iterator<Item = &'n (bool, Node)>) -> TokenStream {
        let mut tokens = TokenStream::new();
        for (i, (minus, term)) in terms.enumerate() {
            let value = self.at_least(term, Level::Product);
            tokens.extend(match (i, minus) {
                (0, false) => quote! { #value },
                (0, true) => quote! { -#value },
                (_, false) => quote! { + #value },
                (_, true) => quote! { - #value },
            });
        }
        tokens
    }

    fn product(&self, factors: &[Node]) -> TokenStream {
        let factors = factors
            .iter()
            .map(|factor| self.at_least(factor, Level::Atom));
        let mut tokens = TokenStream::new();
        for (i, factor) in factors.enumerate() {
            tokens.extend(if i == 0 {
                factor
            } else {
                quote! { * #factor }
            });
        }
        tokens
    }

    fn call(&self, function: Function, arguments: &[Node]) -> TokenStream {
        if let (Function::Curve(curve, order), [argument]) = (function, arguments) {
            let (name, argument) = (ident(&curve_name(curve)), self.formula(argument));
            let order_of = Literal::u8_unsuffixed(order);
            return match order {
                0 => quote! { #name.at(#argument) },
                _ => quote! { #name.derivative(#argument, #order_of) },
            };
        }
        let mut written = arguments
            .iter()
            .map(|argument| self.at_least(argument, Level::Atom));
        let first = written.next().unwrap_or_default();
        match function {
            Function::Sin => quote! { #first.sin_cos().0 },
            Function::Cos => quote! { #first.sin_cos().1 },
            Function::Exp => quote! { #first.exp() },
            Function::Sinh => quote! { #first.sinh() },
            Function::Cosh => quote! { #first.cosh() },
            Function::Sech => quote! { #first.sech() },
            Function::Tanh => quote! { #first.tanh() },
            Function::LnCosh => quote! { #first.ln_cosh() },
            Function::Ln => quote! { #first.ln() },
            Function::Sqrt => quote! { #first.sqrt() },
            Function::Recip => quote! { (T::one() / #first) },
            Function::Group => quote! { #first },
            Function::Pi => quote! { pi },
            Function::Atan2 | Function::Larger | Function::Ln1p => {
                let second = arguments.get(1).map(|x| self.formula(x));
                match function {
                    Function::Atan2 => quote! { #first.atan2(#second) },
                    Function::Ln1p => quote! { #first.ln_1p_scaled(#second) },
                    _ => quote! { #first.larger(#second) },
                }
            }
            // Of one argument, above.
            Function::Curve(..) => quote! { #first },
            Function::Stumpff(order) => {
                let order = Literal::u8_unsuffixed(order);
                quote! { #first.stumpff(#order) }
            }
            Function::DexpInverse(derivative) => {
                let derivative = Literal::u8_unsuffixed(derivative);
                quote! { #first.dexp_inverse(#derivative) }
            }
        }
    }

    /// A method without arguments called on the formula.
    pub fn method(&self, node: &Node, name: &str) -> TokenStream {
        let (receiver, name) = (self.at_least(node, Level::Atom), ident(name));
        quote! { #receiver.#name() }
    }

    /// `from_rows([[…], …])` of entries, row by row.
    pub fn rows(&self, entries: &[Node], columns: usize) -> TokenStream {
        let rows = entries.chunks(columns.max(1)).map(|row| {
            let row = row.iter().map(|entry| self.formula(entry));
            quote! { [#(#row),*] }
        });
        quote! { from_rows([#(#rows),*]) }
    }

    /// The entries as an array.
    pub fn list(&self, entries: &[Node]) -> TokenStream {
        let entries = entries.iter().map(|entry| self.formula(entry));
        quote! { [#(#entries),*] }
    }

    /// The formula, in parentheses where it binds less tightly than `level`.
    fn at_least(&self, node: &Node, level: Level) -> TokenStream {
        let own = match node {
            Node::Sum(terms) if Chain::new(terms).is_some() => Level::Atom,
            Node::Sum(_) => Level::Sum,
            Node::Product(_) | Node::Quotient(..) => Level::Product,
            Node::Negative(_) => Level::Sign,
            Node::Number(_) | Node::Symbol(_) | Node::Pi | Node::Call(..) => Level::Atom,
        };
        let tokens = self.formula(node);
        // A sign inside another operation is put in parentheses: `a * (-b)`.
        if own < level || own == Level::Sign {
            quote! { (#tokens) }
        } else {
            tokens
        }
    }
}

/// A product in a sum: whether it is subtracted, all factors but the last, the last.
type Pair<'a> = (bool, &'a [Node], &'a Node);

/// The products of a sum that has no other terms, in the order in which they are added to the last.
fn pairs<'a>(chain: &Chain<'a>) -> Option<Vec<Pair<'a>>> {
    let [(false, Node::Product(factors))] = chain.rest.as_slice() else {
        return None;
    };
    let (last, others) = factors.split_last()?;
    let mut pairs = chain.products.clone();
    pairs.push((false, others, last));
    Some(pairs)
}

/// The name of the table of a curve.
pub fn curve_name(curve: Curve) -> String {
    format!("CURVE_{}", curve.name().to_ascii_uppercase())
}

/// A positive rational as a literal, or as the quotient of two where it has no short one.
fn number_literal(value: &Rational) -> TokenStream {
    let (above, below) = value.in_doubles();
    let above = float(above);
    match below.map(float) {
        Some(below) => quote! { #above / #below },
        None => quote! { #above },
    }
}

/// The literal of a finite value: numbers that doubles do not hold are refused before (`expand::beyond_doubles`).
fn float(value: f64) -> Literal {
    Literal::f64_unsuffixed(if value.is_finite() { value } else { f64::MAX })
}

/// A number that may be negative, as in constant tables.
pub fn signed_literal(value: &Rational) -> TokenStream {
    let literal = float(value.to_f64().map_or(f64::MAX, f64::abs));
    match value < &Rational::zero() {
        true => quote! { -#literal },
        false => quote! { #literal },
    }
}
