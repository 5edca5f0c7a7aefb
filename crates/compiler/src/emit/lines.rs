//! What a function consists of once it is lowered: formulas, lines, loops.

use crate::alike::Read;
use crate::graph::Operations;
use hamel_codegen::derived::Primitive;
use hamel_codegen::expr::Function as Known;

/// An index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The same always.
    Known(usize),
    /// In a loop: `start + step i` in its turn i.
    Along {
        /// Of the first turn.
        start: i64,
        /// From turn to turn.
        step: i64,
    },
    /// In a loop: `offset` more than the entry of a column of its table.
    Listed {
        /// The column.
        column: usize,
        /// What is added.
        offset: i64,
    },
}

impl Place {
    /// `by` further on.
    #[must_use]
    pub fn plus(self, by: i64) -> Self {
        match self {
            Self::Known(place) => Self::Known(place.saturating_add_signed(by as isize)),
            Self::Along { start, step } => Self::Along {
                start: start + by,
                step,
            },
            Self::Listed { column, offset } => Self::Listed {
                column,
                offset: offset + by,
            },
        }
    }
}

/// A formula of one line.
#[derive(Clone, Debug, PartialEq)]
pub enum Formula {
    /// A number.
    Number(f64),
    /// In a loop: a number of its table, by column.
    Column(usize),
    /// An entry of an argument, or of the sines and cosines of all angles.
    Input(Read, Place),
    /// In a loop over states side by side: an entry of an array of theirs, by its name and place.
    Lane(String, usize),
    /// In a loop: what another block left, by the loop's name for its row and the entry.
    Source(String, usize),
    /// What a block left: length of the row, row, entry.
    Row(usize, usize, usize),
    /// A value of an earlier line.
    Name(String),
    /// Terms; those marked true are subtracted.
    Sum(Vec<(bool, Formula)>),
    /// Two factors.
    Product(Box<Formula>, Box<Formula>),
    /// A quotient.
    Quotient(Box<Formula>, Box<Formula>),
    /// The opposite.
    Negative(Box<Formula>),
    /// A function.
    Call(Known, Vec<Formula>),
    /// A function of the runtime with several results.
    Several(Primitive, Vec<Formula>),
    /// One of the results that a name stands for.
    Part(Box<Formula>, usize),
    /// Four numbers side by side.
    Gathered(Vec<Formula>),
}

impl Formula {
    /// The opposite.
    #[must_use]
    pub fn negated(self) -> Self {
        match self {
            Self::Negative(inner) => *inner,
            Self::Number(number) => Self::Number(-number),
            Self::Sum(terms) => Self::Sum(
                terms
                    .into_iter()
                    .map(|(minus, term)| (!minus, term))
                    .collect(),
            ),
            Self::Product(a, b) if matches!(*a, Self::Number(_)) => {
                Self::Product(Box::new(a.negated()), b)
            }
            Self::Product(a, b) if matches!(*b, Self::Number(_)) => {
                Self::Product(a, Box::new(b.negated()))
            }
            other => Self::Negative(Box::new(other)),
        }
    }

    /// The terms of a sum in the order in which they are added: what is no product before products, which multiply–adds take, and what is
    /// positive before what is not, so that no sign stands alone.
    pub fn in_order(terms: &[(bool, Self)]) -> Vec<&(bool, Self)> {
        let mut terms: Vec<&(bool, Self)> = terms.iter().collect();
        let is_product = |term: &(bool, Self)| matches!(term.1, Self::Product(..));
        terms.sort_by_key(|term| (is_product(term), term.0));
        terms
    }

    /// Visits the formula and all that stands in it.
    pub fn each<'f>(&'f self, visit: &mut impl FnMut(&'f Self)) {
        visit(self);
        match self {
            Self::Sum(terms) => terms.iter().for_each(|(_, term)| term.each(visit)),
            Self::Product(a, b) | Self::Quotient(a, b) => {
                a.each(visit);
                b.each(visit);
            }
            Self::Negative(of) | Self::Part(of, _) => of.each(visit),
            Self::Call(_, arguments) | Self::Several(_, arguments) | Self::Gathered(arguments) => {
                arguments.iter().for_each(|argument| argument.each(visit));
            }
            Self::Number(_)
            | Self::Column(_)
            | Self::Input(..)
            | Self::Lane(..)
            | Self::Source(..)
            | Self::Row(..)
            | Self::Name(_) => {}
        }
    }

    /// Whether it computes anything.
    pub fn computes(&self) -> bool {
        !matches!(
            self,
            Self::Number(_)
                | Self::Column(_)
                | Self::Input(..)
                | Self::Lane(..)
                | Self::Source(..)
                | Self::Row(..)
                | Self::Name(_)
                | Self::Part(..)
                | Self::Gathered(_)
        )
    }
}

/// What stands above a part of the lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Heading {
    /// Name of the body.
    pub body: String,
    /// What of it.
    pub topic: &'static str,
    /// The operations below it.
    pub operations: Operations,
}

/// A row of values that a block leaves for others.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Where it stands in the array for rows of its length.
    pub place: Place,
    /// The values.
    pub values: Vec<Formula>,
}

/// Like blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Loop {
    /// Name of its tables: an identifier.
    pub name: String,
    /// Which bodies it is about.
    pub bodies: Vec<String>,
    /// Indices that follow no rule: one row a turn.
    pub places: Vec<Vec<usize>>,
    /// Numbers in which the blocks differ: one row a turn.
    pub numbers: Vec<Vec<f64>>,
    /// What it reads of other blocks: a name, the length of the row, which.
    pub sources: Vec<(String, usize, Place)>,
    /// What it computes.
    pub lines: Vec<Line>,
}

impl Line {
    /// Visits its formulas, those in a loop too.
    pub fn each_formula<'f>(&'f self, visit: &mut impl FnMut(&'f Formula)) {
        match self {
            Self::Heading(_) => {}
            Self::Value(_, formula)
            | Self::SinCos(.., formula)
            | Self::Result(_, formula)
            | Self::Extracted(_, formula) => {
                formula.each(visit);
            }
            Self::SinCosAll(all) => all.iter().for_each(|(.., angle)| angle.each(visit)),
            Self::Angles(formulas)
            | Self::Row(Row {
                values: formulas, ..
            }) => {
                formulas.iter().for_each(|formula| formula.each(visit));
            }
            Self::Loop(turn) => turn.lines.iter().for_each(|line| line.each_formula(visit)),
        }
    }
}

/// One line.
#[derive(Clone, Debug, PartialEq)]
pub enum Line {
    /// What follows.
    Heading(Heading),
    /// A name for a value.
    Value(String, Formula),
    /// Names for sine and cosine of one angle.
    SinCos(String, String, Formula),
    /// The same for several angles at once.
    SinCosAll(Vec<(String, String, Formula)>),
    /// Sines and cosines of several angles as arrays.
    Angles(Vec<Formula>),
    /// Values for other blocks.
    Row(Row),
    /// A result of the function.
    Result(Place, Formula),
    /// Like blocks.
    Loop(Loop),
    /// Names for the first numbers of those that are side by side.
    Extracted(Vec<String>, Formula),
}
