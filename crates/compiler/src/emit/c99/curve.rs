//! Tables of curves in C.

use super::formula::{curve_name, literal};
use hamel_codegen::expr::curve::{Curve, Outside};
use serde::Serialize;

/// A curve as the templates see it.
#[derive(Serialize)]
pub struct Table {
    name: String,
    /// The name of the spec, and what the curve is.
    said: String,
    knots: Vec<String>,
    /// Coefficients of a knot.
    terms: usize,
    coefficients: Vec<String>,
    /// What it is beyond its ends, as the helper has it.
    outside: u8,
}

impl Table {
    /// The table of a curve.
    pub fn new(curve: Curve) -> Self {
        let table = curve.table();
        let written = |numbers: &[f64]| numbers.iter().map(|number| literal(*number)).collect();
        Self {
            name: curve_name(curve),
            said: format!("{}: {}", curve.name(), curve.in_words()),
            knots: written(&table.knots),
            terms: table.coefficients.len() / table.knots.len(),
            coefficients: written(&table.coefficients),
            outside: match table.outside {
                Outside::Undefined => 0,
                Outside::Periodic => 1,
                Outside::Straight => 2,
                Outside::Polynomial => 3,
            },
        }
    }
}
