//! Systems of equations that are tridiagonal in blocks of one or two rows, in rational numbers.
//!
//! Of a long table numbers would grow without bound: what is longer than [`LONGEST`] bits is rounded to [`KEPT`] bits, and the derivatives of the curve that
//! are not given at its knots are then continuous to so many.

use crate::expr::Rational;
use num_bigint::BigInt;
use num_traits::{One, Signed, Zero};

/// Bits of numerator and denominator together beyond which a number is rounded.
const LONGEST: u64 = 1024;
/// Bits of what is rounded, of 1 or of itself where that is larger.
const KEPT: u64 = 320;

/// A row.
pub(super) type Numbers = Vec<Rational>;
/// Rows of equal length.
pub(super) type Block = Vec<Numbers>;

/// Equations of one knot: `before · u_{i−1} + own · u_i + after · u_{i+1} = right`.
pub(super) struct Equations {
    pub before: Block,
    pub own: Block,
    pub after: Block,
    pub right: Block,
}
/// A number as it is, or rounded where it is long.
pub(super) fn kept(value: Rational) -> Rational {
    if value.bits() <= LONGEST {
        return value;
    }
    let (above, below) = (value.numer(), value.denom());
    let size = above.bits().saturating_sub(below.bits());
    let scale = BigInt::one() << (KEPT.saturating_sub(size));
    let half: BigInt = &below >> 1;
    let rounded = (above.abs() * &scale + half) / below;
    let sign = if above.is_negative() { -1 } else { 1 };
    Rational::new(rounded * sign, scale)
}

pub(super) fn zeros(size: usize) -> Block {
    vec![vec![Rational::zero(); size]; size]
}

fn product(a: &Block, b: &Block) -> Block {
    let entry = |row: &Numbers, column: usize| -> Rational {
        row.iter().zip(b).map(|(a, b)| a * &b[column]).sum()
    };
    let columns = b.first().map_or(0, Vec::len);
    a.iter()
        .map(|row| (0..columns).map(|j| kept(entry(row, j))).collect())
        .collect()
}

fn minus(a: &Block, b: &Block) -> Block {
    let row = |(a, b): (&Numbers, &Numbers)| a.iter().zip(b).map(|(a, b)| a - b).collect();
    a.iter().zip(b).map(row).collect()
}

/// Blocks side by side.
fn beside(a: &Block, b: &Block) -> Block {
    let row = |(a, b): (&Numbers, &Numbers)| a.iter().chain(b).cloned().collect();
    a.iter().zip(b).map(row).collect()
}

/// The columns of a block in a range.
fn columns(block: &Block, range: std::ops::Range<usize>) -> Block {
    block
        .iter()
        .map(|row| row[range.clone()].to_vec())
        .collect()
}

/// The inverse of one or two rows; `None` where there is none.
fn inverse(block: &Block) -> Option<Block> {
    let reciprocal = |x: &Rational| (!x.is_zero()).then(|| x.recip());
    match block.as_slice() {
        [row] => Some(vec![vec![reciprocal(&row[0])?]]),
        [first, second] => {
            let (a, b, c, d) = (&first[0], &first[1], &second[0], &second[1]);
            let scale = reciprocal(&(a * d - b * c))?;
            let row = |x: &Rational, y: &Rational| vec![kept(x * &scale), kept(y * &scale)];
            Some(vec![row(d, &-b), row(&-c, a)])
        }
        _ => None,
    }
}

/// Elimination block by block, of all columns of the right side at once (L. H. Thomas).
pub(super) fn solve(equations: Vec<Equations>) -> Option<Vec<Block>> {
    let mut eliminated: Vec<(Block, Block)> = Vec::with_capacity(equations.len());
    for row in &equations {
        let (own, right) = match eliminated.last() {
            None => (row.own.clone(), row.right.clone()),
            Some((after, value)) => (
                minus(&row.own, &product(&row.before, after)),
                minus(&row.right, &product(&row.before, value)),
            ),
        };
        let inverse = inverse(&own)?;
        eliminated.push((product(&inverse, &row.after), product(&inverse, &right)));
    }
    let mut solution: Vec<Block> = vec![];
    for (after, value) in eliminated.into_iter().rev() {
        let own = match solution.last() {
            None => value,
            Some(next) => minus(&value, &product(&after, next)),
        };
        solution.push(own);
    }
    solution.reverse();
    Some(solution)
}

/// The same where the first and the last knot are neighbours: all others as functions of the last one first.
pub(super) fn solve_cyclic(mut equations: Vec<Equations>) -> Option<Vec<Block>> {
    let last = equations.pop()?;
    let size = last.own.len();
    let count = equations.len();
    for (i, row) in equations.iter_mut().enumerate() {
        // Beside each right side, what the last knot's unknowns add to it.
        let mut of_last = zeros(size);
        if i == 0 {
            of_last = minus(&of_last, &row.before);
        }
        if i + 1 == count {
            of_last = minus(&of_last, &row.after);
        }
        row.right = beside(&row.right, &of_last);
    }
    let others = solve(equations)?;
    let (first, neighbour) = (others.first()?, others.last()?);
    let effect = |block: &Block, of: &Block, range| product(block, &columns(of, range));
    let constant = minus(
        &minus(&last.right, &effect(&last.after, first, 0..1)),
        &effect(&last.before, neighbour, 0..1),
    );
    let negative = minus(
        &minus(&zeros(size), &effect(&last.after, first, 1..size + 1)),
        &effect(&last.before, neighbour, 1..size + 1),
    );
    let own = minus(&last.own, &negative);
    let end = product(&inverse(&own)?, &constant);
    let mut solution: Vec<Block> = others
        .iter()
        .map(|other| {
            let change = product(&columns(other, 1..size + 1), &end);
            let negated = minus(&zeros_of(&change), &change);
            minus(&columns(other, 0..1), &negated)
        })
        .collect();
    solution.push(end);
    Some(solution)
}

fn zeros_of(block: &Block) -> Block {
    let row = |row: &Numbers| vec![Rational::zero(); row.len()];
    block.iter().map(row).collect()
}
