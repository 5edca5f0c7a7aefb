//! Curves: knots in the declared units, and what makes a curve of them.

use super::super::ast::{Curve, Knots, Name};
use super::super::{Fallible, code, limits};
use super::once::At;
use super::unit::{self, Written};
use super::{period, table};
use crate::diagnostic::Diagnostic;
use crate::expr::Rational;
use crate::expr::curve::{self, Definition, Ends, Kind, Outside};
use crate::model::{DeclaredCurve, KnotFile};
use std::ops::Range;
use std::path::Path;

/// A knot with the place that a message names.
pub(super) struct Knot {
    /// Bytes of the spec.
    pub span: Range<usize>,
    /// The line of a file, where it stands in one.
    pub line: Option<usize>,
    /// Argument and value, in the declared units.
    pub numbers: [Rational; 2],
}

/// The curve of a statement.
pub(super) fn curve(
    source: &str,
    statement: At<'_, Curve>,
    folder: Option<&Path>,
) -> Fallible<DeclaredCurve> {
    let declared = statement.value;
    let units = [&declared.argument, &declared.unit];
    let [of_argument, of_value] = units.map(unit::of_curve);
    let (of_argument, of_value) = (of_argument?, of_value?);
    let (knots, file) = match &declared.knots {
        Knots::Points(points) => (points.iter().map(of_spec).collect(), None),
        Knots::File(name, span) => {
            let (knots, text) = table::read(name, units, folder)?;
            let length = source.len() + text.len();
            if length > limits::LARGEST_SOURCE {
                return Err(Box::new(too_long(name, length)));
            }
            let file = KnotFile {
                span: span.clone(),
                name: name.text.clone(),
                knots: text,
            };
            (knots, Some(file))
        }
    };
    check_knots(declared, &knots)?;
    let points: Vec<(Rational, Rational)> = knots
        .iter()
        .map(|knot| {
            let [x, y] = &knot.numbers;
            (x * &of_argument.factor, y * &of_value.factor)
        })
        .collect();
    let definition = Definition {
        name: declared.name.text.clone(),
        kind: declared.kind,
        outside: outside(declared)?,
        of_degrees: of_argument.degrees,
        in_degrees: of_value.degrees,
        knots: vec![],
        pieces: vec![],
    };
    let ends = in_units(&declared.ends, &of_argument, &of_value);
    let made = curve::Curve::through(definition, &ends, &points);
    let sound = made.filter(|curve| curve.table().is_sound());
    match sound {
        Some(curve) => Ok(DeclaredCurve {
            curve,
            units: units.map(|unit| unit::in_si(&unit.text).to_owned()),
            span: statement.span.clone(),
            file,
        }),
        None => Err(Box::new(beyond_doubles(declared, statement.span))),
    }
}

fn of_spec((span, numbers): &(Range<usize>, [Rational; 2])) -> Knot {
    Knot {
        span: span.clone(),
        line: None,
        numbers: numbers.clone(),
    }
}

/// Slopes in the units in which the knots are then.
fn in_units(ends: &Ends, of_argument: &Written, of_value: &Written) -> Ends {
    let slope = |slope: &Rational| slope * &of_value.factor / &of_argument.factor;
    match ends {
        Ends::Clamped(first, last) => Ends::Clamped(slope(first), slope(last)),
        other => other.clone(),
    }
}

fn error(span: &Range<usize>, message: String) -> Diagnostic {
    Diagnostic::new(code::CURVE, span.clone(), message)
}

/// Enough knots, ascending, and of a periodic curve the same value at both ends.
fn check_knots(declared: &Curve, knots: &[Knot]) -> Fallible<()> {
    let name = &declared.name;
    let (fewest, kind) = match declared.ends {
        Ends::Periodic => (4, "a periodic curve"),
        _ => (3, "a curve"),
    };
    if !(fewest..=limits::MOST_KNOTS).contains(&knots.len()) {
        let message = format!(
            "the curve `{}` has {} knots: {kind} has {fewest} to {}",
            name.text,
            knots.len(),
            limits::MOST_KNOTS
        );
        return Err(Box::new(
            error(&name.span, message).label("too few or too many"),
        ));
    }
    let mut pairs = knots.windows(2);
    if let Some([before, after]) = pairs.find(|pair| pair[0].numbers[0] >= pair[1].numbers[0]) {
        let [a, b] = [before, after].map(|knot| in_words(&knot.numbers[0]));
        let place = after.line.map(|line| format!("line {line}: "));
        let message = format!(
            "{}the knot at {b} is not beyond the one before it, at {a}",
            place.unwrap_or_default()
        );
        return Err(Box::new(
            error(&after.span, message)
                .label("knots ascend")
                .help("a curve has one value at each argument"),
        ));
    }
    let [Some(first), Some(last)] = [knots.first(), knots.last()] else {
        return Ok(());
    };
    if declared.ends == Ends::Periodic && first.numbers[1] != last.numbers[1] {
        let [a, b] = [first, last].map(|knot| in_words(&knot.numbers[1]));
        let message = format!(
            "a periodic curve ends where it begins: {a} at its first knot, {b} at its last"
        );
        return Err(Box::new(error(&last.span, message).label("another value")));
    }
    match period::check(declared, knots) {
        Some(error) => Err(Box::new(error)),
        None => Ok(()),
    }
}

/// A number as a spec would write it, where it is a short decimal.
pub(super) fn in_words(value: &Rational) -> String {
    match value.is_integer() {
        true => value.to_string(),
        false => value.decimal().unwrap_or_else(|| value.to_string()),
    }
}

/// What it is beyond its ends.
fn outside(declared: &Curve) -> Fallible<Outside> {
    let Some((outside, span)) = &declared.outside else {
        return Ok(match declared.ends {
            Ends::Periodic => Outside::Periodic,
            _ => Outside::Undefined,
        });
    };
    let wrong = match (&declared.ends, outside, declared.kind) {
        (Ends::Periodic, ..) => Some((
            "a periodic curve has no ends from which it could go on",
            "leave `continue` out",
        )),
        // Its second derivative would jump from what it is at the end to 0.
        (Ends::Clamped(..), Outside::Straight, Kind::Cubic) => Some((
            "a cubic curve with given slopes is not straight at its ends, and cannot go on straight",
            "write `natural` in place of `clamped`, or `quintic`, or `continue polynomial`",
        )),
        _ => None,
    };
    match wrong {
        None => Ok(*outside),
        Some((message, help)) => Err(Box::new(
            error(span, message.to_owned())
                .label("does not fit")
                .help(help),
        )),
    }
}

fn beyond_doubles(declared: &Curve, span: &Range<usize>) -> Diagnostic {
    let message = format!(
        "the curve `{}` has numbers that no double holds, or knots that are one double",
        declared.name.text
    );
    error(span, message)
        .label("too near to each other, or too large")
        .help("use other units: doubles have 16 digits, and are between about 1e-308 and 1e308")
}

fn too_long(name: &Name, length: usize) -> Diagnostic {
    let message = format!(
        "a spec has at most {} bytes, the knots of its files included: this one has {length}",
        limits::LARGEST_SOURCE
    );
    Diagnostic::new(code::TABLE, name.span.clone(), message)
        .label("too many digits")
        .help("write fewer digits, or fewer knots")
}
