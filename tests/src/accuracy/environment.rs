//! Expressions of a spec in jets.

use super::{Grid, Jet};
use hamel_codegen::expr::{Atom, Expr, Function, Monomial, Number, Rational, Symbol};
use hamel_codegen::matrix::Matrix;
use num_traits::One;
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
        let mut terms = expression
            .terms()
            .map(|(monomial, coefficient)| self.term(monomial, coefficient));
        let first = terms.next().unwrap_or_else(|| Jet::input(0.0));
        terms.fold(first, |sum, term| sum.plus(&term))
    }

    /// `coefficient · monomial`, without products by 1: most of them are.
    fn term(&self, monomial: &Monomial, coefficient: &Rational) -> Jet {
        let power = |(atom, power): (&Atom, i32)| match power {
            1 => self.atom(atom),
            _ => self.atom(atom).power(power),
        };
        let product = monomial.factors().map(power).reduce(|a, b| a.times(&b));
        let number = || Jet::input(1.0).rational(coefficient);
        match product {
            None => number(),
            Some(product) if coefficient.is_one() => product,
            Some(product) => product.times(&number()),
        }
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
