//! Expressions of a spec in jets.

use super::{Grid, Jet};
use hamel_codegen::expr::{Atom, Expr, Function, Number, Symbol};
use hamel_codegen::matrix::Matrix;
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};

/// Values of symbols, with those of the functions met so far: one sine is computed once.
#[derive(Clone, Debug, Default)]
pub struct Environment {
    symbols: BTreeMap<Symbol, Jet>,
    functions: RefCell<HashMap<Atom, Jet>>,
}

impl Environment {
    /// The environment with these values in place of others.
    pub fn with<'a>(&self, symbols: impl IntoIterator<Item = &'a Symbol>, values: &[Jet]) -> Self {
        let mut changed = Self {
            symbols: self.symbols.clone(),
            functions: RefCell::default(),
        };
        for (symbol, value) in symbols.into_iter().zip(values) {
            changed.symbols.insert(symbol.clone(), value.clone());
        }
        changed
    }

    /// The value of an expression; NaN where a symbol has none.
    pub fn evaluate(&self, expression: &Expr) -> Jet {
        let zero = Jet::input(0.0);
        expression
            .terms()
            .fold(zero, |sum, (monomial, coefficient)| {
                let start = Jet::input(1.0).rational(coefficient);
                let term = monomial.factors().fold(start, |product, (atom, power)| {
                    product.times(&self.atom(atom).power(power))
                });
                sum.plus(&term)
            })
    }

    /// Each entry of a list.
    pub fn evaluate_all(&self, expressions: &[Expr]) -> Vec<Jet> {
        expressions.iter().map(|e| self.evaluate(e)).collect()
    }

    /// Each entry of a matrix.
    pub fn matrix(&self, matrix: &Matrix) -> Grid<Jet> {
        Grid::from_fn(matrix.rows(), matrix.columns(), |i, j| {
            self.evaluate(matrix.at(i, j))
        })
    }

    fn atom(&self, atom: &Atom) -> Jet {
        let application = match atom {
            Atom::Symbol(symbol) => {
                let known = self.symbols.get(symbol).cloned();
                return known.unwrap_or(Jet::input(f64::NAN));
            }
            Atom::Apply(application) => application,
        };
        if let Some(known) = self.functions.borrow().get(atom) {
            return known.clone();
        }
        let arguments = self.evaluate_all(&application.arguments);
        let value = match (application.function, arguments.as_slice()) {
            (Function::Recip, [x]) => Jet::input(1.0).over(x),
            (Function::Group, [x]) => x.clone(),
            (function, _) => Jet::input(1.0).function(function, &arguments),
        };
        self.functions
            .borrow_mut()
            .insert(atom.clone(), value.clone());
        value
    }
}
