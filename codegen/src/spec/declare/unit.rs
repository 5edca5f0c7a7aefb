//! Units of parameters.

use super::super::ast::Name;
use super::super::code;
use crate::diagnostic::Diagnostic;

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
