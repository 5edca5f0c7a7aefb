//! Base parameters as people write them: sums of named parameters.

use super::BaseParameters;
use crate::shown::Number;
use alloc::format;
use core::fmt::{Display, Formatter, Result};

/// One base parameter as a sum of inertial parameters: `I_zz(upper) + 0.25 m(fore)`.
#[derive(Clone, Copy, Debug)]
pub struct Combination<'a> {
    of: &'a BaseParameters,
    base: usize,
}

impl<'a> Combination<'a> {
    pub(super) const fn new(of: &'a BaseParameters, base: usize) -> Self {
        Self { of, base }
    }

    /// The terms that are not zero, with their places in π: first that of the parameter that stands for the base parameter, with the coefficient 1, then
    /// the others in the order of π. Coefficients in SI units.
    pub fn terms(&self) -> impl Iterator<Item = (usize, f64)> + Clone + use<'a> {
        let (of, base) = (self.of, self.base);
        let own = of.kept.get(base).copied();
        let first = own.map(|place| (place, 1.0));
        let others = own.into_iter().flat_map(move |own| {
            let row = of.matrix.row(base).into_iter();
            let places = row.copied().enumerate();
            places.filter(move |(place, weight)| *weight != 0.0 && *place != own)
        });
        first.into_iter().chain(others)
    }
}

impl Display for Combination<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        for (number, (place, weight)) in self.terms().enumerate() {
            match (number, weight < 0.0) {
                (0, false) => {}
                (0, true) => f.write_str("-")?,
                (_, false) => f.write_str(" + ")?,
                (_, true) => f.write_str(" - ")?,
            }
            let weight = shown(weight.abs());
            if weight != 1.0 {
                write!(f, "{} ", Number(weight))?;
            }
            f.write_str(&self.of.name(place))?;
        }
        Ok(())
    }
}

/// To six digits.
fn shown(number: f64) -> f64 {
    format!("{number:.5e}").parse().unwrap_or(number)
}
