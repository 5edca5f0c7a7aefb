//! How a joint's symbols and expressions are set, in the symbols of the paper: `Q₁₁ v₁ − ½ (a + b)`.

use super::typeset::{Equation, Mark, Math, composed, named};
use crate::derived::{Derived, Word};
use crate::expr::{Expr, Symbol};
use crate::formula::{Node, factored};
use crate::manifold::{Factor, Kind};
use crate::matrix::Matrix;
use std::collections::BTreeMap;

/// How a joint's symbols are written.
#[derive(Clone, Debug)]
pub struct Notation {
    by_symbol: BTreeMap<Symbol, Math>,
}

impl Notation {
    /// The notation of a joint: coordinates after their factor, ϕ, v, p and v̄ numbered.
    pub fn new(derived: &Derived) -> Self {
        let mut by_symbol = BTreeMap::new();
        let arguments = &derived.arguments;
        let factors = derived.space.manifold.factors();
        let names: Vec<Math> = factors.iter().flat_map(names_of_factor).collect();
        for (symbol, name) in arguments.configuration.iter().zip(&names) {
            by_symbol.insert(symbol.clone(), name.clone());
        }
        for (symbol, name) in arguments.target.iter().zip(&names) {
            by_symbol.insert(symbol.clone(), name.clone().raised_to(Math::Letter('′')));
        }
        let numbered = [
            (&arguments.local, Math::Letter('ϕ')),
            (&arguments.displacement, Math::Letter('ξ')),
            (&arguments.velocity, Math::Letter('v')),
            (&arguments.momentum, Math::Letter('p')),
            (&arguments.speeds, Math::Letter('v').marked(Mark::Bar)),
            (&arguments.wrench, Math::Letter('h')),
        ];
        for (symbols, letter) in numbered {
            let alone = symbols.len() == 1;
            for (i, symbol) in symbols.iter().enumerate() {
                let name = match alone {
                    true => letter.clone(),
                    false => letter.clone().with_index(Math::integer(i + 1)),
                };
                by_symbol.insert(symbol.clone(), name);
            }
        }
        let mut notation = Self { by_symbol };
        for parameter in &derived.spec.parameters {
            let name = notation.unused(parameter.symbol.name());
            notation.name(&parameter.symbol, name);
        }
        let mut bases = BTreeMap::new();
        for word in &derived.words {
            let base = bases.entry(&word.base);
            let base = base
                .or_insert_with(|| notation.unused(word.base.name()))
                .clone();
            notation.name_word(word, base, &arguments.local);
        }
        notation
    }

    /// A name as mathematicians write it, or letter by letter where another is written so: `angle_2` beside `angle2`.
    fn unused(&self, name: &str) -> Math {
        let set = named(name);
        match self.by_symbol.values().any(|known| *known == set) {
            true => Math::Word(name.to_owned()),
            false => set,
        }
    }

    /// A derivative is set as one: `∂lean/∂ϕ₁`.
    fn name_word(&mut self, word: &Word, base: Math, locals: &[Symbol]) {
        let name = word.along.iter().fold(base, |name, &k| {
            let name = match name {
                Math::Partial(..) => name.grouped(),
                name => name,
            };
            Math::Partial(Box::new(name), Box::new(self.set_symbol(&locals[k])))
        });
        self.name(&word.symbol, name);
    }

    /// A symbol, set.
    pub fn set_symbol(&self, symbol: &Symbol) -> Math {
        let known = self.by_symbol.get(symbol).cloned();
        known.unwrap_or_else(|| named(symbol.name()))
    }

    /// A symbol as text.
    pub fn symbol(&self, symbol: &Symbol) -> String {
        self.set_symbol(symbol).text()
    }

    /// Gives a symbol a name.
    pub fn name(&mut self, symbol: &Symbol, name: Math) {
        self.by_symbol.insert(symbol.clone(), name);
    }

    /// An expression, set with common factors pulled out.
    pub fn set(&self, expression: &Expr) -> Math {
        self.formula(&factored(expression).polished())
    }

    /// A formula, set as it stands.
    pub fn formula(&self, node: &Node) -> Math {
        composed(node, &|symbol| self.set_symbol(symbol))
    }

    /// `left = matrix`, short where the matrix is 0, I or a scalar.
    pub fn equation(&self, left: Math, matrix: &Matrix) -> Equation {
        let mut room = usize::MAX;
        let right = self.matrix(matrix, &mut room);
        Equation {
            left,
            right: right.unwrap_or_else(|| Math::integer(0)),
        }
    }

    /// The same where it has room: `room` then shrinks by the size of the right side.
    pub fn equation_within(
        &self,
        left: Math,
        matrix: &Matrix,
        room: &mut usize,
    ) -> Option<Equation> {
        let right = self.matrix(matrix, room)?;
        Some(Equation { left, right })
    }

    fn matrix(&self, matrix: &Matrix, room: &mut usize) -> Option<Math> {
        let is_square = matrix.rows() == matrix.columns();
        let mut within = |part: Math| {
            *room = room.checked_sub(part.size())?;
            Some(part)
        };
        match matrix.entries() {
            _ if matrix.is_zero() => within(Math::integer(0)),
            [only] => within(self.set(only)),
            _ if is_square && matrix.is_identity() => within(Math::Letter('I')),
            entries => {
                let entries = entries.iter().map(|entry| within(self.set(entry)));
                Some(Math::Matrix(
                    matrix.columns(),
                    entries.collect::<Option<_>>()?,
                ))
            }
        }
    }
}

/// The stored scalars of a factor: `Q₁₁`, `q.w`, `θ`.
fn names_of_factor(factor: &Factor) -> Vec<Math> {
    let name = named(&factor.name);
    let entries = |rows: usize, columns: usize| -> Vec<Math> {
        let index = |n: usize| {
            let (i, j) = (n / columns + 1, n % columns + 1);
            name.clone().with_index(Math::integer(10 * i + j))
        };
        (0..rows * columns).map(index).collect()
    };
    let parts = |letters: &str| -> Vec<Math> {
        let part = |letter| Math::Part(Box::new(name.clone()), letter);
        letters.chars().map(part).collect()
    };
    match factor.kind {
        Kind::Real(1) => vec![name],
        Kind::Real(size) => (1..=size)
            .map(|n| name.clone().with_index(Math::integer(n)))
            .collect(),
        Kind::S1 => parts("cs"),
        Kind::S3 => parts("wxyz"),
        Kind::S2 => parts("xyz"),
        Kind::So2 => entries(2, 2),
        Kind::Se2 => entries(2, 3),
        Kind::So3 => entries(3, 3),
        Kind::Se3 => entries(3, 4),
    }
}
