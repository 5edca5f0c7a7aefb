//! Values at given times, and what lies between them.

use super::Moment;
use super::{pulses, spline};
use alloc::vec::Vec;
use num_traits::Float;

/// What lies between the values of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableKind {
    /// The value before.
    Constant,
    /// A straight line.
    Linear,
    /// A cubic with continuous second derivative: a natural spline, or one that repeats.
    Cubic,
}

/// What a table is before its first time and from its last one on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    /// The first value, and the last.
    Hold,
    /// 0.
    Zero,
    /// The same again.
    Repeat,
}

impl TableKind {
    /// Names of all, as scene files write them.
    pub const NAMES: [&'static str; 3] = ["constant", "linear", "cubic"];

    /// The kind of that name.
    pub fn named(name: &str) -> Option<Self> {
        let kinds = [Self::Constant, Self::Linear, Self::Cubic];
        kinds.into_iter().find(|kind| kind.name() == name)
    }

    /// As scene files write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Constant => Self::NAMES[0],
            Self::Linear => Self::NAMES[1],
            Self::Cubic => Self::NAMES[2],
        }
    }
}

impl Outside {
    /// Names of all, as scene files write them.
    pub const NAMES: [&'static str; 3] = ["hold", "zero", "repeat"];

    /// The one of that name.
    pub fn named(name: &str) -> Option<Self> {
        let all = [Self::Hold, Self::Zero, Self::Repeat];
        all.into_iter().find(|outside| outside.name() == name)
    }

    /// As scene files write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hold => Self::NAMES[0],
            Self::Zero => Self::NAMES[1],
            Self::Repeat => Self::NAMES[2],
        }
    }
}

/// Why numbers make no table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// Too few times.
    #[error("a table has at least 2 times, this one has {count}")]
    Short {
        /// How many there are.
        count: usize,
    },
    /// As many values as times are wanted.
    #[error("there are {times} times and {values} values")]
    Sizes {
        /// How many times.
        times: usize,
        /// How many values.
        values: usize,
    },
    /// A number that is none.
    #[error("entry {} is {value}, it must be finite", .index + 1)]
    Infinite {
        /// Its place among the times or values.
        index: usize,
        /// What was given.
        value: f64,
    },
    /// Times that do not ascend.
    #[error("time {} is {time} s, it must be after the one before it, {before} s", .index + 1)]
    Order {
        /// The place of the later one.
        index: usize,
        /// It.
        time: f64,
        /// The one before it.
        before: f64,
    },
    /// A cubic that repeats, and does not end where it begins.
    #[error(
        "a cubic that repeats ends with the value that it begins with: it begins with {first} and ends with {last}"
    )]
    Open {
        /// The first value.
        first: f64,
        /// The last.
        last: f64,
    },
}

/// Values at given times.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    times: Vec<f64>,
    values: Vec<f64>,
    kind: TableKind,
    outside: Outside,
    /// Of a cubic: the slope at each time.
    slopes: Vec<f64>,
}

/// Where a time is in a table.
enum Place {
    Before,
    After,
    /// In the piece of that number, at that time of the table.
    Piece(usize, f64),
}

impl Table {
    /// A table of values at times that ascend.
    ///
    /// # Errors
    /// Numbers that make no table.
    pub fn new(
        times: Vec<f64>,
        values: Vec<f64>,
        kind: TableKind,
        outside: Outside,
    ) -> Result<Self, TableError> {
        let count = times.len();
        if count != values.len() {
            return Err(TableError::Sizes {
                times: count,
                values: values.len(),
            });
        }
        if count < 2 {
            return Err(TableError::Short { count });
        }
        for numbers in [&times, &values] {
            if let Some(index) = numbers.iter().position(|number| !number.is_finite()) {
                let value = numbers[index];
                return Err(TableError::Infinite { index, value });
            }
        }
        if let Some(index) = (1..count).find(|&i| times[i] <= times[i - 1]) {
            return Err(TableError::Order {
                index,
                time: times[index],
                before: times[index - 1],
            });
        }
        let (first, last) = (values[0], values[count - 1]);
        let repeats = outside == Outside::Repeat;
        if kind == TableKind::Cubic && repeats && first != last {
            return Err(TableError::Open { first, last });
        }
        let slopes = match kind {
            TableKind::Cubic => spline::slopes(&times, &values, repeats),
            _ => Vec::new(),
        };
        Ok(Self {
            times,
            values,
            kind,
            outside,
            slopes,
        })
    }

    /// The times, s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The values, one a time.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// What lies between.
    pub const fn kind(&self) -> TableKind {
        self.kind
    }

    /// What lies outside.
    pub const fn outside(&self) -> Outside {
        self.outside
    }

    fn start(&self) -> f64 {
        self.times[0]
    }

    fn end(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// How many whole periods lie before a time.
    pub(super) fn periods(&self, time: f64) -> f64 {
        match self.outside {
            Outside::Repeat => Float::floor((time - self.start()) / (self.end() - self.start())),
            _ => 0.0,
        }
    }

    fn place(&self, at: Moment) -> Place {
        let repeats_smoothly = self.kind == TableKind::Cubic && self.outside == Outside::Repeat;
        // A cubic that repeats has no kinks: the time within a piece, which is all of the motion then, may be in another period.
        let period = self.periods(if repeats_smoothly { at.time } else { at.within });
        let past = period * (self.end() - self.start());
        let (time, within) = (at.time - past, at.within - past);
        if self.outside != Outside::Repeat {
            if within < self.start() {
                return Place::Before;
            }
            if within >= self.end() {
                return Place::After;
            }
        }
        // Between its knots a cubic is as smooth as at them: the time decides.
        let found = match self.kind {
            TableKind::Cubic => time,
            _ => within,
        };
        let after = self.times.partition_point(|knot| *knot <= found);
        Place::Piece(after.clamp(1, self.times.len() - 1) - 1, time)
    }

    pub(super) fn value(&self, at: Moment) -> f64 {
        let held = |value: f64| match self.outside {
            Outside::Zero => 0.0,
            _ => value,
        };
        match self.place(at) {
            Place::Before => held(self.values[0]),
            Place::After => held(self.values[self.values.len() - 1]),
            Place::Piece(i, time) => self.piece(i, time).0,
        }
    }

    pub(super) fn slope(&self, at: Moment) -> f64 {
        match self.place(at) {
            Place::Before | Place::After => 0.0,
            Place::Piece(i, time) => self.piece(i, time).1,
        }
    }

    /// Value and slope of one piece.
    fn piece(&self, i: usize, time: f64) -> (f64, f64) {
        let length = self.times[i + 1] - self.times[i];
        let (a, b) = (self.values[i], self.values[i + 1]);
        let part = (time - self.times[i]) / length;
        let mean = (b - a) / length;
        match self.kind {
            TableKind::Constant => (a, 0.0),
            TableKind::Linear => (a + (b - a) * part, mean),
            TableKind::Cubic => {
                let (first, last) = (self.slopes[i], self.slopes[i + 1]);
                let bend = first + last - 2.0 * mean;
                let lean = 3.0 * mean - 2.0 * first - last;
                let rise = first + part * (lean + part * bend);
                let slope = first + part * (2.0 * lean + 3.0 * part * bend);
                (a + length * part * rise, slope)
            }
        }
    }

    pub(super) fn end_before_pulse(&self, step: [f64; 2]) -> f64 {
        match self.kind {
            TableKind::Cubic => pulses::end_before_in_table(self, step),
            TableKind::Constant | TableKind::Linear => step[1],
        }
    }

    /// The first time after `after` at which a piece ends. The pieces of a cubic are one.
    pub(super) fn next_kink(&self, after: f64) -> Option<f64> {
        let period = self.end() - self.start();
        let ends = [self.start(), self.end()];
        let knots: &[f64] = match (self.kind, self.outside) {
            (TableKind::Cubic, Outside::Repeat) => return None,
            (TableKind::Cubic, _) => &ends,
            _ => &self.times,
        };
        if self.outside != Outside::Repeat {
            let next = knots.partition_point(|knot| *knot <= after);
            return knots.get(next).copied();
        }
        // The period that `after` is in, and, should it end there up to rounding, the next.
        let past = self.periods(after);
        let later = [past, past + 1.0].into_iter();
        let later = later.flat_map(|past| knots.iter().map(move |knot| knot + past * period));
        later.filter(|kink| *kink > after).reduce(f64::min)
    }

    /// What of it jumps.
    pub(super) fn jump(&self) -> Option<&'static str> {
        let (first, last) = (self.values[0], self.values[self.values.len() - 1]);
        let steps = self.values.windows(2).any(|pair| pair[0] != pair[1]);
        match (self.kind, self.outside) {
            (TableKind::Constant, _) if steps => Some("a table of kind \"constant\""),
            (_, Outside::Zero) if first != 0.0 || last != 0.0 => {
                Some("a table that is \"zero\" outside and does not begin and end with 0")
            }
            (_, Outside::Repeat) if first != last => {
                Some("a table that repeats and does not end with the value that it begins with")
            }
            _ => None,
        }
    }
}
