//! A random point of a joint: a value for every symbol.

use super::Precise;
use crate::expr::{Application, Atom, Expr, Function, Monomial, Number, Rational, Role, Symbol};
use crate::matrix::Matrix;
use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};
use num_traits::One;
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};

/// Values of all symbols: parameters, Q and a second Q′ as the sampler drew them; ϕ, v, v̄, p, h and all others random in
/// [−1, 1), drawn when they are first asked for and the same whenever they are.
#[derive(Clone, Debug)]
pub struct Point {
    seed: u64,
    bits: usize,
    bound: BTreeMap<Symbol, Precise>,
    /// Symbols met so far that are not bound.
    drawn: RefCell<BTreeMap<Symbol, Precise>>,
    /// Functions met so far: most expressions of a joint share theirs.
    functions: RefCell<HashMap<Atom, Precise>>,
}

impl Point {
    /// A point at which nothing is bound yet.
    pub(super) fn new(seed: u64, bits: usize) -> Self {
        Self {
            seed,
            bits,
            bound: BTreeMap::new(),
            drawn: RefCell::default(),
            functions: RefCell::default(),
        }
    }

    /// Precision in bits.
    pub fn bits(&self) -> usize {
        self.bits
    }

    /// Gives a symbol its value.
    pub fn bind(&mut self, symbol: &Symbol, value: Precise) {
        self.bound.insert(symbol.clone(), value);
        let is_other = |atom: &Atom| match atom {
            Atom::Symbol(own) => own != symbol,
            Atom::Apply(application) => !application.symbols().contains(symbol),
        };
        self.functions.borrow_mut().retain(|atom, _| is_other(atom));
    }

    /// The value of a symbol.
    pub fn value(&self, symbol: &Symbol) -> Precise {
        match self.bound.get(symbol) {
            Some(value) => value.clone(),
            None => {
                let mut drawn = self.drawn.borrow_mut();
                let value = drawn.entry(symbol.clone());
                value.or_insert_with(|| self.random(symbol)).clone()
            }
        }
    }

    /// In [−1, 1), to all bits, from the seed and the symbol alone.
    fn random(&self, symbol: &Symbol) -> Precise {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed ^ hash_of_symbol(symbol));
        let words: Vec<u64> = (0..self.bits.div_ceil(64))
            .map(|_| random.next_u64())
            .collect();
        let fraction = Precise::fraction_of_words(&words, self.bits);
        fraction.halved(-1) - Precise::integer(1, self.bits)
    }

    /// The value of an expression.
    pub fn evaluate(&self, expression: &Expr) -> Precise {
        let terms = expression.terms().map(|term| self.term(term));
        let sum = terms.reduce(|sum, term| sum + term);
        sum.unwrap_or_else(|| self.constant(0))
    }

    /// The value of an expression, and the size of its largest term: what a residual is small against.
    pub fn evaluate_with_scale(&self, expression: &Expr) -> (Precise, f64) {
        let start = (self.constant(0), 0.0);
        expression.terms().fold(start, |(sum, scale), term| {
            let term = self.term(term);
            let size = term.to_f64().abs();
            // Not f64::max, which would drop a NaN.
            let scale = if size <= scale { scale } else { size };
            (sum + term, scale)
        })
    }

    /// The values of a matrix, row by row.
    pub fn matrix(&self, matrix: &Matrix) -> Vec<Precise> {
        matrix
            .entries()
            .iter()
            .map(|entry| self.evaluate(entry))
            .collect()
    }

    fn constant(&self, value: i64) -> Precise {
        Precise::integer(value, self.bits)
    }

    fn term(&self, (monomial, coefficient): (&Monomial, &Rational)) -> Precise {
        let powers = monomial.factors();
        let powers = powers.map(|(atom, power)| self.atom(atom).power(power));
        let product = powers.reduce(|product, power| product * power);
        let coefficient = (!coefficient.is_one()).then(|| self.constant(1).rational(coefficient));
        match (coefficient, product) {
            (Some(coefficient), Some(product)) => coefficient * product,
            (coefficient, product) => coefficient.or(product).unwrap_or_else(|| self.constant(1)),
        }
    }

    fn atom(&self, atom: &Atom) -> Precise {
        let application = match atom {
            Atom::Symbol(symbol) => return self.value(symbol),
            Atom::Apply(application) => application,
        };
        if let Some(known) = self.functions.borrow().get(atom) {
            return known.clone();
        }
        let value = self.apply(application);
        self.functions
            .borrow_mut()
            .insert(atom.clone(), value.clone());
        value
    }

    fn apply(&self, application: &Application) -> Precise {
        let arguments: Vec<Precise> = application
            .arguments
            .iter()
            .map(|argument| self.evaluate(argument))
            .collect();
        match (application.function, arguments.as_slice()) {
            (Function::Recip, [x]) => self.constant(1) / x.clone(),
            (function, _) => self.constant(1).function(function, &arguments),
        }
    }
}

/// Fowler, Noll and Vo's hash of role, index and name: the same on every machine and in every version.
fn hash_of_symbol(symbol: &Symbol) -> u64 {
    let role = role_number(symbol.role);
    let bytes = [role].into_iter().chain(symbol.index.to_le_bytes());
    bytes
        .chain(symbol.name().bytes())
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
}

fn role_number(role: Role) -> u8 {
    match role {
        Role::Parameter => 0,
        Role::Coordinate => 1,
        Role::Target => 2,
        Role::Local => 3,
        Role::Velocity => 4,
        Role::Speed => 5,
        Role::Momentum => 6,
        Role::Wrench => 7,
        Role::Inertia => 8,
        Role::Intermediate => 9,
        Role::Constant => 10,
        Role::Displacement => 11,
    }
}
