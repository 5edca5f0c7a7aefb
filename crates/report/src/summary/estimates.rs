//! How far estimated errors can be trusted.

use super::{median, percent, times};
use crate::row::Estimate;
use itertools::Itertools;
use serde::Serialize;

/// An estimate is right that is within this factor of the error.
const FACTOR: f64 = 10.0;

/// How far below the error a reliable one may be.
const BELOW: f64 = 30.0;

/// An error that is not small beside the motion.
const LARGE: f64 = 1e-2;

/// No error is less than one rounding.
const ROUNDING: f64 = 0.5 * f64::EPSILON;

/// The estimates of all motions that came to their end.
#[derive(Debug, Serialize)]
pub struct Estimates {
    motions: usize,
    right: String,
    wrongly_doubted: String,
    too_small: Vec<String>,
    large_unsaid: Vec<String>,
    evaluations: String,
    seconds: String,
}

/// One estimate beside what is true.
struct Told<'a> {
    row: &'a Estimate,
    error: f64,
    worst: f64,
    told: f64,
}

impl<'a> Told<'a> {
    fn new(row: &'a Estimate) -> Option<Self> {
        Some(Self {
            row,
            error: row.error_final?.max(ROUNDING),
            worst: row.error_worst?,
            told: row.told_steps? + row.told_rounding?,
        })
    }

    fn is_reliable(&self) -> bool {
        self.row.doubt.is_empty()
    }

    fn is_right(&self) -> bool {
        self.told <= FACTOR * self.error && self.told >= self.error / FACTOR
    }

    fn name(&self) -> String {
        let Self {
            row, error, told, ..
        } = self;
        format!(
            "{} {} {} at {:.0e}: error {error:.1e}, estimated {told:.1e}",
            row.scene, row.form, row.method, row.tolerance
        )
    }
}

impl Estimates {
    /// `None` where there are none.
    pub fn new(rows: &[Estimate]) -> Option<Self> {
        let all: Vec<Told<'_>> = rows.iter().filter_map(Told::new).collect();
        let count = |which: &dyn Fn(&Told<'_>) -> bool| {
            let count = all.iter().filter(|told| which(told)).count();
            percent(count, all.len())
        };
        let names = |which: &dyn Fn(&Told<'_>) -> bool| -> Vec<String> {
            let own = all.iter().filter(|told| which(told));
            own.map(Told::name).sorted().collect()
        };
        let cost = |own: fn(&Estimate) -> Option<f64>| {
            let ratios = all.iter().filter_map(|told| own(told.row));
            median(ratios.filter(|ratio| ratio.is_finite()))
        };
        let evaluations =
            cost(|row| Some(row.evaluations_of_estimate? as f64 / row.evaluations? as f64));
        let seconds = cost(|row| Some(row.seconds_of_estimate? / row.seconds?));
        Some(Self {
            motions: all.len(),
            right: count(&|told| told.is_right()),
            wrongly_doubted: count(&|told| {
                told.is_right() && !told.is_reliable() && told.worst < LARGE
            }),
            too_small: names(&|told| told.is_reliable() && told.told < told.error / BELOW),
            large_unsaid: names(&|told| told.is_reliable() && told.worst > LARGE),
            evaluations: times(evaluations?),
            seconds: times(seconds?),
        })
    }
}
