//! Curves: functions of one variable through knots, as joints declare them for cams, rails and measured linkages.
//!
//! A curve is one polynomial between each two knots. The piece is searched for with the plain value of the argument; derivatives are those of its polynomial,
//! of any order, so that one table serves every scalar ([`Scalar::curve`]).

use crate::scalar::Scalar;
use num_traits::Float;

/// What a curve is beyond its first and its last knot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    /// It has no value there: NaN.
    Undefined,
    /// It repeats itself: the distance of the first knot from the last one is its period.
    Periodic,
    /// It goes on straight, with the slope that it has at the end.
    Straight,
    /// The polynomials of the first and of the last piece go on.
    Polynomial,
}

/// A function of one variable by polynomials between knots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    knots: &'static [f64],
    coefficients: &'static [f64],
    outside: Outside,
}

/// Where an argument lies.
struct Place {
    /// Number of the polynomial.
    piece: usize,
    /// How many periods it is beyond the first one.
    periods: f64,
    /// Whether it is beyond an end from which the curve goes on straight.
    straight: bool,
}

impl Curve {
    /// The curve with these knots, ascending, and of each piece the coefficients of 1, t, t², … with t the distance from the knot before it.
    ///
    /// # Panics
    /// Fewer than two knots, and coefficients that do not make one polynomial for each piece: a constant of this type is refused by the compiler then.
    pub const fn new(
        knots: &'static [f64],
        coefficients: &'static [f64],
        outside: Outside,
    ) -> Self {
        assert!(knots.len() >= 2, "a curve has at least two knots");
        let pieces = knots.len() - 1;
        assert!(
            coefficients.len() >= 2 * pieces && coefficients.len().is_multiple_of(pieces),
            "a curve has as many coefficients for each piece, two or more"
        );
        Self {
            knots,
            coefficients,
            outside,
        }
    }

    /// The value at `x`; NaN where there is none.
    #[inline]
    pub fn at<T: Scalar>(&self, x: T) -> T {
        x.curve(self, 0)
    }

    /// The derivative of this order at `x`; at a knot where it jumps, that on the right. NaN where the curve has no value.
    #[inline]
    pub fn derivative<T: Scalar>(&self, x: T, order: usize) -> T {
        x.curve(self, order)
    }

    /// A derivative in the arithmetic of `x`, of which `plain` is the value.
    pub(crate) fn evaluate<T: Scalar>(&self, x: T, plain: f64, order: usize) -> T {
        let Some(place) = self.place(plain) else {
            return T::from_f64(f64::NAN);
        };
        let (first, last) = self.ends();
        let moved = x - (T::from_f64(last) - T::from_f64(first)) * T::from_f64(place.periods);
        let knot = self.knots[place.piece];
        if !place.straight {
            return polynomial(
                self.coefficients_of(place.piece),
                moved - T::from_f64(knot),
                order,
            );
        }
        let end = T::from_f64(if plain < first { first } else { last });
        let at_end = |order| {
            polynomial(
                self.coefficients_of(place.piece),
                end - T::from_f64(knot),
                order,
            )
        };
        match order {
            0 => at_end(1).mul_add(x - end, at_end(0)),
            1 => at_end(1),
            _ => T::zero(),
        }
    }

    fn ends(&self) -> (f64, f64) {
        (self.knots[0], self.knots[self.knots.len() - 1])
    }

    fn coefficients_of(&self, piece: usize) -> &[f64] {
        let count = self.coefficients.len() / (self.knots.len() - 1);
        &self.coefficients[piece * count..(piece + 1) * count]
    }

    /// Where the argument lies; `None` where the curve has no value.
    fn place(&self, x: f64) -> Option<Place> {
        let (first, last) = self.ends();
        let inside = first <= x && x <= last;
        let periods = match self.outside {
            // Infinity has no place in a period.
            _ if !x.is_finite() => return None,
            _ if inside => 0.0,
            Outside::Undefined => return None,
            Outside::Periodic => Float::floor((x - first) / (last - first)),
            Outside::Straight | Outside::Polynomial => 0.0,
        };
        let within = x - periods * (last - first);
        let before = self.knots.partition_point(|knot| *knot <= within);
        Some(Place {
            piece: before.saturating_sub(1).min(self.knots.len() - 2),
            periods,
            straight: !inside && self.outside == Outside::Straight,
        })
    }
}

/// The derivative of a polynomial with these coefficients, from the highest power on (W. G. Horner).
fn polynomial<T: Scalar>(coefficients: &[f64], t: T, order: usize) -> T {
    let falling = |power: usize| (0..order).fold(1.0, |product, i| product * (power - i) as f64);
    (order..coefficients.len())
        .rev()
        .fold(T::zero(), |sum, power| {
            sum.mul_add(t, T::from_f64(coefficients[power] * falling(power)))
        })
}

#[cfg(test)]
mod tests;
