//! Enclosures of curves: of each polynomial on the part of its piece in which the argument may lie, by S. Bernstein's coefficients.

use super::{Interval, larger, smaller};
use crate::expr::curve::{Curve, Outside};
use crate::expr::{Number, Rational};
use crate::precise::Precise;
use num_traits::{One, Zero};

/// Periods beyond which their number is not sure.
const MOST_PERIODS: f64 = 1e12;

/// What the derivative of this order can be.
pub(super) fn enclosed(curve: Curve, x: &Interval, order: u8) -> Interval {
    let unit = Interval::point(x.low().same(1));
    let argument = curve.in_unit_of_knots(x);
    let enclosure = Enclosed { curve, order, unit };
    let value = match curve.definition().outside {
        Outside::Periodic => enclosure.periodic(&argument),
        _ if !argument.is_bounded() => enclosure.unbounded(),
        Outside::Undefined if !enclosure.holds(&argument) => None,
        _ => enclosure.between_ends(&argument),
    };
    match value {
        Some(value) => curve.in_unit_of_values(value, order),
        None => Interval::whole(x.bits()),
    }
}

/// What the derivative of this order can be wherever the curve has a value, in numbers of so many bits.
pub fn range(curve: Curve, order: u8, bits: usize) -> Interval {
    let unit = Interval::point(Precise::integer(1, bits));
    let enclosure = Enclosed { curve, order, unit };
    match enclosure.everywhere() {
        Some(value) => curve.in_unit_of_values(value, order),
        None => Interval::whole(bits),
    }
}

/// One derivative of a curve, and the number 1 of the precision.
struct Enclosed {
    curve: Curve,
    order: u8,
    unit: Interval,
}

impl Enclosed {
    fn number(&self, value: &Rational) -> Interval {
        self.unit.rational(value)
    }

    /// Whether the argument is between the ends; where rounding leaves that open, not.
    fn holds(&self, argument: &Interval) -> bool {
        let (first, last) = self.curve.ends();
        let first = self.number(first);
        let last = self.number(last);
        let inside = |a: &Precise, b: &Precise| a.compare(b).is_some_and(|order| order.is_le());
        inside(first.high(), argument.low()) && inside(argument.high(), last.low())
    }

    /// Of an argument that may be any number.
    fn unbounded(&self) -> Option<Interval> {
        match self.curve.definition().outside {
            Outside::Straight => self.everywhere(),
            _ => None,
        }
    }

    /// Wherever the curve has a value.
    fn everywhere(&self) -> Option<Interval> {
        let (first, last) = self.curve.ends();
        let ends = [first, last].map(|end| self.number(end));
        let inside = self.between_ends(&hull(ends)?)?;
        match (self.curve.definition().outside, self.order) {
            (Outside::Undefined | Outside::Periodic, _) => Some(inside),
            // The slopes beyond the ends are those at the ends.
            (Outside::Straight, 1) => Some(inside),
            (Outside::Straight, 2..) => hull([inside, self.number(&Rational::zero())]),
            _ => None,
        }
    }

    fn periodic(&self, argument: &Interval) -> Option<Interval> {
        let (first, last) = self.curve.ends();
        let period = last - first;
        if !argument.is_bounded() {
            return self.everywhere();
        }
        let from_first = argument.plus(&self.number(&-first));
        let periods = from_first.over(&self.number(&period));
        let (low, high) = (periods.low().to_f64(), periods.high().to_f64());
        let many = !(low.abs() < MOST_PERIODS && high.abs() < MOST_PERIODS);
        if many || high - low >= 1.0 {
            return self.everywhere();
        }
        // A double this far from its limit moves by less than 1: a period more on either side only widens the enclosure.
        let (before, after) = (low.floor() as i64 - 1, high.floor() as i64 + 1);
        let parts = (before..=after).filter_map(|n| {
            let moved = &period * &Rational::from(-n);
            let moved = argument.plus(&self.number(&moved));
            let ends = hull([first, last].map(|end| self.number(end)))?;
            self.between_ends(&common(&moved, &ends)?)
        });
        hull(parts)
    }

    /// On all pieces, and beyond the ends as the curve goes on there.
    fn between_ends(&self, argument: &Interval) -> Option<Interval> {
        let definition = self.curve.definition();
        let knots = &definition.knots;
        let last = knots.len() - 2;
        let goes_on = definition.outside == Outside::Polynomial;
        let on_pieces = (0..=last).filter_map(|piece| {
            let (from, to) = (self.number(&knots[piece]), self.number(&knots[piece + 1]));
            let side = Interval {
                low: match goes_on && piece == 0 {
                    true => smaller(from.low().clone(), argument.low().clone()),
                    false => from.low().clone(),
                },
                high: match goes_on && piece == last {
                    true => larger(to.high().clone(), argument.high().clone()),
                    false => to.high().clone(),
                },
            };
            let part = common(argument, &side)?;
            let t = part.plus(&self.number(&-&knots[piece]));
            self.polynomial(piece, &t)
        });
        let beyond = [false, true].into_iter().filter_map(|above| {
            (definition.outside == Outside::Straight).then(|| self.straight(argument, above))?
        });
        hull(on_pieces.chain(beyond))
    }

    /// On the part of the argument beyond an end.
    fn straight(&self, argument: &Interval, above: bool) -> Option<Interval> {
        let (first, last) = self.curve.ends();
        let end = self.number(if above { last } else { first });
        let side = match above {
            true => Interval {
                low: end.low().clone(),
                high: larger(end.high().clone(), argument.high().clone()),
            },
            false => Interval {
                low: smaller(end.low().clone(), argument.low().clone()),
                high: end.high().clone(),
            },
        };
        let part = common(argument, &side)?;
        let [value, slope] = self.curve.at_end(above).map(|value| self.number(&value));
        Some(match self.order {
            0 => value.plus(&slope.times(&part.plus(&end.negative()))),
            1 => slope,
            _ => self.number(&Rational::zero()),
        })
    }

    /// The polynomial on an interval: moved to its lower end, the interval made [0, 1], its values lie between Bernstein's coefficients.
    fn polynomial(&self, piece: usize, t: &Interval) -> Option<Interval> {
        let start = Interval::point(t.low().clone());
        let width = Interval::point(t.high().clone()).plus(&start.negative());
        let mut powers: Vec<Interval> = self
            .curve
            .slopes(piece, self.order)
            .iter()
            .map(|coefficient| self.number(coefficient))
            .collect();
        let degree = powers.len().checked_sub(1)?;
        for first in 0..degree {
            for place in (first..degree).rev() {
                powers[place] = powers[place].plus(&start.times(&powers[place + 1]));
            }
        }
        let mut scale = self.unit.clone();
        for power in &mut powers {
            *power = power.times(&scale);
            scale = scale.times(&width);
        }
        hull((0..=degree).map(|j| self.bernstein(&powers, j)))
    }

    /// `Σ_{k ≤ j} binomial(j, k) / binomial(n, k) a_k`.
    fn bernstein(&self, powers: &[Interval], j: usize) -> Interval {
        let degree = powers.len() - 1;
        let mut weight = Rational::one();
        let mut sum = powers[0].clone();
        for (k, power) in powers.iter().enumerate().take(j + 1).skip(1) {
            let [above, below] = [j, degree].map(|n| Rational::from((n + 1 - k) as i64));
            weight = weight * above / below;
            sum = sum.plus(&power.times(&self.number(&weight)));
        }
        sum
    }
}

/// The smallest interval that holds all; `None` of none.
fn hull(parts: impl IntoIterator<Item = Interval>) -> Option<Interval> {
    parts.into_iter().reduce(|a, b| Interval {
        low: smaller(a.low, b.low),
        high: larger(a.high, b.high),
    })
}

/// What two intervals have in common; `None` where that is nothing.
fn common(a: &Interval, b: &Interval) -> Option<Interval> {
    let low = larger(a.low.clone(), b.low.clone());
    let high = smaller(a.high.clone(), b.high.clone());
    let order = low.compare(&high)?;
    order.is_le().then_some(Interval { low, high })
}

#[cfg(test)]
mod tests;
