//! Curves in balls: the polynomials of the spec, evaluated here anew.

use super::ball::Ball;
use hamel_codegen::expr::Rational;
use hamel_codegen::expr::curve::{Curve, Outside};

/// The derivative of an order at x.
pub fn derivative(curve: Curve, order: u8, x: &Ball) -> Ball {
    let definition = curve.definition();
    let per_radian = Ball::rational(&Rational::from(180)).over(&Ball::pi());
    let mut argument = x.clone();
    let mut scale = Ball::one();
    if definition.of_degrees {
        argument = argument.times(&per_radian);
        scale = (0..order).fold(scale, |scale, _| scale.times(&per_radian));
    }
    if definition.in_degrees {
        scale = scale.over(&per_radian);
    }
    if definition.outside == Outside::Periodic {
        argument = in_first_period(curve, &argument);
    }
    value(curve, usize::from(order), &argument).times(&scale)
}

/// The argument less whole periods, whichever number of them: the value is the same.
fn in_first_period(curve: Curve, argument: &Ball) -> Ball {
    let (first, last) = curve.ends();
    let period = last - first;
    let from_first = argument.minus(&Ball::rational(first));
    let periods = from_first.over(&Ball::rational(&period)).to_f64().floor();
    if periods.is_nan() || periods.abs() >= 1e15 {
        return Ball::unknown();
    }
    argument.minus(&Ball::rational(
        &(&period * &Rational::from(periods as i64)),
    ))
}

/// On every piece that may hold the argument, and beyond the ends.
fn value(curve: Curve, order: usize, argument: &Ball) -> Ball {
    let definition = curve.definition();
    let last = definition.pieces.len() - 1;
    let beyond = |knot: &Rational| argument.minus(&Ball::rational(knot));
    let before_first =
        !beyond(&definition.knots[0]).is_positive() && !beyond(&definition.knots[0]).is_zero();
    let behind_last = !beyond(&definition.knots[last + 1]).is_negative()
        && !beyond(&definition.knots[last + 1]).is_zero();
    match definition.outside {
        Outside::Undefined if beyond(&definition.knots[0]).is_negative() => {
            return Ball::undefined();
        }
        Outside::Undefined if beyond(&definition.knots[last + 1]).is_positive() => {
            return Ball::undefined();
        }
        Outside::Undefined | Outside::Straight if before_first || behind_last => {
            return Ball::unknown();
        }
        _ => {}
    }
    let may_hold = |piece: &usize| {
        let starts = *piece == 0 || !beyond(&definition.knots[*piece]).is_negative();
        let ends = *piece == last || !beyond(&definition.knots[piece + 1]).is_positive();
        starts && ends
    };
    let values = (0..=last).filter(may_hold).map(|piece| {
        let t = beyond(&definition.knots[piece]);
        let coefficients = definition.pieces[piece].iter().enumerate();
        let terms = coefficients.skip(order).rev();
        terms.fold(Ball::zero(), |sum, (power, coefficient)| {
            let factors = (0..order).map(|i| (power - i) as i64);
            let factor = Rational::from(factors.product::<i64>());
            sum.times(&t)
                .plus(&Ball::rational(&(coefficient * &factor)))
        })
    });
    values
        .reduce(|a, b| a.hull(&b))
        .unwrap_or_else(Ball::unknown)
}
