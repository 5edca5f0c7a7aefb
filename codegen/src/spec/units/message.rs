//! The message of units that do not fit.

use super::system::System;
use super::{Equation, Wanted};
use crate::diagnostic::Diagnostic;
use crate::expr::{Rational, Symbol};
use crate::spec::code;
use crate::units::Dimension;

/// The error that a term is `excess` times what it should be.
pub(super) fn error(equation: &Equation, excess: &Dimension, system: &System) -> Diagnostic {
    let element = match equation.blame.within {
        Some(function) => format!("the argument of {function} in {}", equation.blame.element),
        None => equation.blame.element.clone(),
    };
    let term = &equation.term;
    let (unit, other) = match &equation.wanted {
        Wanted::Unit(unit) => (unit, None),
        Wanted::LikeTerm(unit, text) => (unit, Some(text)),
    };
    let wanted = system.value(unit);
    let found = wanted.clone().map(|mut found| {
        found.add(excess, &Rational::from(1));
        found
    });
    let both = wanted.zip(found);
    let message = match (both, other) {
        (Some((wanted, found)), Some(text)) => format!(
            "{element} adds values of different units: `{text}` in {}, `{term}` in {}",
            wanted.in_words(),
            found.in_words()
        ),
        (Some((wanted, found)), None) => format!(
            "{element} is in {}, and `{term}` is in {}",
            wanted.in_words(),
            found.in_words()
        ),
        (None, Some(text)) => format!(
            "{element} adds values of different units: `{term}` is {} times `{text}`",
            excess.in_words()
        ),
        (None, None) => format!(
            "{element} has values of different units: `{term}` is {} times the others",
            excess.in_words()
        ),
    };
    let label = match other {
        Some(_) => "mixed units",
        None => "another unit",
    };
    Diagnostic::new(code::UNITS, equation.blame.span.clone(), message).label(label)
}

/// What to do where H turns and moves by the same coordinate.
pub(super) fn scale(symbol: &Symbol) -> String {
    let name = symbol.spelling();
    format!(
        "`{name}` alone is both the angle of a rotation of H and a length: multiply the length by metres per radian, a parameter, `lead * {name}` with `lead: m/rad`, or a number, \
         `0.01 * {name}`; for 1 m per radian write `1 * {name}`"
    )
}
