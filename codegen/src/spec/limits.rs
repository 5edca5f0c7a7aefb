//! Bounds on the size of values, so that no spec, however wrong, makes the build hang or overflow.
//!
//! The budget of [`crate::expr::budget`] counts products of terms; these bounds hold the cost of each such product.

use super::value::Value;
use crate::expr::{Atom, Expr, Monomial};

/// Products of terms that one statement may take.
pub(super) const STATEMENT_BUDGET: u64 = 200_000;
/// Products of terms that the Gröbner basis of declared relations may take.
pub(super) const RELATIONS_BUDGET: u64 = 500_000;
/// The same where the spec has other errors: enough for short relations.
pub(super) const RELATIONS_BUDGET_OF_WRONG: u64 = 2_000;
/// Products of terms that one file may take.
pub(super) const FILE_BUDGET: u64 = 1_000_000;
/// Largest number of columns, and of rows but where twists of several bodies stand one below the other.
pub(super) const LARGEST_MATRIX: usize = 12;
/// Largest number of rows of a matrix that is written out: twists of all bodies.
pub(super) const TALLEST_MATRIX: usize = 6 * MOST_BODIES;
/// Most bodies of a joint.
pub(super) const MOST_BODIES: usize = 16;
/// Most ports of a joint.
pub(super) const MOST_PORTS: usize = 16;
/// Most pins of a joint.
pub(super) const MOST_PINS: usize = 32;
/// Largest exponent of `pow`, up or down.
pub(super) const LARGEST_POWER: u32 = 16;

/// Most terms of an angle: sines and cosines of sums are expanded, and each term doubles them.
pub(super) const LONGEST_ANGLE: usize = 6;

/// Longest source, in bytes.
pub(super) const LARGEST_SOURCE: usize = 64 * 1024;
/// Most knots of a curve.
pub(super) const MOST_KNOTS: usize = 1000;

const MOST_TERMS: usize = 5_000;
const HIGHEST_DEGREE: u32 = 64;
const LONGEST_COEFFICIENT: u64 = 1_024;
const MOST_PARTS: usize = 4_000;
const DEEPEST_FUNCTION: usize = 12;

/// What of the value is too large, if anything.
pub(super) fn excess(value: &Value) -> Option<String> {
    value.entries().iter().find_map(excess_of)
}

fn excess_of(expression: &Expr) -> Option<String> {
    let terms = expression.terms().len();
    if terms > MOST_TERMS {
        return Some(format!("{terms} terms, at most {MOST_TERMS} are possible"));
    }
    for (monomial, coefficient) in expression.terms() {
        let digits = coefficient.numer().bits().max(coefficient.denom().bits());
        if digits > LONGEST_COEFFICIENT {
            return Some(format!(
                "a number of {digits} binary digits, at most {LONGEST_COEFFICIENT} are possible"
            ));
        }
        let degree = degree(monomial);
        if degree > HIGHEST_DEGREE {
            return Some(format!(
                "a term of degree {degree}, at most {HIGHEST_DEGREE} is possible"
            ));
        }
    }
    let mut parts = MOST_PARTS;
    match measure(expression, &mut parts, DEEPEST_FUNCTION) {
        true => None,
        false => Some(format!(
            "functions nested deeper than {DEEPEST_FUNCTION} levels or more than {MOST_PARTS} parts"
        )),
    }
}

fn degree(monomial: &Monomial) -> u32 {
    monomial
        .factors()
        .map(|(_, power)| power.unsigned_abs())
        .fold(0, u32::saturating_add)
}

/// Counts the parts of the expression, those inside functions included; false where there are too many, or too deep.
fn measure(expression: &Expr, parts: &mut usize, depth: usize) -> bool {
    let factors = expression
        .terms()
        .flat_map(|(monomial, _)| monomial.factors());
    for (atom, _) in factors {
        *parts = parts.saturating_sub(1);
        if *parts == 0 || depth == 0 {
            return false;
        }
        if let Atom::Apply(application) = atom
            && !application
                .arguments
                .iter()
                .all(|argument| measure(argument, parts, depth - 1))
        {
            return false;
        }
    }
    true
}
