//! Periods of curves of an angle: one that is nearly a turn, or a part of one, misses it by a little more with every turn.

use super::super::ast::Curve;
use super::super::code;
use super::curve::{Knot, in_words};
use crate::diagnostic::Diagnostic;
use crate::expr::Rational;
use crate::expr::curve::Ends;
use std::f64::consts::TAU;

/// The parts of a turn of which periods are, as of a cam with several lobes.
const PARTS: std::ops::RangeInclusive<i64> = 1..=6;
/// A period that is nearer to one, by its size, is meant to be it.
const MEANT: f64 = 3e-3;
/// A double is as near as this to a number that it stands for.
const ROUNDING: f64 = 1e-14;

/// The error of a periodic curve whose knots span nearly, but not quite, a turn or a part of one.
pub(super) fn check(declared: &Curve, knots: &[Knot]) -> Option<Diagnostic> {
    let turn = match declared.argument.text.as_str() {
        "rad" => TAU,
        "deg" => 360.0,
        _ => return None,
    };
    let (first, last) = (knots.first()?, knots.last()?);
    if declared.ends != Ends::Periodic {
        return None;
    }
    let period = &last.numbers[0] - &first.numbers[0];
    let (length, _) = period.in_doubles();
    let missed = |parts: i64| (length * parts as f64 / turn - 1.0).abs();
    let parts = PARTS.min_by(|a, b| missed(*a).total_cmp(&missed(*b)))?;
    let is_meant = missed(parts) <= MEANT && missed(parts) > ROUNDING;
    is_meant.then(|| error(declared, [first, last], &period, parts))
}

fn error(declared: &Curve, [first, last]: [&Knot; 2], period: &Rational, parts: i64) -> Diagnostic {
    let (unit, name) = (&declared.argument.text, &declared.name.text);
    let part = match parts {
        1 => "a turn".to_owned(),
        _ => format!("1/{parts} of a turn"),
    };
    let degrees = Rational::from(360 / parts);
    let exact = match unit.as_str() {
        "deg" => format!("{degrees} deg"),
        _ => format!("{:.6}… rad", TAU / parts as f64),
    };
    let end = match unit.as_str() {
        "deg" => in_words(&(&first.numbers[0] + &degrees)),
        _ => format!("{degrees} degrees after the first knot"),
    };
    let message = format!(
        "the periodic curve `{name}` repeats after {} {unit}, which is not {part}: that is {exact}",
        in_words(period)
    );
    let help = match unit.as_str() {
        "deg" => format!("the last knot is the first one again, at {end}"),
        _ => format!(
            "π has no exact decimals: write the knots in degrees, `curve {name}(deg): …`, with the last one {end}; in expressions `{name}` takes radians all the same"
        ),
    };
    Diagnostic::new(code::CURVE, last.span.clone(), message)
        .label("the end of the period")
        .help(help)
}
