//! What a spec declares and what was lowered from it, in jets.

use super::ball::Ball;
use super::jet::Jet;
use hamel_codegen::derived::Primitive;
use hamel_codegen::expr::{Atom, Expr, Symbol};
use hamel_codegen::formula::{Binding, Node, Program};
use hamel_codegen::matrix::Matrix;
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};

/// Values of symbols, with those of the functions met so far.
#[derive(Clone, Debug, Default)]
pub struct Values {
    symbols: BTreeMap<Symbol, Jet>,
    functions: RefCell<HashMap<Atom, Jet>>,
}

impl Values {
    /// The values with these in place of others.
    pub fn with<'a>(
        &self,
        symbols: impl IntoIterator<Item = &'a Symbol>,
        values: impl IntoIterator<Item = Jet>,
    ) -> Self {
        let mut all = self.symbols.clone();
        all.extend(symbols.into_iter().cloned().zip(values));
        Self {
            symbols: all,
            functions: RefCell::default(),
        }
    }

    /// The value of a symbol; unknown where it has none.
    pub fn symbol(&self, symbol: &Symbol) -> Jet {
        let known = self.symbols.get(symbol);
        known
            .cloned()
            .unwrap_or_else(|| Jet::constant(Ball::unknown()))
    }

    /// The value of an expression.
    pub fn expression(&self, expression: &Expr) -> Jet {
        let terms = expression.terms().map(|(monomial, coefficient)| {
            let number = Jet::constant(Ball::rational(coefficient));
            monomial.factors().fold(number, |product, (atom, power)| {
                product.times(&self.atom(atom).power(power))
            })
        });
        let zero = Jet::constant(Ball::zero());
        terms.fold(zero, |sum, term| sum.plus(&term))
    }

    /// The entries of a matrix, row by row.
    pub fn matrix(&self, matrix: &Matrix) -> Vec<Jet> {
        matrix
            .entries()
            .iter()
            .map(|entry| self.expression(entry))
            .collect()
    }

    fn atom(&self, atom: &Atom) -> Jet {
        let application = match atom {
            Atom::Symbol(symbol) => return self.symbol(symbol),
            Atom::Apply(application) => application,
        };
        if let Some(known) = self.functions.borrow().get(atom) {
            return known.clone();
        }
        let arguments: Vec<Jet> = application
            .arguments
            .iter()
            .map(|a| self.expression(a))
            .collect();
        let value = Jet::apply(application.function, &arguments);
        self.functions
            .borrow_mut()
            .insert(atom.clone(), value.clone());
        value
    }

    /// The results of a program, as it is written into Rust.
    pub fn program(&self, program: &Program) -> Vec<Jet> {
        let mut at = self.clone();
        for binding in &program.bindings {
            match binding {
                Binding::Value { name, value } => {
                    let value = at.node(value);
                    at.symbols.insert(name.clone(), value);
                }
                Binding::SinCos { sin, cos, angle } => {
                    let angle = [at.node(angle)];
                    for (name, function) in [
                        (sin, hamel_codegen::expr::Function::Sin),
                        (cos, hamel_codegen::expr::Function::Cos),
                    ] {
                        if let Some(name) = name {
                            at.symbols
                                .insert(name.clone(), Jet::apply(function, &angle));
                        }
                    }
                }
                Binding::Call {
                    primitive:
                        Primitive::RotationVector
                        | Primitive::QuaternionVector
                        | Primitive::NearestRotation,
                    outputs,
                    ..
                } => {
                    for name in outputs {
                        at.symbols
                            .insert(name.clone(), Jet::constant(Ball::unknown()));
                    }
                }
            }
        }
        program.outputs.iter().map(|node| at.node(node)).collect()
    }

    fn node(&self, node: &Node) -> Jet {
        match node {
            Node::Number(value) => Jet::constant(Ball::rational(value)),
            Node::Symbol(symbol) => self.symbol(symbol),
            Node::Pi => Jet::constant(Ball::pi()),
            Node::Sum(terms) => {
                let zero = Jet::constant(Ball::zero());
                terms.iter().fold(zero, |sum, (minus, term)| match minus {
                    true => sum.minus(&self.node(term)),
                    false => sum.plus(&self.node(term)),
                })
            }
            Node::Product(factors) => {
                let one = Jet::constant(Ball::one());
                factors
                    .iter()
                    .fold(one, |product, factor| product.times(&self.node(factor)))
            }
            Node::Quotient(above, below) => self.node(above).over(&self.node(below)),
            Node::Negative(inner) => self.node(inner).negative(),
            Node::Call(function, arguments) => {
                let arguments: Vec<Jet> = arguments.iter().map(|a| self.node(a)).collect();
                Jet::apply(*function, &arguments)
            }
        }
    }
}
