//! Units of parameters.

use super::super::ast::Name;
use super::super::{Fallible, code};
use crate::diagnostic::Diagnostic;
use crate::expr::Rational;

/// SI units of which a unit is made.
const UNITS: &[&str] = &["1", "m", "rad", "kg", "s", "N"];
/// Units that are not SI, with the one to use.
const FOREIGN: &[(&str, &str)] = &[
    ("deg", "rad"),
    ("degree", "rad"),
    ("degrees", "rad"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("mm", "m"),
    ("cm", "m"),
    ("km", "m"),
    ("meter", "m"),
    ("metre", "m"),
    ("inch", "m"),
    ("ft", "m"),
    ("g", "kg"),
    ("lb", "kg"),
    ("ms", "s"),
    ("min", "s"),
    ("kN", "N"),
];

/// A unit in which the knots of a curve may be written.
pub(super) struct Written {
    /// What a number of it is in SI units, or in degrees.
    pub factor: Rational,
    /// Whether it is the degree.
    pub degrees: bool,
}

/// The unit of a curve: those of parameters, and millimetres and degrees, in which tables are mostly written.
pub(super) fn of_curve(unit: &Name) -> Fallible<Written> {
    let (factor, degrees) = match unit.text.as_str() {
        "mm" => (Rational::new(1.into(), 1000.into()), false),
        "deg" => (Rational::from(1), true),
        _ => match error(unit) {
            None => (Rational::from(1), false),
            Some(_) => {
                let message = format!("`{}` is not a unit of curves", unit.text);
                let error = Diagnostic::new(code::UNIT, unit.span.clone(), message);
                let error = error.label("not known").help(format!(
                    "units of curves are `mm`, `deg`, and products and quotients of {}",
                    UNITS.join(", ")
                ));
                return Err(Box::new(error));
            }
        },
    };
    Ok(Written { factor, degrees })
}

/// The unit in which the values of a curve are whose knots are in `unit`.
pub(super) fn in_si(unit: &str) -> &str {
    match unit {
        "mm" => "m",
        "deg" => "rad",
        other => other,
    }
}

/// The error that this is no unit, if it is none.
pub(super) fn error(unit: &Name) -> Option<Diagnostic> {
    let unknown = unit
        .text
        .split(['*', '/'])
        .find(|part| !UNITS.contains(part))?;
    let error = Diagnostic::new(
        code::UNIT,
        unit.span.clone(),
        format!("`{unknown}` is not a unit of the language"),
    );
    let error = error.label("not known");
    Some(match FOREIGN.iter().find(|(name, _)| *name == unknown) {
        Some((_, si)) => error.help(format!(
            "parameters are in SI units and radians: write `{si}`"
        )),
        None => error.help(format!(
            "units are products and quotients of {}",
            UNITS.join(", ")
        )),
    })
}
