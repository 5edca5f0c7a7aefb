//! The linear systems `∂φ N x = r` of the relations in closed form, by Cramer's rule, with names for what is long or occurs often.

use crate::expr::{Expr, Monomial, Rational, Role, Symbol};
use crate::kernel::Word;
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use std::collections::BTreeMap;

/// First index of the symbols made here, above those of `let`s and below those of their derivatives.
const FIRST_INDEX: usize = 0x5000;

/// Most terms of an entry, a minor or a determinant that has no name of its own.
pub const LONGEST: usize = 2;

/// Names with their values, each made of those before it.
pub struct Names<'a> {
    ideal: &'a Ideal,
    pub words: Vec<Word>,
}

impl<'a> Names<'a> {
    pub fn new(ideal: &'a Ideal) -> Self {
        let words = vec![];
        Self { ideal, words }
    }

    /// A name for the value.
    pub fn named(&mut self, name: &str, value: Expr) -> Symbol {
        let symbol = Symbol::new(Role::Intermediate, FIRST_INDEX + self.words.len(), name);
        self.words.push(Word {
            base: symbol.clone(),
            symbol: symbol.clone(),
            value,
            along: vec![],
            rates: vec![],
        });
        symbol
    }

    /// The value in its shorter form; its name where that has more terms than `longest`.
    pub fn if_long(&mut self, name: &str, value: &Expr, longest: usize) -> Expr {
        let value = self.ideal.simplest(value);
        let is_long = value.terms().len() > longest;
        match is_long {
            true => Expr::symbol(&self.named(name, value)),
            false => value,
        }
    }
}

/// A square matrix with its inverse as that of its minors over its determinant.
pub struct Inverse {
    adjugate: Matrix,
    reciprocal: Expr,
}

impl Inverse {
    /// The inverse of a matrix whose rows and columns have these names; `None` where the determinant is 0.
    pub fn new(matrix: &Matrix, labels: Labels<'_>, names: &mut Names<'_>) -> Option<Self> {
        let all: Vec<usize> = (0..matrix.rows()).collect();
        let determinant = Minors::new(matrix, labels).expanded(&all, &all, names);
        let determinant = names.ideal.simplest(&determinant);
        Self::over(&determinant, matrix, labels, names)
    }

    /// The same where the determinant is known.
    pub fn over(
        determinant: &Expr,
        matrix: &Matrix,
        labels: Labels<'_>,
        names: &mut Names<'_>,
    ) -> Option<Self> {
        let size = matrix.rows();
        let mut minors = Minors::new(matrix, labels);
        let without = |n: usize| (0..size).filter(|&other| other != n).collect::<Vec<_>>();
        let mut adjugate = vec![];
        for (i, j) in (0..size).flat_map(|i| (0..size).map(move |j| (i, j))) {
            let minor = minors.get(&without(j), &without(i), names);
            adjugate.push(if (i + j) % 2 == 0 { minor } else { -minor });
        }
        let (content, core) = without_content(determinant);
        let core = core.recip()?;
        let core = match determinant.terms().len() > LONGEST {
            true => Expr::symbol(&names.named("per_determinant", core)),
            false => core,
        };
        Some(Self {
            adjugate: Matrix::from_entries(size, size, adjugate)?,
            reciprocal: &content.recip()? * &core,
        })
    }

    /// The reciprocal of the determinant.
    pub fn reciprocal(&self) -> &Expr {
        &self.reciprocal
    }

    /// The inverse times a column.
    pub fn times(&self, right: &[Expr]) -> Vec<Expr> {
        let solved = self.adjugate.times(&Matrix::column_vector(right.to_vec()));
        solved.scale(&self.reciprocal).entries().to_vec()
    }
}

/// Names of the rows and of the columns of a matrix.
pub type Labels<'a> = (&'a [String], &'a [String]);

/// Minors of a matrix, each found once, by expansion along its first row.
pub struct Minors<'a> {
    matrix: &'a Matrix,
    labels: Labels<'a>,
    known: BTreeMap<(Vec<usize>, Vec<usize>), Expr>,
}

impl<'a> Minors<'a> {
    /// Those of a matrix whose rows and columns have these names.
    pub fn new(matrix: &'a Matrix, labels: Labels<'a>) -> Self {
        let known = BTreeMap::new();
        Self {
            matrix,
            labels,
            known,
        }
    }

    /// The minor of these rows and columns, or its name.
    fn get(&mut self, rows: &[usize], columns: &[usize], names: &mut Names<'_>) -> Expr {
        let key = (rows.to_vec(), columns.to_vec());
        if let Some(known) = self.known.get(&key) {
            return known.clone();
        }
        let value = self.expanded(rows, columns, names);
        let of = |labels: &[String], places: &[usize]| {
            let labels: Vec<&str> = places.iter().map(|&n| &*labels[n]).collect();
            labels.join("_")
        };
        let name = format!(
            "minor_{}_of_{}",
            of(self.labels.0, rows),
            of(self.labels.1, columns)
        );
        let minor = match rows.len() {
            0 | 1 => value,
            _ => names.if_long(&name, &value, LONGEST),
        };
        self.known.insert(key, minor.clone());
        minor
    }

    /// The minor of these rows and columns, of smaller ones or of their names.
    pub fn expanded(&mut self, rows: &[usize], columns: &[usize], names: &mut Names<'_>) -> Expr {
        let [first, rest @ ..] = rows else {
            return Expr::one();
        };
        let mut sum = Expr::zero();
        for (place, &column) in columns.iter().enumerate() {
            let entry = self.matrix.at(*first, column).clone();
            if entry.is_zero() {
                continue;
            }
            let others: Vec<usize> = columns.iter().copied().filter(|&c| c != column).collect();
            let term = &entry * &self.get(rest, &others, names);
            match place % 2 {
                0 => sum += &term,
                _ => sum -= &term,
            }
        }
        sum
    }
}

/// The parameters that all terms of a sum share, and the sum without them.
pub fn without_content(sum: &Expr) -> (Expr, Expr) {
    let one = Rational::from(1);
    let monomials: Vec<&Monomial> = sum.terms().map(|(monomial, _)| monomial).collect();
    let Some((first, others)) = monomials.split_first() else {
        return (Expr::one(), sum.clone());
    };
    let powers = first.units().iter();
    let shared = powers.map(|(atom, power)| {
        let least = others.iter().map(|other| other.power(atom)).min();
        (
            atom.clone(),
            least.map_or(*power, |least| least.min(*power)),
        )
    });
    let content = shared.fold(Expr::one(), |product, (atom, power)| {
        let factor = Expr::atom(atom);
        match u32::try_from(power) {
            Ok(power) => &product * &factor.pow(power),
            Err(_) => product,
        }
    });
    let inverse = content.recip().unwrap_or_else(Expr::one);
    let inverse = inverse.leading().map(|(monomial, _)| monomial.clone());
    let core = sum.scaled(&one, &inverse.unwrap_or_else(Monomial::one));
    (content, core)
}
