//! Curves: functions of one variable that are one polynomial with rational coefficients between each two knots.
//!
//! In expressions a curve is a function of which nothing is known but its derivatives, which are functions of their own
//! ([`Function::Curve`]): what is proved of it holds for every function that is as smooth. Where a sign or a value is asked for, all
//! arithmetics evaluate the same polynomials.

mod blocks;
mod evaluate;
mod intern;
mod spline;
mod table;
#[cfg(test)]
mod tests;

pub use evaluate::Ordered;
pub use spline::{Ends, Kind};
pub use table::Table;

use super::function::apply;
use super::{Expr, Function, Rational};
use num_traits::Zero;
use rustc_hash::FxHasher;
use std::cmp::Ordering;
use std::hash::{Hash, Hasher};

/// What a curve is beyond its first and its last knot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Outside {
    /// It has no value there.
    Undefined,
    /// It repeats itself: the distance of the first knot from the last one is its period.
    Periodic,
    /// It goes on straight.
    Straight,
    /// The polynomials of the first and of the last piece go on.
    Polynomial,
}

/// What a curve is made of.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Definition {
    /// Its name in the spec.
    pub name: String,
    /// Kind of its polynomials.
    pub kind: Kind,
    /// What it is beyond its ends.
    pub outside: Outside,
    /// Whether knots are in degrees, and the argument in radians.
    pub of_degrees: bool,
    /// Whether values at knots are in degrees, and those of the curve in radians.
    pub in_degrees: bool,
    /// Knots, ascending.
    pub knots: Vec<Rational>,
    /// Of each piece the coefficients of 1, t, t², …, with t the distance from the knot before it.
    pub pieces: Vec<Vec<Rational>>,
}

/// A curve: equal ones are one object, which is kept for ever.
#[derive(Clone, Copy)]
pub struct Curve(&'static Interned);

/// A definition with its hash, which is the same in every run.
struct Interned {
    definition: Definition,
    hash: u64,
    /// The numbers of kernels.
    table: Table,
    /// The highest power that a polynomial has: derivatives of a higher order are 0.
    highest: u8,
}

impl Curve {
    /// The curve of a definition, which has two knots or more and a polynomial between each two.
    pub fn new(definition: Definition) -> Self {
        let mut hasher = FxHasher::default();
        definition.hash(&mut hasher);
        let hash = hasher.finish();
        let table = Table::new(&definition);
        let powers = definition.pieces.iter().filter_map(|coefficients| {
            let highest = coefficients.iter().rposition(|own| !own.is_zero())?;
            u8::try_from(highest).ok()
        });
        let highest = powers.max().unwrap_or(0);
        Self(intern::object(Interned {
            definition,
            hash,
            table,
            highest,
        }))
    }

    /// The curve through points: x ascending, three or more; `None` where the ends and the values make no such curve.
    pub fn through(
        definition: Definition,
        ends: &Ends,
        points: &[(Rational, Rational)],
    ) -> Option<Self> {
        let pieces = spline::pieces(definition.kind, ends, points)?;
        Some(Self::new(Definition {
            knots: points.iter().map(|(x, _)| x.clone()).collect(),
            pieces,
            ..definition
        }))
    }

    /// What it is made of.
    pub fn definition(&self) -> &'static Definition {
        &self.0.definition
    }

    /// Its name.
    pub fn name(&self) -> &'static str {
        &self.definition().name
    }

    /// Up to which order its derivatives are continuous everywhere where it has a value.
    pub fn smoothness(&self) -> u8 {
        match self.definition().outside {
            // The second derivative is 0 at the ends, and the third one jumps there.
            Outside::Straight => 2,
            _ => self.definition().kind.smoothness(),
        }
    }

    /// The first and the last knot.
    pub fn ends(&self) -> (&'static Rational, &'static Rational) {
        let knots = &self.definition().knots;
        (&knots[0], &knots[knots.len() - 1])
    }

    /// An end as an argument: in radians where knots are in degrees.
    pub fn end_as_argument(&self, last: bool) -> Expr {
        let (first, end) = self.ends();
        let end = Expr::rational(if last { end.clone() } else { first.clone() });
        match self.definition().of_degrees {
            true => &(&end * &Expr::pi()) * &Expr::fraction(1, 180),
            false => end,
        }
    }

    /// The derivative of this order at an argument; that of order 0 is the value. A number where that is a short one.
    pub fn at(&self, argument: &Expr, order: u8) -> Expr {
        if order > self.0.highest {
            return Expr::zero();
        }
        let number = self.at_number(argument, order);
        number.unwrap_or_else(|| apply(Function::Curve(*self, order), vec![argument.clone()]))
    }

    /// Its kind, its number of knots, and what it is beyond its ends.
    pub fn in_words(&self) -> String {
        let definition = self.definition();
        let kind = match definition.kind {
            Kind::Cubic => "cubic",
            Kind::Quintic => "quintic",
        };
        let outside = match definition.outside {
            Outside::Undefined => "without values beyond its ends",
            Outside::Periodic => "periodic",
            Outside::Straight => "going on straight",
            Outside::Polynomial => "going on by its last polynomials",
        };
        let count = definition.knots.len();
        format!("{kind}, through {count} knots, {outside}")
    }

    /// Whether it is the same at arguments that differ by a whole number of `turns`: of full circles.
    pub fn repeats_after(&self, turns: &Rational) -> bool {
        let (first, last) = self.ends();
        let degrees = turns * &Rational::from(360);
        let periods = degrees / (last - first);
        let definition = self.definition();
        definition.outside == Outside::Periodic
            && definition.of_degrees
            && periods.is_integer()
            && !periods.is_zero()
    }
}

impl std::fmt::Debug for Curve {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl PartialEq for Curve {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.0, other.0)
    }
}

impl Eq for Curve {}

impl PartialOrd for Curve {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Curve {
    fn cmp(&self, other: &Self) -> Ordering {
        match self == other {
            true => Ordering::Equal,
            false => self.definition().cmp(other.definition()),
        }
    }
}

impl Hash for Curve {
    fn hash<H: Hasher>(&self, state: &mut H) {
        state.write_u64(self.0.hash);
    }
}
