//! Curves: functions of one variable through knots, as joints declare them for cams, rails and measured linkages.
//!
//! A curve is one polynomial between each two knots, written in powers of the distance from the nearer knot: near a knot it keeps its digits on both sides, and all
//! derivatives below the degree are continuous there in rounded numbers, too. The knot is searched for with the plain value of the argument; derivatives are those
//! of the polynomial, of any order, so that one table serves every scalar ([`Scalar::curve`]).

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
    /// Number of the knot that is nearest.
    knot: usize,
    /// How many periods that is beyond the first one.
    periods: f64,
    /// Whether it is beyond an end from which the curve goes on straight.
    straight: bool,
}

impl Curve {
    /// The curve with these knots, ascending. Each knot has as many coefficients: those of 1, t, t², … with t the distance from it, of which the last stands twice, to
    /// the left and to the right of the knot. Coefficients of a periodic curve are the same at its first and its last knot.
    ///
    /// # Panics
    /// Fewer than two knots, and numbers of coefficients that do not fit: a constant of this type is refused by the compiler then.
    pub const fn new(
        knots: &'static [f64],
        coefficients: &'static [f64],
        outside: Outside,
    ) -> Self {
        assert!(knots.len() >= 2, "a curve has at least two knots");
        assert!(
            coefficients.len() >= 3 * knots.len() && coefficients.len().is_multiple_of(knots.len()),
            "a curve has as many coefficients for each knot, three or more"
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
        let period = T::from_f64(last) - T::from_f64(first);
        let knot = T::from_f64(self.knots[place.knot]);
        let t = (x - period * T::from_f64(place.periods)) - knot;
        let count = self.coefficients.len() / self.knots.len();
        let coefficients = &self.coefficients[place.knot * count..(place.knot + 1) * count];
        match place.straight {
            true => straight(coefficients, t, order),
            false => {
                // The value of t is rounded as that of the argument's own arithmetic, and so is its sign.
                let t_plain = (plain - (last - first) * place.periods) - self.knots[place.knot];
                polynomial(coefficients, t_plain < 0.0, t, order)
            }
        }
    }

    fn ends(&self) -> (f64, f64) {
        (self.knots[0], self.knots[self.knots.len() - 1])
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
        let knot = self.nearest(x - (last - first) * periods);
        let is_first = self.outside == Outside::Periodic && knot == self.knots.len() - 1;
        Some(Place {
            // Just below the first knot of a period, its distance from that is exact.
            knot: if is_first { 0 } else { knot },
            periods: if is_first { periods + 1.0 } else { periods },
            straight: !inside && self.outside == Outside::Straight,
        })
    }

    /// The knot that is nearest.
    fn nearest(&self, x: f64) -> usize {
        let inner = &self.knots[1..self.knots.len() - 1];
        let before = inner.partition_point(|knot| *knot <= x);
        let [from, to] = [self.knots[before], self.knots[before + 1]];
        if x - from > to - x {
            before + 1
        } else {
            before
        }
    }
}

/// The derivative of a polynomial with these coefficients, from the highest power on (W. G. Horner).
fn polynomial<T: Scalar>(coefficients: &[f64], left: bool, t: T, order: usize) -> T {
    let degree = coefficients.len() - 2;
    let falling = |power: usize| (0..order).fold(1.0, |product, i| product * (power - i) as f64);
    (order..=degree).rev().fold(T::zero(), |sum, power| {
        let place = if power == degree && !left {
            power + 1
        } else {
            power
        };
        sum.mul_add(t, T::from_f64(coefficients[place] * falling(power)))
    })
}

/// The derivative of its tangent.
fn straight<T: Scalar>(coefficients: &[f64], t: T, order: usize) -> T {
    let slope = T::from_f64(coefficients[1]);
    match order {
        0 => slope.mul_add(t, T::from_f64(coefficients[0])),
        1 => slope,
        _ => T::zero(),
    }
}

#[cfg(test)]
mod tests;
