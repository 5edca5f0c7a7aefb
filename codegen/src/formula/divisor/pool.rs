//! The sums of one kernel as lists of terms, the arguments of functions among them.

use super::super::{Node, factored};
use super::cube::{Cube, Cubes, Term};
use super::numbers::Numbers;
use crate::expr::{Application, Atom, Expr, Function, Monomial, Rational, Role, Symbol};
use num_traits::One;
use std::collections::BTreeMap;

/// First index of the symbols that stand for variables here, above all others.
const FIRST_INDEX: usize = 0xC000;

/// Sums of more terms than this are collected before they are compared term by term.
const LONG: usize = 24;

/// What a variable stands for.
#[derive(Clone, Debug)]
enum Meaning {
    /// A symbol or π.
    Atom(Atom),
    /// A function of sums of the pool.
    Call(Function, Vec<(bool, usize)>),
    /// A part of a long sum.
    Sum(usize),
    /// A sum of two terms that several share.
    Divisor([Term; 2]),
}

/// Sums over numbered variables.
pub struct Pool {
    /// The distinct sums, as lists of terms.
    pub sums: Vec<Vec<Term>>,
    /// Their coefficients.
    pub numbers: Numbers,
    /// Their products.
    pub cubes: Cubes,
    by_value: BTreeMap<Expr, usize>,
    meanings: Vec<Meaning>,
    variables: BTreeMap<Atom, u16>,
    /// The sum of each expression, and whether it is its opposite.
    entries: Vec<(bool, usize)>,
}

impl Pool {
    /// The sums of the expressions and of the arguments of their functions.
    pub fn new(expressions: &[Expr]) -> Self {
        let mut pool = Self {
            sums: vec![],
            numbers: Numbers::new(),
            cubes: Cubes::default(),
            by_value: BTreeMap::new(),
            meanings: vec![],
            variables: BTreeMap::new(),
            entries: vec![],
        };
        let entries = expressions.iter().map(|expression| pool.sum(expression));
        pool.entries = entries.collect();
        pool
    }

    /// The number of the sum, and whether its opposite is meant.
    fn sum(&mut self, expression: &Expr) -> (bool, usize) {
        let first = expression.terms().next();
        let negative = first.is_some_and(|(_, coefficient)| coefficient.is_negative());
        let positive = if negative {
            -expression
        } else {
            expression.clone()
        };
        if let Some(known) = self.by_value.get(&positive) {
            return (negative, *known);
        }
        let terms = self.collected(&positive);
        self.sums.push(terms);
        self.by_value.insert(positive, self.sums.len() - 1);
        (negative, self.sums.len() - 1)
    }

    /// The terms; those of a long sum collected by their functions and arguments.
    fn collected(&mut self, sum: &Expr) -> Vec<Term> {
        if sum.terms().len() <= LONG {
            return self.separate(sum);
        }
        let groups = groups(sum, is_function_or_argument);
        match groups.len() {
            1 => self.separate(sum),
            _ => {
                let terms = groups.iter();
                terms
                    .map(|(outside, inside)| self.group(outside, inside))
                    .collect()
            }
        }
    }

    /// The terms one by one.
    fn separate(&mut self, sum: &Expr) -> Vec<Term> {
        let terms = sum.terms();
        terms
            .map(|(monomial, coefficient)| self.term(coefficient, monomial))
            .collect()
    }

    fn term(&mut self, coefficient: &Rational, monomial: &Monomial) -> Term {
        let cube = self.cube(monomial);
        Term {
            cube: self.cubes.number(cube),
            coefficient: self.numbers.number(coefficient),
        }
    }

    /// One term for a monomial times a sum.
    fn group(&mut self, outside: &Monomial, inside: &Expr) -> Term {
        if let (1, Some((monomial, coefficient))) = (inside.terms().len(), inside.leading()) {
            return self.term(coefficient, &outside.times(monomial));
        }
        let (negative, sum) = self.sum(inside);
        let variable = self.add(Meaning::Sum(sum));
        let one = Rational::one();
        let mut term = self.term(&if negative { -one } else { one }, outside);
        term.cube = self.cubes.times(term.cube, variable);
        term
    }

    fn cube(&mut self, monomial: &Monomial) -> Cube {
        let factors = monomial.factors().map(|(atom, power)| {
            // Powers beyond this do not pass the bounds on expressions.
            (
                self.variable(atom),
                i16::try_from(power).unwrap_or(i16::MAX),
            )
        });
        let mut cube: Cube = factors.collect();
        cube.sort_unstable();
        cube
    }

    fn variable(&mut self, atom: &Atom) -> u16 {
        if let Some(known) = self.variables.get(atom) {
            return *known;
        }
        let meaning = match atom {
            Atom::Apply(application) if application.function != Function::Pi => {
                self.call(application)
            }
            other => Meaning::Atom(other.clone()),
        };
        let variable = self.add(meaning);
        self.variables.insert(atom.clone(), variable);
        variable
    }

    fn call(&mut self, application: &Application) -> Meaning {
        let arguments = application.arguments.iter();
        Meaning::Call(
            application.function,
            arguments.map(|argument| self.sum(argument)).collect(),
        )
    }

    fn add(&mut self, meaning: Meaning) -> u16 {
        self.meanings.push(meaning);
        u16::try_from(self.meanings.len() - 1).unwrap_or(u16::MAX)
    }

    /// A new variable for a sum of two terms; nothing where there are too many already.
    pub fn divisor(&mut self, terms: [Term; 2]) -> Option<u16> {
        let room = self.meanings.len() < usize::from(u16::MAX);
        room.then(|| self.add(Meaning::Divisor(terms)))
    }

    /// Whether its sums are those of the expressions, over symbols alone.
    pub fn is_plain(&self) -> bool {
        let mut meanings = self.meanings.iter();
        meanings.all(|meaning| matches!(meaning, Meaning::Atom(_)))
    }

    /// The formulas of the expressions.
    pub fn formulas(&self) -> Vec<Node> {
        let mut writer = Writer {
            pool: self,
            variables: BTreeMap::new(),
            symbols: BTreeMap::new(),
        };
        let entries = self.entries.iter();
        entries
            .map(|(negative, sum)| writer.signed(*negative, *sum))
            .collect()
    }
}

/// Writes sums as formulas: factored over variables, which are then replaced by what they stand for.
struct Writer<'a> {
    pool: &'a Pool,
    variables: BTreeMap<u16, Node>,
    symbols: BTreeMap<Symbol, u16>,
}

impl Writer<'_> {
    fn signed(&mut self, negative: bool, sum: usize) -> Node {
        let node = self.terms(&self.pool.sums[sum]);
        if negative { node.negated() } else { node }
    }

    fn terms(&mut self, terms: &[Term]) -> Node {
        let terms = terms.iter().map(|term| {
            let cube = self.pool.cubes.cube(term.cube).iter();
            let factors = cube.map(|&(variable, power)| self.power(variable, power));
            let monomial = factors.fold(Monomial::one(), |product, factor| product.times(&factor));
            Expr::term(self.pool.numbers.value(term.coefficient).clone(), monomial)
        });
        let sum: Expr = terms.sum();
        self.replaced(&factored(&sum))
    }

    /// The power of a variable as a monomial: of itself, or of a symbol that stands for it.
    fn power(&mut self, variable: u16, power: i16) -> Monomial {
        let atom = match &self.pool.meanings[usize::from(variable)] {
            Meaning::Atom(atom) => atom.clone(),
            _ => {
                let index = FIRST_INDEX + usize::from(variable);
                let symbol = Symbol::new(Role::Intermediate, index, &format!("shared{variable}"));
                self.symbols.insert(symbol.clone(), variable);
                Atom::Symbol(symbol)
            }
        };
        powered(&atom, power.into())
    }

    /// The formula with every variable replaced by its meaning; shared sums stay sums of their own.
    fn replaced(&mut self, node: &Node) -> Node {
        match node {
            Node::Symbol(symbol) => match self.symbols.get(symbol) {
                Some(variable) => self.meaning(*variable),
                None => node.clone(),
            },
            Node::Sum(terms) => {
                let terms = terms
                    .iter()
                    .map(|(minus, term)| (*minus, self.replaced(term)));
                closed_sum(terms.collect())
            }
            Node::Product(factors) => Node::product(
                factors
                    .iter()
                    .map(|factor| self.replaced(factor))
                    .collect::<Vec<_>>(),
            ),
            Node::Quotient(above, below) => self.replaced(above).over(self.replaced(below)),
            Node::Negative(inner) => self.replaced(inner).negated(),
            Node::Number(_) | Node::Pi | Node::Call(..) => node.clone(),
        }
    }

    fn meaning(&mut self, variable: u16) -> Node {
        if let Some(known) = self.variables.get(&variable) {
            return known.clone();
        }
        let node = match &self.pool.meanings[usize::from(variable)] {
            Meaning::Atom(_) => Node::one(),
            Meaning::Sum(sum) => self.signed(false, *sum),
            Meaning::Divisor(terms) => self.terms(terms),
            Meaning::Call(function, arguments) => {
                let arguments = arguments.iter();
                let mut arguments: Vec<Node> = arguments
                    .map(|(negative, sum)| self.signed(*negative, *sum))
                    .collect();
                match (function, arguments.len()) {
                    (Function::Recip, 1) => Node::one().over(arguments.remove(0)),
                    (Function::Group, 1) => arguments.remove(0),
                    _ => Node::Call(*function, arguments),
                }
            }
        };
        self.variables.insert(variable, node.clone());
        node
    }
}

/// The sum of terms that may be sums themselves, which [`Node::sum`] would open.
fn closed_sum(mut terms: Vec<(bool, Node)>) -> Node {
    for (minus, term) in &mut terms {
        if let Node::Negative(inner) = term {
            *term = (**inner).clone();
            *minus = !*minus;
        }
    }
    let flip = terms.first().is_some_and(|(minus, _)| *minus);
    terms.iter_mut().for_each(|(minus, _)| *minus ^= flip);
    let sum = Node::Sum(terms);
    if flip { sum.negated() } else { sum }
}

/// The sum by the part of each monomial that `outside` chooses: for each the sum of the rests.
fn groups(sum: &Expr, outside: impl Fn(&Atom) -> bool) -> BTreeMap<Monomial, Expr> {
    let mut groups: BTreeMap<Monomial, Expr> = BTreeMap::new();
    for (monomial, coefficient) in sum.terms() {
        let mut parts = [Monomial::one(), Monomial::one()];
        for (atom, power) in monomial.factors() {
            let part = &mut parts[usize::from(!outside(atom))];
            *part = part.times(&powered(atom, power));
        }
        let [key, rest] = parts;
        *groups.entry(key).or_default() += &Expr::term(coefficient.clone(), rest);
    }
    groups
}

/// Whether this is neither a coordinate nor a constant.
fn is_function_or_argument(atom: &Atom) -> bool {
    match atom {
        Atom::Symbol(symbol) => ![Role::Parameter, Role::Coordinate].contains(&symbol.role),
        Atom::Apply(application) => application.function != Function::Pi,
    }
}

/// A power of an atom, negative only for those that may be divided by.
fn powered(atom: &Atom, power: i32) -> Monomial {
    let single = Monomial::atom(atom.clone());
    let single = match power < 0 {
        true => single.recip().unwrap_or_default(),
        false => single,
    };
    (0..power.unsigned_abs()).fold(Monomial::one(), |product, _| product.times(&single))
}
