//! A graph as a list of operations on rows: one row holds one number of many motions.
//!
//! Products that one sum alone reads are computed with it, so that they go through no row; they are rounded all the same, as everything else.

use hamel_codegen::derived::Primitive;
use hamel_codegen::expr::Function;

/// A row, or a number that is the same for all motions, by its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operand {
    /// A row.
    Row(u32),
    /// A number.
    Number(u32),
}

/// What is computed of two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Two {
    /// a + b.
    Add,
    /// a − b.
    Subtract,
    /// a b.
    Multiply,
    /// a / b.
    Divide,
    /// The larger.
    Larger,
}

/// What is computed of a product and a third operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Three {
    /// a b + c.
    AddTo,
    /// a b − c.
    Less,
    /// c − a b.
    From,
}

/// A function with several results.
#[derive(Clone, Debug, PartialEq)]
pub struct Several {
    /// The function.
    pub function: Primitive,
    /// Its arguments.
    pub arguments: Vec<Operand>,
    /// The rows of its results.
    pub results: Vec<u32>,
}

/// One operation, with the rows of its results. It is small: all of a program should stay in the first cache.
#[derive(Clone, Debug, PartialEq)]
pub enum Operation {
    /// Of two operands.
    Two(Two, [Operand; 2], u32),
    /// Of a product and a third: a, then b and c.
    Three(Three, u32, [Operand; 2], u32),
    /// a b + c d, or, where true, a b − c d: a and c, then b and d.
    Products(bool, [u32; 2], [Operand; 2], u32),
    /// a + b, and what its rounding lost.
    ExactSum([u32; 2], [u32; 2]),
    /// −a.
    Opposite(u32, u32),
    /// √a.
    Root(u32, u32),
    /// Sine and cosine.
    SinCos(u32, [u32; 2]),
    /// Another function of one or two.
    Call(Function, Operand, Option<Operand>, u32),
    /// A function with several results.
    Several(Box<Several>),
    /// A copy.
    Copy(Operand, u32),
}

/// A list of operations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    /// What a motion computes once.
    pub once: Vec<Operation>,
    /// What each step computes.
    pub step: Vec<Operation>,
    /// The numbers that are the same for all motions.
    pub numbers: Vec<f64>,
    /// How many rows there are. The first are those that the graph is given.
    pub rows: usize,
}

impl Operation {
    /// The rows that it reads.
    pub fn read(&self) -> Vec<u32> {
        let rows = |all: &[Operand]| {
            let rows = all.iter().filter_map(|operand| match operand {
                Operand::Row(row) => Some(*row),
                Operand::Number(_) => None,
            });
            rows.collect()
        };
        match self {
            Self::Two(_, of, _) => rows(of),
            Self::Three(_, first, others, _) => [vec![*first], rows(others)].concat(),
            Self::Products(_, first, others, _) => [first.to_vec(), rows(others)].concat(),
            Self::ExactSum(of, _) => of.to_vec(),
            Self::Opposite(of, _) | Self::Root(of, _) | Self::SinCos(of, _) => vec![*of],
            Self::Call(_, first, second, _) => {
                let both: Vec<Operand> = std::iter::once(*first).chain(*second).collect();
                rows(&both)
            }
            Self::Several(own) => rows(&own.arguments),
            Self::Copy(of, _) => rows(&[*of]),
        }
    }

    /// The rows that it writes.
    pub fn written(&self) -> Vec<u32> {
        match self {
            Self::Two(.., to)
            | Self::Three(.., to)
            | Self::Products(.., to)
            | Self::Opposite(_, to)
            | Self::Root(_, to)
            | Self::Call(.., to)
            | Self::Copy(_, to) => vec![*to],
            Self::SinCos(_, to) | Self::ExactSum(_, to) => to.to_vec(),
            Self::Several(own) => own.results.clone(),
        }
    }

    /// Gives its rows other places.
    pub fn rename(&mut self, place: &mut impl FnMut(u32) -> u32) {
        let mut operand = |operand: &mut Operand| {
            if let Operand::Row(row) = operand {
                *row = place(*row);
            }
        };
        match self {
            Self::Two(_, of, to) => {
                of.iter_mut().for_each(&mut operand);
                *to = place(*to);
            }
            Self::Three(_, first, others, to) => {
                others.iter_mut().for_each(&mut operand);
                *first = place(*first);
                *to = place(*to);
            }
            Self::Products(_, first, others, to) => {
                others.iter_mut().for_each(&mut operand);
                first.iter_mut().for_each(|row| *row = place(*row));
                *to = place(*to);
            }
            Self::Opposite(of, to) | Self::Root(of, to) => {
                *of = place(*of);
                *to = place(*to);
            }
            Self::ExactSum(of, to) => {
                of.iter_mut().for_each(|row| *row = place(*row));
                to.iter_mut().for_each(|row| *row = place(*row));
            }
            Self::SinCos(of, to) => {
                *of = place(*of);
                to.iter_mut().for_each(|to| *to = place(*to));
            }
            Self::Call(_, first, second, to) => {
                operand(first);
                second.iter_mut().for_each(&mut operand);
                *to = place(*to);
            }
            Self::Several(own) => {
                own.arguments.iter_mut().for_each(operand);
                own.results.iter_mut().for_each(|row| *row = place(*row));
            }
            Self::Copy(of, to) => {
                operand(of);
                *to = place(*to);
            }
        }
    }
}
