//! Boxes of a few variables: parameters, real coordinates, and the angles of unit complex numbers.

use crate::expr::Symbol;
use crate::manifold::Kind;
use crate::model::JointSpec;
use crate::precise::{Enclosure, Interval, Point, Precise};
use num_traits::ToPrimitive;
use std::collections::BTreeSet;

/// How far axes without an end go: nearly as far as doubles.
const FARTHEST: f64 = 1e300;
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
pub fn whole(spec: &JointSpec, symbols: &BTreeSet<Symbol>) -> (Cell, bool) {
    let mut sides: Cell = vec![];
    let mut complete = true;
    for symbol in symbols {
        match side(spec, symbol) {
            Some(side) if sides.iter().all(|known| known.axis != side.axis) => sides.push(side),
            Some(_) => {}
            None => complete = false,
        }
    }
    (sides, complete)
}

fn side(spec: &JointSpec, symbol: &Symbol) -> Option<Side> {
    if let Some(parameter) = spec.parameters.iter().find(|p| p.symbol == *symbol) {
        let end = |end: &Option<crate::model::End>| end.as_ref().and_then(|e| e.value.to_f64());
        let axis = Axis::Real(symbol.clone());
        let (low, high) = (end(&parameter.range.lower), end(&parameter.range.upper));
        let (low, high) = (low.unwrap_or(-FARTHEST), high.unwrap_or(FARTHEST));
        return Some(Side { axis, low, high });
    }
    let manifold = &spec.manifold.value;
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

/// The box cut across its longest side; `None` where its ends are next to each other.
pub fn halves(cell: &Cell) -> Option<[Cell; 2]> {
    // Sizes of all orders count alike.
    let length = |side: &Side| side.high.asinh() - side.low.asinh();
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
