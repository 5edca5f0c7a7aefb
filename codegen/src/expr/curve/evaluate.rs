//! Values of curves in any arithmetic that can compare.

use super::spline::falling;
use super::{Curve, Outside};
use crate::expr::{Expr, Function, Monomial, Number, Rational};
use num_traits::Zero;

/// Longest number that takes the place of a value, in bits.
const LONGEST: u64 = 128;

/// An arithmetic of numbers that are compared.
pub trait Ordered: Number {
    /// Whether this is below the other; false where one is no number.
    fn is_below(&self, other: &Self) -> bool;
    /// The nearest double.
    fn nearest_double(&self) -> f64;
}

impl Ordered for f64 {
    fn is_below(&self, other: &Self) -> bool {
        self < other
    }
    fn nearest_double(&self) -> f64 {
        *self
    }
}

impl Curve {
    /// The derivative of an order at x, in the arithmetic of x; 0/0 where the curve has no value.
    pub fn value<N: Ordered>(&self, x: &N, order: u8) -> N {
        let (first, last) = self.ends();
        let number = |value: &Rational| x.rational(value);
        let argument = self.in_unit_of_knots(x);
        let periods = match self.definition().outside {
            Outside::Periodic => {
                let turns = argument
                    .plus(&number(&-first))
                    .over(&number(&(last - first)));
                turns.nearest_double().floor()
            }
            _ => 0.0,
        };
        let zero = number(&Rational::zero());
        // Whole numbers of periods that a double does not hold exactly leave no digit of the place in one.
        if periods.is_nan() || periods.abs() > 2_f64.powi(53) {
            return zero.over(&zero);
        }
        let moved = (last - first) * Rational::from(-(periods as i64));
        let argument = argument.plus(&number(&moved));
        let below = argument.is_below(&number(first));
        let above = number(last).is_below(&argument);
        let value = match (self.definition().outside, below || above) {
            (Outside::Undefined, true) => zero.over(&zero),
            (Outside::Straight, true) => self.straight(&argument, above, order),
            _ => self.on_piece(&argument, order),
        };
        self.in_unit_of_values(value, order)
    }

    /// The derivative of an order at an argument without symbols: exactly, where it has one value there that is no long number.
    pub(super) fn at_number(&self, argument: &Expr, order: u8) -> Option<Expr> {
        if !argument.symbols().is_empty() {
            return None;
        }
        let definition = self.definition();
        let per_degree = Expr::pi().scaled(&Rational::new(1.into(), 180.into()), &Monomial::one());
        let degrees = per_degree.recip()?;
        let argument = match definition.of_degrees {
            true => argument * &degrees,
            false => argument.clone(),
        };
        let value = self.exact(&argument.as_rational()?, order)?;
        let mut value = Expr::rational(Some(value).filter(|value| value.bits() <= LONGEST)?);
        if definition.of_degrees {
            value = &value * &degrees.pow(order.into());
        }
        Some(match definition.in_degrees {
            true => &value * &per_degree,
            false => value,
        })
    }

    /// The derivative of an order at a number in the unit of the knots; `None` where it jumps or is not defined.
    fn exact(&self, x: &Rational, order: u8) -> Option<Rational> {
        let definition = self.definition();
        let (first, last) = self.ends();
        let mut x = x.clone();
        if definition.outside == Outside::Periodic {
            let period = last - first;
            let periods = floor(&((&x - first) / &period));
            x = x - periods * &period;
        }
        let (below, above) = (x < *first, x > *last);
        match definition.outside {
            Outside::Undefined if below || above => return None,
            Outside::Straight if below || above => {
                let [value, slope] = self.at_end(above);
                let end = if above { last } else { first };
                return Some(match order {
                    0 => value + slope * (&x - end),
                    1 => slope,
                    _ => Rational::zero(),
                });
            }
            _ if order > self.smoothness() && definition.knots.contains(&x) => return None,
            _ => {}
        }
        let inner = &definition.knots[1..definition.knots.len() - 1];
        let piece = inner.partition_point(|knot| *knot <= x);
        let t = &x - &definition.knots[piece];
        let slopes = self.slopes(piece, order);
        let powers = slopes.iter().rev();
        Some(powers.fold(Rational::zero(), |sum, coefficient| sum * &t + coefficient))
    }

    /// The argument in the unit of the knots.
    pub(crate) fn in_unit_of_knots<N: Number>(&self, x: &N) -> N {
        match self.definition().of_degrees {
            true => x.times(&degrees(x)),
            false => x.clone(),
        }
    }

    /// A derivative by the argument in radians where knots are in degrees, of values in radians where they are in degrees.
    pub(crate) fn in_unit_of_values<N: Number>(&self, value: N, order: u8) -> N {
        let definition = self.definition();
        let power = match definition.of_degrees {
            true => i32::from(order),
            false => 0,
        };
        let power = power - i32::from(definition.in_degrees);
        match power {
            0 => value,
            power => value.times(&degrees(&value).power(power)),
        }
    }

    fn on_piece<N: Ordered>(&self, argument: &N, order: u8) -> N {
        let knots = &self.definition().knots;
        let inner = &knots[1..knots.len() - 1];
        let piece = inner.partition_point(|knot| !argument.is_below(&argument.rational(knot)));
        let t = argument.plus(&argument.rational(&-&knots[piece]));
        self.slopes(piece, order)
            .iter()
            .rev()
            .fold(argument.rational(&Rational::zero()), |sum, coefficient| {
                sum.times(&t).plus(&argument.rational(coefficient))
            })
    }

    fn straight<N: Ordered>(&self, argument: &N, above: bool, order: u8) -> N {
        let [value, slope] = self.at_end(above);
        let (first, last) = self.ends();
        let end = if above { last } else { first };
        let slope = argument.rational(&slope);
        match order {
            0 => argument
                .plus(&argument.rational(&-end))
                .times(&slope)
                .plus(&argument.rational(&value)),
            1 => slope,
            _ => argument.rational(&Rational::zero()),
        }
    }

    /// Value and slope at an end, in the units of the knots.
    pub(crate) fn at_end(&self, last: bool) -> [Rational; 2] {
        let knots = &self.definition().knots;
        let piece = if last { knots.len() - 2 } else { 0 };
        let t = match last {
            true => &knots[piece + 1] - &knots[piece],
            false => Rational::zero(),
        };
        [0, 1].map(|order| {
            let slopes = self.slopes(piece, order);
            let powers = slopes.iter().rev();
            powers.fold(Rational::zero(), |sum, coefficient| sum * &t + coefficient)
        })
    }

    /// The coefficients of a derivative of one polynomial, from that of 1 on.
    pub(crate) fn slopes(&self, piece: usize, order: u8) -> Vec<Rational> {
        let order = usize::from(order);
        let coefficients = self.definition().pieces[piece].iter().enumerate();
        let powers = coefficients.skip(order);
        powers
            .map(|(power, coefficient)| coefficient * &falling(power, order))
            .collect()
    }
}

/// The largest integer that is not above the number.
fn floor(number: &Rational) -> Rational {
    let towards_zero = Rational::from_integer(number.to_integer());
    match towards_zero > *number {
        true => towards_zero - Rational::from(1),
        false => towards_zero,
    }
}

/// 180/π.
fn degrees<N: Number>(unit: &N) -> N {
    let half_turn = unit.rational(&Rational::from(180));
    half_turn.over(&unit.function(Function::Pi, &[]))
}
