//! Linear equations between exponents of units, solved by elimination.

use crate::expr::Rational;
use crate::units::Dimension;
use num_traits::Zero;
use std::collections::BTreeMap;
use std::ops::Range;

/// A unit: a known one times powers of unknown ones.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Form {
    /// Powers of the unknown ones, none of them 0.
    unknowns: BTreeMap<usize, Rational>,
    known: Dimension,
}

impl Form {
    /// A known unit.
    pub fn known(known: Dimension) -> Self {
        Self {
            unknowns: BTreeMap::new(),
            known,
        }
    }

    /// An unknown one.
    pub fn unknown(number: usize) -> Self {
        Self {
            unknowns: BTreeMap::from([(number, Rational::from(1))]),
            known: Dimension::default(),
        }
    }

    /// Multiplies by a power of the other.
    pub fn multiply(&mut self, other: &Self, power: &Rational) {
        self.known.add(&other.known, power);
        for (number, own) in &other.unknowns {
            let sum = self.unknowns.entry(*number).or_default();
            *sum += own * power;
        }
        self.unknowns.retain(|_, power| !power.is_zero());
    }

    /// Whether its known part has an exponent of these units.
    pub fn has_known(&self, units: &Range<usize>) -> bool {
        !self.known.vanishes(units)
    }

    /// This unit divided by the other.
    pub fn over(&self, other: &Self) -> Self {
        let mut quotient = self.clone();
        quotient.multiply(other, &Rational::from(-1));
        quotient
    }
}

/// Units that are 1, each solved for an unknown one.
pub(super) struct System {
    /// By the unknown for which it is solved: what that is.
    rows: BTreeMap<usize, Form>,
    /// The units whose exponents count.
    compared: Range<usize>,
}

impl System {
    pub fn new(compared: Range<usize>) -> Self {
        Self {
            rows: BTreeMap::new(),
            compared,
        }
    }

    /// Says that a unit is 1.
    ///
    /// # Errors
    /// What it is by those before, where that is known and not 1.
    pub fn say(&mut self, unit: &Form) -> Result<(), Dimension> {
        let unit = self.reduced(unit);
        let Some((number, power)) = unit.unknowns.iter().next() else {
            return match unit.known.vanishes(&self.compared) {
                true => Ok(()),
                false => Err(unit.known),
            };
        };
        let (number, power) = (*number, power.clone());
        let mut rest = unit;
        rest.unknowns.remove(&number);
        let mut solved = Form::default();
        solved.multiply(&rest, &-power.recip());
        self.rows.insert(number, solved);
        Ok(())
    }

    /// The unit, where it is known.
    pub fn value(&self, unit: &Form) -> Option<Dimension> {
        let reduced = self.reduced(unit);
        reduced.unknowns.is_empty().then_some(reduced.known)
    }

    /// The unit without unknowns for which a row is solved. A row holds only unknowns that were not solved for when it was made, so that this ends.
    fn reduced(&self, unit: &Form) -> Form {
        let mut reduced = unit.clone();
        let solved = |form: &Form| {
            let mut unknowns = form.unknowns.iter();
            unknowns
                .find_map(|(number, power)| Some((self.rows.get(number)?, *number, power.clone())))
        };
        while let Some((row, number, power)) = solved(&reduced) {
            reduced.unknowns.remove(&number);
            reduced.multiply(row, &power);
        }
        reduced
    }
}
