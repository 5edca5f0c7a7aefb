//! Boxes of a few variables: parameters, real coordinates, and the angles of unit complex numbers.

use crate::expr::{Rational, Symbol};
use crate::manifold::Kind;
use crate::model::{End, Interval as Range};
use crate::precise::{Enclosure, Interval, Point, Precise};
use crate::prepare::Prepared;
use num_bigint::BigInt;
use num_traits::ToPrimitive;
use num_traits::float::FloatCore;
use std::collections::BTreeSet;

/// How far axes without an end go: nearly as far as doubles.
const FARTHEST: f64 = 1e300;
/// The inverse hyperbolic sine of a number that is far from 0: a few thousand.
const FAR: f64 = 8.0;
/// A little more than half a turn.
const HALF_TURN: f64 = 3.2;

/// What is varied.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Axis {
    /// A parameter or a real coordinate.
    Real(Symbol),
    /// The angle of cosine and sine.
    Angle(Symbol, Symbol),
}

/// An axis with the numbers between which it lies.
#[derive(Clone, Debug)]
pub struct Side {
    pub axis: Axis,
    pub low: f64,
    pub high: f64,
}

/// A box.
pub type Cell = Vec<Side>;

/// The whole range of those of the symbols that can be varied freely, and whether these are all of them.
pub fn whole(joint: &Prepared, symbols: &BTreeSet<Symbol>) -> (Cell, bool) {
    let mut sides: Cell = vec![];
    let mut complete = true;
    for symbol in symbols {
        match side(joint, symbol) {
            Some(side) if sides.iter().all(|known| known.axis != side.axis) => sides.push(side),
            Some(_) => {}
            None => complete = false,
        }
    }
    (sides, complete)
}

/// The same without parameters that move the manifold: whoever varies these has to find the manifold again at each point.
pub fn on_one_manifold(joint: &Prepared, symbols: &BTreeSet<Symbol>) -> (Cell, bool) {
    let relations = joint.space.manifold.declared().iter();
    let moving: BTreeSet<Symbol> = relations.flat_map(|e| e.symbols()).collect();
    let fixed: BTreeSet<Symbol> = symbols.difference(&moving).cloned().collect();
    let (sides, complete) = whole(joint, &fixed);
    (sides, complete && fixed.len() == symbols.len())
}

fn side(joint: &Prepared, symbol: &Symbol) -> Option<Side> {
    if let Some(parameter) = joint.spec.parameters.iter().find(|p| p.symbol == *symbol) {
        let axis = Axis::Real(symbol.clone());
        let (low, high) = doubles_in(&parameter.range)?;
        return Some(Side { axis, low, high });
    }
    let manifold = &joint.space.manifold;
    if !manifold.declared().is_empty() {
        return None;
    }
    let factor = manifold
        .factors()
        .iter()
        .find(|f| f.coordinates.contains(symbol))?;
    match (factor.kind, factor.coordinates.as_slice()) {
        _ if factor.is_free(symbol) => Some(Side {
            axis: Axis::Real(symbol.clone()),
            low: -FARTHEST,
            high: FARTHEST,
        }),
        (Kind::S1, [c, s]) => Some(Side {
            axis: Axis::Angle(c.clone(), s.clone()),
            low: -HALF_TURN,
            high: HALF_TURN,
        }),
        _ => None,
    }
}

/// The least and the largest double in a range with its ends; none where it holds no double.
fn doubles_in(range: &Range) -> Option<(f64, f64)> {
    let included = |end: &Option<End>| {
        let included = true;
        end.clone().map(|end| End { included, ..end })
    };
    let closed = Range {
        lower: included(&range.lower),
        upper: included(&range.upper),
    };
    let inside = |x: &f64| closed.contains(&exactly(*x));
    let nearest = |end: &Option<End>| end.as_ref().and_then(|end| end.value.to_f64());
    let (low, high) = (nearest(&range.lower), nearest(&range.upper));
    let (low, high) = (low.unwrap_or(-FARTHEST), high.unwrap_or(FARTHEST));
    let low = [low, low.next_up()].into_iter().find(inside)?;
    let high = [high, high.next_down()].into_iter().find(inside)?;
    (low <= high).then_some((low, high))
}

fn exactly(x: f64) -> Rational {
    let (mantissa, exponent, sign) = x.integer_decode();
    let size = BigInt::from(mantissa) * i64::from(sign);
    let power = BigInt::from(1) << exponent.unsigned_abs();
    match exponent < 0 {
        true => Rational::new(size, power),
        false => Rational::from_integer(size * power),
    }
}

/// Confines the symbols of the axes to the box.
pub fn bind(enclosure: &mut Enclosure, cell: &[Side], bits: usize) {
    for side in cell {
        let end = |x| Precise::from_f64(x, bits);
        let range = Interval::between(end(side.low), end(side.high));
        match &side.axis {
            Axis::Real(symbol) => enclosure.bind(symbol, range),
            Axis::Angle(c, s) => {
                enclosure.bind(c, range.cos());
                enclosure.bind(s, range.sin());
            }
        }
    }
}

/// Moves the point to the middle of the box.
pub fn move_to_middle(point: &mut Point, cell: &[Side]) {
    let bits = point.bits();
    for side in cell {
        let middle = Precise::from_f64(middle(side.low, side.high), bits);
        match &side.axis {
            Axis::Real(symbol) => point.bind(symbol, middle),
            Axis::Angle(c, s) => {
                point.bind(c, middle.cos());
                point.bind(s, middle.sin());
            }
        }
    }
}

/// How far a box is from 0.
pub fn extent(cell: &[Side]) -> f64 {
    let far = |side: &Side| side.low.abs().max(side.high.abs()).asinh();
    cell.iter().map(far).sum()
}

/// The length of a side, where sizes of all orders count alike.
fn length(side: &Side) -> f64 {
    side.high.asinh() - side.low.asinh()
}

/// The length of the longest side, far from 0 as part of a distance that grows faster than that.
pub fn weighted_length(cell: &[Side]) -> f64 {
    let longest = cell.iter().map(length).fold(0.0, f64::max);
    longest / (1.0 + (extent(cell) / FAR).powi(2))
}

/// The box cut across its longest side; `None` where its ends are next to each other.
pub fn halves(cell: &Cell) -> Option<[Cell; 2]> {
    let longest = (0..cell.len()).max_by(|a, b| length(&cell[*a]).total_cmp(&length(&cell[*b])))?;
    let (low, high) = (cell[longest].low, cell[longest].high);
    let cut = middle(low, high);
    if !(low < cut && cut < high) {
        return None;
    }
    let mut halves = [cell.clone(), cell.clone()];
    halves[0][longest].high = cut;
    halves[1][longest].low = cut;
    Some(halves)
}

/// A number between two: 0 between numbers of different signs, the geometric mean of those of different sizes, else the middle.
fn middle(low: f64, high: f64) -> f64 {
    match (low < 0.0, high > 0.0) {
        (true, true) => 0.0,
        (true, false) => -between_sizes(-high, -low),
        _ => between_sizes(low, high),
    }
}

fn between_sizes(low: f64, high: f64) -> f64 {
    if low == 0.0 {
        // Sizes below any number are infinitely many: few cuts lead far down.
        let square = high * high;
        return match high > 2.0 {
            true => 1.0,
            false if high > 0.5 || square < f64::MIN_POSITIVE => high / 2.0,
            false => square,
        };
    }
    match high > 4.0 * low {
        true => low.sqrt() * high.sqrt(),
        false => low + (high - low) / 2.0,
    }
}
