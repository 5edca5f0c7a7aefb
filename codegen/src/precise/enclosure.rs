//! Enclosures of expressions: what they can be while each symbol stays in an interval of its own.

use super::{Interval, Precise};
use crate::expr::{Application, Atom, Expr, Function, Monomial, Number, Rational, Symbol};
use num_traits::One;
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};

/// Most values of functions that are kept beyond a change of the intervals.
const MOST_VALUES: usize = 1 << 14;

/// Words, sign and exponent of both ends of an interval.
type Ends = [(Vec<u64>, bool, i32); 2];

/// An interval for each symbol, and the functions of them met so far. A symbol without one may be any number.
#[derive(Clone, Debug)]
pub struct Enclosure {
    unit: Interval,
    bound: BTreeMap<Symbol, Interval>,
    functions: RefCell<HashMap<Atom, Interval>>,
    /// Values by the arguments' ends: cells of a partition share most of their sides.
    values: RefCell<HashMap<(Function, Vec<Ends>), Interval>>,
}

impl Enclosure {
    /// Nothing is bound yet; ends have `bits` bits.
    pub fn new(bits: usize) -> Self {
        Self {
            unit: Interval::point(Precise::integer(1, bits)),
            bound: BTreeMap::new(),
            functions: RefCell::default(),
            values: RefCell::default(),
        }
    }

    /// Confines a symbol.
    pub fn bind(&mut self, symbol: &Symbol, interval: Interval) {
        self.bound.insert(symbol.clone(), interval);
        self.functions.borrow_mut().clear();
    }

    /// The interval of a symbol.
    pub fn interval(&self, symbol: &Symbol) -> Interval {
        let known = self.bound.get(symbol).cloned();
        known.unwrap_or_else(|| Interval::whole(self.unit.bits()))
    }

    /// What the expression can be.
    pub fn of(&self, expression: &Expr) -> Interval {
        let terms = expression.terms().map(|(m, c)| self.term(m, c));
        let sum = terms.reduce(|sum, term| sum.plus(&term));
        sum.unwrap_or_else(|| self.zero())
    }

    /// What the expression can be, and what the sum of the sizes of its terms can be: beside that a residual is small or not.
    pub fn of_terms(&self, expression: &Expr) -> (Interval, Interval) {
        let mut terms = expression.terms().map(|(m, c)| self.term(m, c));
        let Some(first) = terms.next() else {
            return (self.zero(), self.zero());
        };
        let start = (first.clone(), first.abs());
        terms.fold(start, |(sum, sizes), term| {
            (sum.plus(&term), sizes.plus(&term.abs()))
        })
    }

    fn zero(&self) -> Interval {
        Interval::point(self.unit.low().same(0))
    }

    fn term(&self, monomial: &Monomial, coefficient: &Rational) -> Interval {
        let powers = monomial
            .factors()
            .map(|(atom, power)| self.atom(atom).power(power));
        let coefficient = (!coefficient.is_one()).then(|| self.unit.rational(coefficient));
        let factors = coefficient.into_iter().chain(powers);
        let product = factors.reduce(|product, factor| product.times(&factor));
        product.unwrap_or_else(|| self.unit.clone())
    }

    fn atom(&self, atom: &Atom) -> Interval {
        let application = match atom {
            Atom::Symbol(symbol) => return self.interval(symbol),
            Atom::Apply(application) => application,
        };
        if let Some(known) = self.functions.borrow().get(atom) {
            return known.clone();
        }
        let value = self.apply(application);
        let mut functions = self.functions.borrow_mut();
        functions.insert(atom.clone(), value.clone());
        value
    }

    fn apply(&self, application: &Application) -> Interval {
        let arguments = application.arguments.iter();
        let arguments: Vec<Interval> = arguments.map(|argument| self.of(argument)).collect();
        let value = || self.unit.function(application.function, &arguments);
        let ends: Option<Vec<Ends>> = arguments.iter().map(ends).collect();
        let Some(ends) = ends else {
            return value();
        };
        let key = (application.function, ends);
        if let Some(known) = self.values.borrow().get(&key) {
            return known.clone();
        }
        let value = value();
        let mut values = self.values.borrow_mut();
        if values.len() >= MOST_VALUES {
            values.clear();
        }
        values.insert(key, value.clone());
        value
    }
}

fn ends(interval: &Interval) -> Option<Ends> {
    Some([interval.low().parts()?, interval.high().parts()?])
}
