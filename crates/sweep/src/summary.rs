//! What came of all rows: quantiles of each result, and failures by cause.
//!
//! Memory is bounded by the number of columns: [`Figures`] are found in [some passes](Selection::passes) over the results, and are exact.

use crate::Outcome;
use std::collections::BTreeMap;

/// The probabilities of the quantiles.
pub const QUANTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// Columns from which on memory is saved by more passes.
const MANY: usize = 100;

/// The sum of 2⁴⁰ doubles times this is a double. It is a power of two: products with it are exact except for values below 1e-295.
const SCALE: f64 = 1.0 / (1_u64 << 40) as f64;

/// Kinds of causes that are distinguished.
const MOST_CAUSES: usize = 1000;

/// Of the finite values of one column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// How many there are.
    pub count: u64,
    /// NaN where there are none, as all that follow.
    pub mean: f64,
    /// The least.
    pub min: f64,
    /// By [`QUANTILES`]: the smallest value with at least that share of values at or below it.
    pub quantiles: [f64; 5],
    /// The greatest.
    pub max: f64,
}

/// Figures of several columns, while rows are seen.
#[derive(Clone, Debug)]
pub struct Selection {
    columns: Vec<Column>,
    digits: Digits,
}

/// The bits of a number by which passes narrow what a quantile may be.
#[derive(Clone, Copy, Debug)]
struct Digits {
    /// How many one pass looks at. The counts of a column take 40 · 2^bits bytes.
    bits: u32,
    pass: u32,
}

impl Digits {
    /// How many have been looked at before this pass.
    const fn known(self) -> u32 {
        self.bits * self.pass
    }

    /// How many this pass looks at.
    const fn own(self) -> u32 {
        let left = 64 - self.known();
        if left < self.bits { left } else { self.bits }
    }

    /// What this pass looks at.
    const fn of(self, key: u64) -> u64 {
        (key >> (64 - self.known() - self.own())) & ((1 << self.own()) - 1)
    }

    /// Whether a number begins with these bits, which are known.
    const fn begins(self, key: u64, prefix: u64) -> bool {
        self.pass == 0 || key >> (64 - self.known()) == prefix
    }
}

#[derive(Clone, Debug)]
struct Column {
    count: u64,
    /// Of the values times [`SCALE`].
    sum: f64,
    rounding: f64,
    min: f64,
    max: f64,
    targets: Vec<Target>,
}

/// A value that is looked for: its first bits, and how many of those with the same first bits are not above it.
#[derive(Clone, Debug, Default)]
struct Target {
    prefix: u64,
    rank: u64,
    counts: Vec<u64>,
}

impl Selection {
    /// Of so many columns.
    pub fn new(columns: usize) -> Self {
        let digits = Digits {
            bits: if columns < MANY { 13 } else { 8 },
            pass: 0,
        };
        let column = Column {
            count: 0,
            sum: 0.0,
            rounding: 0.0,
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
            // In the first pass all count the same.
            targets: vec![Target::new(digits.bits)],
        };
        Self {
            columns: vec![column; columns],
            digits,
        }
    }

    /// How often it sees all rows.
    pub const fn passes(&self) -> u32 {
        64_u32.div_ceil(self.digits.bits)
    }

    /// Takes a row, one number for each column. Every pass takes all rows, in the same order.
    pub fn see(&mut self, row: &[f64]) {
        for (column, &value) in self.columns.iter_mut().zip(row) {
            if value.is_finite() {
                column.see(value, self.digits);
            }
        }
    }

    /// Ends a pass.
    pub fn narrow(&mut self) {
        for column in &mut self.columns {
            column.narrow(self.digits);
        }
        self.digits.pass += 1;
    }

    /// The figures, after all passes.
    pub fn figures(&self) -> Vec<Figures> {
        self.columns.iter().map(Column::figures).collect()
    }
}

impl Target {
    fn new(bits: u32) -> Self {
        Self {
            counts: vec![0; 1 << bits],
            ..Self::default()
        }
    }
}

impl Column {
    fn see(&mut self, value: f64, digits: Digits) {
        if digits.pass == 0 {
            self.count += 1;
            self.min = self.min.min(value);
            self.max = self.max.max(value);
            // Neumaier's sum.
            let value = value * SCALE;
            let sum = self.sum + value;
            self.rounding += match self.sum.abs() >= value.abs() {
                true => (self.sum - sum) + value,
                false => (value - sum) + self.sum,
            };
            self.sum = sum;
        }
        let key = ordered(value);
        for target in &mut self.targets {
            if digits.begins(key, target.prefix) {
                target.counts[digits.of(key) as usize] += 1;
            }
        }
    }

    fn narrow(&mut self, digits: Digits) {
        if digits.pass == 0 {
            let first = self.targets.pop().unwrap_or_default();
            let ranks = QUANTILES.map(|part| (part * self.count as f64).ceil().max(1.0) as u64);
            self.targets = ranks
                .map(|rank| Target {
                    rank,
                    ..first.clone()
                })
                .into();
        }
        for target in &mut self.targets {
            let mut rank = target.rank;
            let digit = target.counts.iter().position(|&count| {
                let is_here = rank <= count;
                rank -= if is_here { 0 } else { count };
                is_here
            });
            let digit = digit.unwrap_or(0) as u64;
            target.prefix = target.prefix << digits.own() | digit;
            target.rank = rank;
            target.counts.fill(0);
        }
    }

    fn figures(&self) -> Figures {
        if self.count == 0 {
            return Figures {
                count: 0,
                mean: f64::NAN,
                min: f64::NAN,
                quantiles: [f64::NAN; 5],
                max: f64::NAN,
            };
        }
        let mut quantiles = [f64::NAN; 5];
        for (quantile, target) in quantiles.iter_mut().zip(&self.targets) {
            *quantile = unordered(target.prefix);
        }
        Figures {
            count: self.count,
            mean: (self.sum + self.rounding) / self.count as f64 / SCALE,
            min: self.min,
            quantiles,
            max: self.max,
        }
    }
}

const SIGN: u64 = 1 << 63;

/// A number in the order of the values.
const fn ordered(value: f64) -> u64 {
    let bits = value.to_bits();
    if bits & SIGN == 0 { bits | SIGN } else { !bits }
}

const fn unordered(key: u64) -> f64 {
    f64::from_bits(if key & SIGN == 0 { !key } else { key & !SIGN })
}

/// Rows that failed for one cause.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failures {
    /// The cause of the first of them; others may have other numbers in it.
    pub cause: String,
    /// How many there are.
    pub count: u64,
    /// The first of them, from 1.
    pub row: u64,
}

/// How rows ended.
#[derive(Clone, Debug, Default)]
pub struct Causes {
    events: BTreeMap<String, Failures>,
    failures: BTreeMap<String, Failures>,
    ended: u64,
}

impl Causes {
    /// Takes the outcome of the row of this number, from 1.
    pub fn see(&mut self, row: u64, outcome: &Outcome) {
        match outcome {
            Outcome::Ended => self.ended += 1,
            Outcome::Event(name) => note(&mut self.events, name.clone(), name, row),
            Outcome::Failed(cause) => {
                note(&mut self.failures, without_numbers(cause), cause, row);
            }
        }
    }

    /// Rows that went to the end of their time.
    pub const fn ended(&self) -> u64 {
        self.ended
    }

    /// Rows that events of the scene stopped, by the name of the event.
    pub fn events(&self) -> Vec<Failures> {
        sorted(&self.events)
    }

    /// Rows that failed, the most frequent cause first. Causes that differ by numbers are one.
    pub fn failures(&self) -> Vec<Failures> {
        sorted(&self.failures)
    }
}

fn note(known: &mut BTreeMap<String, Failures>, kind: String, cause: &str, row: u64) {
    let (kind, cause) = match known.len() < MOST_CAUSES || known.contains_key(&kind) {
        true => (kind, cause),
        false => (String::new(), "other causes"),
    };
    let entry = known.entry(kind).or_insert_with(|| Failures {
        cause: cause.to_owned(),
        count: 0,
        row,
    });
    entry.count += 1;
}

fn sorted(known: &BTreeMap<String, Failures>) -> Vec<Failures> {
    let mut all: Vec<Failures> = known.values().cloned().collect();
    all.sort_by_key(|one| (std::cmp::Reverse(one.count), one.row));
    all
}

/// What is outside of names, with all numbers the same.
fn without_numbers(cause: &str) -> String {
    let mut kind = String::with_capacity(cause.len());
    for (place, part) in cause.split('`').enumerate() {
        match place % 2 {
            1 => kind.extend(["`", part, "`"]),
            _ => without_digits(part, &mut kind),
        }
    }
    kind
}

fn without_digits(text: &str, kind: &mut String) {
    let words = text.split_inclusive(|c: char| !(c.is_alphanumeric() || ".-+".contains(c)));
    for word in words {
        let own = word.trim_end_matches(|c: char| !(c.is_alphanumeric() || ".-+".contains(c)));
        let is_number = own.parse::<f64>().is_ok();
        kind.push_str(if is_number { "#" } else { own });
        kind.push_str(&word[own.len()..]);
    }
}

#[cfg(test)]
mod tests {
    use super::{Causes, Figures, MANY, QUANTILES, Selection};

    /// In one column, and in the last of many.
    fn selected(values: &[f64]) -> Figures {
        let mut found = [1, MANY].map(|columns| {
            let mut selection = Selection::new(columns);
            for _ in 0..selection.passes() {
                let rows = values.iter().map(|&value| vec![value; columns]);
                rows.for_each(|row| selection.see(&row));
                selection.narrow();
            }
            selection.figures()[columns - 1]
        });
        let [one, many] = found.each_mut();
        // Not by numbers: those of no values are NaN.
        assert_eq!(format!("{one:?}"), format!("{many:?}"));
        *one
    }

    #[test]
    fn quantiles_are_those_of_the_sorted_values() {
        // An additive recurrence over many magnitudes and both signs.
        let value = |n: u32| {
            let part = (f64::from(n) * 2_f64.sqrt()).fract() - 0.4;
            part * 10_f64.powi(n.cast_signed() % 40 - 20)
        };
        for count in [1, 2, 19, 20, 1000] {
            let values: Vec<f64> = (0..count).map(value).collect();
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            let found = selected(&values);
            for (part, quantile) in QUANTILES.iter().zip(found.quantiles) {
                let rank = (part * f64::from(count)).ceil() as usize;
                assert_eq!(quantile, sorted[rank.max(1) - 1], "{count}, {part}");
            }
            assert_eq!(found.min, sorted[0]);
            assert_eq!(found.max, sorted[sorted.len() - 1]);
        }
    }

    #[test]
    fn what_is_not_finite_counts_nowhere() {
        let found = selected(&[f64::NAN, 2.0, f64::INFINITY, -0.0, 4.0]);
        assert_eq!((found.count, found.mean, found.min), (3, 2.0, -0.0));
        assert!(selected(&[f64::NAN]).quantiles[2].is_nan());
    }

    #[test]
    fn the_mean_of_large_values_is_a_number() {
        let found = selected(&[1e308, 1e308, 1.5e308, 0.5e308]);
        assert_eq!((found.count, found.mean), (4, 1e308));
    }

    #[test]
    fn causes_that_differ_by_numbers_are_one() {
        let mut causes = Causes::default();
        for (row, outcome) in [
            "ended",
            "failed: body `a`: `mass` is -1.0, but must be at least 0",
            "event floor 2",
            "failed: body `a`: `mass` is -2.5e-3, but must be at least 0",
            "failed: body `a2`: `mass` is -1.0, but must be at least 0",
            "failed: body `a3`: `mass` is -1.0, but must be at least 0",
        ]
        .into_iter()
        .enumerate()
        {
            causes.see(row as u64 + 1, &outcome.parse().expect("an outcome"));
        }
        let told = causes.failures();
        let told: Vec<_> = told.iter().map(|one| (one.count, one.row)).collect();
        assert_eq!(told, [(2, 2), (1, 5), (1, 6)]);
        assert_eq!(causes.ended(), 1);
        assert_eq!(causes.events()[0].cause, "floor 2");
    }
}
