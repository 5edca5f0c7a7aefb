//! Tree to symbols: the value of each expression, every error in it reported once.

mod access;
mod arithmetic;
mod curve;
mod elementary;
mod function;
mod literal;
mod local;
mod rotation;
mod words;

pub use function::NAMES as FUNCTIONS;
pub(super) use local::Locals;
pub(super) use words::Words;

use super::ast::{Name, Node, NodeKind};
use super::value::Value;
use super::{Fallible, code, limits, names};
use crate::diagnostic::Diagnostic;
use crate::expr::curve::Curve;
use crate::expr::{Expr, budget};
use crate::model::Declared;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// What names stand for, and the errors found so far.
pub(super) struct Evaluator<'a> {
    pub errors: &'a mut Vec<Diagnostic>,
    /// `None` for a name whose definition is wrong: its uses are not reported again.
    names: BTreeMap<String, Option<Value>>,
    /// Names of `let`s, those still to come included.
    expected: BTreeSet<String>,
    /// Local coordinates, inside Phi.
    locals: Option<Locals>,
    /// Whether a definition could not be read, so that unknown names may be right.
    pub lenient: bool,
    /// Curves by name; `None` for one that is wrong.
    pub curves: BTreeMap<String, Option<Curve>>,
    /// Where curves are called, with which argument.
    pub calls: Vec<Declared<(Curve, Expr)>>,
    /// The names that values get, where the declarations are wanted in names.
    pub words: Option<Words>,
}

impl<'a> Evaluator<'a> {
    pub fn new(errors: &'a mut Vec<Diagnostic>) -> Self {
        Self {
            errors,
            names: BTreeMap::new(),
            expected: BTreeSet::new(),
            locals: None,
            lenient: false,
            curves: BTreeMap::new(),
            calls: vec![],
            words: None,
        }
    }

    /// Reports an error.
    pub fn report(&mut self, error: Diagnostic) {
        self.errors.push(error);
    }

    /// Defines a name; `None` where its value is wrong and was reported.
    pub fn define(&mut self, name: &str, value: Option<Value>) {
        self.names.insert(name.to_owned(), value);
    }

    /// With names that only one statement knows; they hide others.
    pub fn with_names<T>(
        &mut self,
        names: Vec<(String, Value)>,
        work: impl FnOnce(&mut Self) -> T,
    ) -> T {
        let outer = self.names.clone();
        self.names
            .extend(names.into_iter().map(|(name, value)| (name, Some(value))));
        let result = work(self);
        self.names = outer;
        result
    }

    /// Says which names will be defined, for better advice.
    pub fn expect(&mut self, names: BTreeSet<String>) {
        self.expected = names;
    }

    /// With the local coordinates known, inside Phi.
    pub fn with_locals<T>(&mut self, locals: Locals, work: impl FnOnce(&mut Self) -> T) -> T {
        self.locals = Some(locals);
        let result = work(self);
        self.locals = None;
        result
    }

    /// Does the work of one statement within its budget; reports where the budget does not suffice.
    pub fn bounded<T>(
        &mut self,
        statement: &str,
        span: &Range<usize>,
        work: impl FnOnce(&mut Self) -> Option<T>,
    ) -> Option<T> {
        self.bounded_by(limits::STATEMENT_BUDGET, statement, span, work)
    }

    /// Does the work of one statement within a budget of its own.
    pub fn bounded_by<T>(
        &mut self,
        budget: u64,
        statement: &str,
        span: &Range<usize>,
        work: impl FnOnce(&mut Self) -> Option<T>,
    ) -> Option<T> {
        if budget::is_exhausted() {
            return None;
        }
        let before = self.errors.len();
        let result = budget::scope(budget, || work(self));
        let limit = match result {
            Ok(_) if budget::is_exhausted() => limits::FILE_BUDGET,
            Ok(value) => return value,
            Err(exhausted) => exhausted.limit,
        };
        // Values made after exhaustion are zero, and what was found wrong with them is not.
        self.errors.truncate(before);
        let message = format!("`{statement}` needs more than {limit} products of terms");
        let error = Diagnostic::new(code::TOO_LARGE, span.clone(), message).label("too much work");
        self.report(
            error
                .help("state it in shorter terms; powers of sums and cosines of sums grow fastest"),
        );
        None
    }

    /// The value of an expression; `None` where it is wrong and was reported.
    pub fn value(&mut self, node: &Node) -> Option<Value> {
        let value = self.unchecked(node)?;
        match limits::excess(&value) {
            None => Some(value),
            Some(excess) => {
                let error = Diagnostic::new(
                    code::TOO_LARGE,
                    node.span.clone(),
                    format!("this value has {excess}"),
                );
                self.report(error.label("too large"));
                None
            }
        }
    }

    fn unchecked(&mut self, node: &Node) -> Option<Value> {
        match &node.kind {
            NodeKind::Number(number) => Some(Value::Scalar(Expr::rational(number.clone()))),
            NodeKind::Name(name) => self.name(name, &node.span),
            NodeKind::Negative(inner) => {
                let value = self.value(inner)?;
                self.settle(arithmetic::negative(&value, &node.span))
            }
            NodeKind::Sum(terms) => self.chain(terms, arithmetic::add),
            NodeKind::Product(factors) => self.chain(factors, arithmetic::multiply),
            NodeKind::Literal(rows) => {
                let rows = self.rows(rows)?;
                self.settle(literal::matrix(&rows, &node.span))
            }
            NodeKind::Call(name, arguments) => self.call(name, arguments, &node.span),
            NodeKind::Field(base, part) => self.part(base, part),
            NodeKind::Index(base, indices) => self.element(base, indices, &node.span),
        }
    }

    /// Values of all nodes; every one is evaluated, so that each reports its own errors.
    fn values(&mut self, nodes: &[Node]) -> Option<Vec<Value>> {
        let values: Vec<Option<Value>> = nodes.iter().map(|node| self.value(node)).collect();
        values.into_iter().collect()
    }

    fn rows(&mut self, rows: &[Vec<Node>]) -> Option<Vec<Vec<Value>>> {
        let rows: Vec<_> = rows.iter().map(|row| self.values(row)).collect();
        rows.into_iter().collect()
    }

    /// Reports an error as such.
    pub fn settle<T>(&mut self, result: Fallible<T>) -> Option<T> {
        result.map_err(|error| self.report(*error)).ok()
    }

    fn chain(
        &mut self,
        operands: &[(bool, Node)],
        combine: impl Fn(&Value, bool, &Value, &Range<usize>) -> Fallible<Value>,
    ) -> Option<Value> {
        let values: Vec<Option<Value>> =
            operands.iter().map(|(_, node)| self.value(node)).collect();
        let values: Vec<Value> = values.into_iter().collect::<Option<_>>()?;
        let start = operands.first()?.1.span.start;
        let mut operands = operands.iter().zip(values);
        let (_, mut result) = operands.next()?;
        for ((inverse, node), value) in operands {
            let span = start..node.span.end;
            result = self.settle(combine(&result, *inverse, &value, &span))?;
            if let Some(excess) = limits::excess(&result) {
                let error =
                    Diagnostic::new(code::TOO_LARGE, span, format!("this value has {excess}"));
                self.report(error.label("too large"));
                return None;
            }
        }
        Some(result)
    }

    fn name(&mut self, name: &str, span: &Range<usize>) -> Option<Value> {
        if let Some(value) = self.names.get(name) {
            return value.clone();
        }
        match (name, &self.locals) {
            ("pi", _) => Some(Value::Scalar(Expr::pi())),
            ("phi", Some(locals)) => {
                let whole = locals.whole(span);
                self.settle(whole)
            }
            ("phi", None) => {
                self.report(local::outside_phi(span));
                None
            }
            _ if self.lenient => None,
            _ => {
                let error = self.undefined(name, span);
                self.report(error);
                None
            }
        }
    }

    fn undefined(&self, name: &str, span: &Range<usize>) -> Diagnostic {
        let error = Diagnostic::new(
            code::UNDEFINED,
            span.clone(),
            format!("`{name}` is not defined"),
        );
        let error = error.label("not defined here");
        if FUNCTIONS.contains(&name) {
            return error.help(format!(
                "`{name}` is a function: write its arguments in parentheses"
            ));
        }
        if self.expected.contains(name) {
            return error.help(format!(
                "`{name}` is defined below: move its `let` above this one"
            ));
        }
        let known = self.names.keys().map(String::as_str).chain(["pi", "phi"]);
        // Errors that are not printed need no advice: a file may have thousands of names, and as many that are not defined.
        let printed = self.errors.len() < hamel_diagnostics::MOST_PRINTED;
        let known = known.filter(|_| printed);
        if self.curves.contains_key(name) {
            return error.help(format!(
                "`{name}` is a curve: write its argument in parentheses"
            ));
        }
        match names::suggestion(name, known) {
            Some(advice) => error.help(advice),
            None => error
                .help("names are those of parameters, of factors in `config`, and of `let`s above"),
        }
    }

    fn call(&mut self, name: &Name, arguments: &[Node], span: &Range<usize>) -> Option<Value> {
        if name.text == "derivative" || self.curves.contains_key(&name.text) {
            return self.curve(name, arguments, span);
        }
        let mut values = self.values(arguments)?;
        // What is like no function may be a curve of which the statement could not be read.
        let functions = || FUNCTIONS.iter().copied();
        if self.lenient && names::suggestion(&name.text, functions()).is_none() {
            return None;
        }
        if let Some(words) = &mut self.words {
            words.name_angles(&name.text, &mut values);
        }
        let result = function::apply(name, &values, span);
        let value = self.settle(result)?;
        Some(match &mut self.words {
            Some(words) => words.name_root(&name.text, value),
            None => value,
        })
    }
}

/// An error of operands that do not fit.
fn misfit(span: &Range<usize>, message: String) -> Diagnostic {
    Diagnostic::new(code::SHAPES, span.clone(), message).label("the shapes do not fit")
}
