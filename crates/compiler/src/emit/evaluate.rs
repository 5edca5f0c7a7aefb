//! Lines in double precision: what the written code computes, operation by operation, without writing it; sines and cosines are the
//! standard functions.

use super::lines::{Formula, Line, Loop, Place};
use super::{Function, Lowered};
use crate::alike::Read;
use crate::graph::Argument;
use crate::graph::known::{call, primitive};
use crate::packs::WIDTH;
use hamel_runtime::scalar::Scalar;
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

impl Function {
    /// The results; `argument` holds the scalars of each argument. What is missing there is NaN.
    pub fn evaluate(&self, argument: impl Fn(Argument) -> Vec<f64>) -> Vec<f64> {
        self.evaluate_lines(&self.lines(), argument)
    }

    /// Its lines, for more than one evaluation.
    pub fn lines(&self) -> Lowered {
        Lowered::new(self, &[], &[])
    }

    /// Its lines with like limbs side by side, where it has them so, as they are written in Rust.
    pub fn packed_lines(&self) -> Lowered {
        Lowered::with_packs(self, &[], &[])
    }

    /// The results by [these lines of it](Self::lines).
    pub fn evaluate_lines(
        &self,
        lowered: &Lowered,
        argument: impl Fn(Argument) -> Vec<f64>,
    ) -> Vec<f64> {
        let given = |&(name, _): &(Argument, usize)| (Read::Argument(name), argument(name));
        let arrays = lowered.arrays.iter();
        let mut state = State {
            inputs: self.arguments.iter().map(given).collect(),
            rows: arrays
                .map(|(&width, &rows)| (width, vec![vec![f64::NAN; width]; rows]))
                .collect(),
            results: vec![f64::NAN; self.outputs.len()],
            names: FxHashMap::default(),
            lists: FxHashMap::default(),
            turn: Turn::default(),
            place: 0,
        };
        lowered.lines.iter().for_each(|line| state.line(line));
        let results = match &lowered.outputs {
            Some(outputs) => outputs.iter().map(|output| state.value(output)).collect(),
            None => state.results,
        };
        match &self.pairs {
            Some(pairs) => pairs.evaluate(&results),
            None => results,
        }
    }
}

/// Where a loop stands.
#[derive(Default)]
struct Turn {
    number: usize,
    places: Vec<usize>,
    numbers: Vec<f64>,
    /// Length and number of the row of each source.
    sources: FxHashMap<String, (usize, usize)>,
}

struct State {
    inputs: BTreeMap<Read, Vec<f64>>,
    rows: BTreeMap<usize, Vec<Vec<f64>>>,
    results: Vec<f64>,
    /// Values, and of what is side by side each number; a single one stands in all places.
    names: FxHashMap<String, [f64; WIDTH]>,
    /// Results of functions that have several.
    lists: FxHashMap<String, Vec<f64>>,
    turn: Turn,
    /// The place of the number that is evaluated among those side by side.
    place: usize,
}

impl State {
    fn line(&mut self, line: &Line) {
        match line {
            Line::Heading(_) => {}
            Line::Value(name, Formula::Several(function, arguments)) => {
                let arguments: Vec<f64> = arguments.iter().map(|one| self.value(one)).collect();
                let results = primitive(*function, &arguments);
                self.lists.insert(name.clone(), results);
            }
            Line::Value(name, formula) => {
                let values = self.values(formula);
                self.names.insert(name.clone(), values);
            }
            Line::SinCos(sin, cos, angle) => self.sin_cos(sin, cos, angle),
            Line::SinCosAll(all) => all
                .iter()
                .for_each(|(sin, cos, angle)| self.sin_cos(sin, cos, angle)),
            Line::Angles(angles) => {
                let angles: Vec<f64> = angles.iter().map(|angle| self.value(angle)).collect();
                let of = |function: fn(f64) -> f64| angles.iter().copied().map(function).collect();
                self.inputs.insert(Read::Sines, of(f64::sin));
                self.inputs.insert(Read::Cosines, of(f64::cos));
            }
            Line::Row(row) => {
                let values = row.values.iter().map(|value| self.value(value)).collect();
                let place = self.place(row.place);
                let rows = self.rows.get_mut(&row.values.len());
                if let Some(row) = rows.and_then(|rows| rows.get_mut(place)) {
                    *row = values;
                }
            }
            Line::Result(place, formula) => {
                let (place, value) = (self.place(*place), self.value(formula));
                if let Some(result) = self.results.get_mut(place) {
                    *result = value;
                }
            }
            Line::Extracted(names, formula) => {
                let values = self.values(formula);
                for (name, value) in names.iter().zip(values) {
                    self.names.insert(name.clone(), [value; WIDTH]);
                }
            }
            Line::Loop(looped) => (0..looped.bodies.len()).for_each(|turn| self.turn(looped, turn)),
        }
    }

    fn turn(&mut self, looped: &Loop, number: usize) {
        self.turn = Turn {
            number,
            places: looped.places[number].clone(),
            numbers: looped.numbers[number].clone(),
            sources: FxHashMap::default(),
        };
        for (name, width, place) in &looped.sources {
            let row = self.place(*place);
            self.turn.sources.insert(name.clone(), (*width, row));
        }
        looped.lines.iter().for_each(|line| self.line(line));
    }

    fn sin_cos(&mut self, sin: &str, cos: &str, angle: &Formula) {
        let (sine, cosine) = self.value(angle).sin_cos();
        self.names.insert(sin.to_owned(), [sine; WIDTH]);
        self.names.insert(cos.to_owned(), [cosine; WIDTH]);
    }

    fn place(&self, place: Place) -> usize {
        let moved = |start: i64, by: i64| usize::try_from(start + by).unwrap_or(usize::MAX);
        match place {
            Place::Known(place) => place,
            Place::Along { start, step } => moved(start, step * self.turn.number as i64),
            Place::Listed { column, offset } => moved(self.turn.places[column] as i64, offset),
        }
    }

    fn row(&self, width: usize, row: usize, entry: usize) -> f64 {
        let row = self.rows.get(&width).and_then(|rows| rows.get(row));
        row.and_then(|row| row.get(entry))
            .copied()
            .unwrap_or(f64::NAN)
    }

    /// The numbers side by side.
    fn values(&mut self, formula: &Formula) -> [f64; WIDTH] {
        let mut values = [f64::NAN; WIDTH];
        for (place, value) in values.iter_mut().enumerate() {
            self.place = place;
            *value = self.value(formula);
        }
        self.place = 0;
        values
    }

    fn value(&self, formula: &Formula) -> f64 {
        match formula {
            Formula::Number(number) => *number,
            Formula::Column(column) => self.turn.numbers[*column],
            Formula::Input(array, place) => {
                let entry = self
                    .inputs
                    .get(array)
                    .and_then(|array| array.get(self.place(*place)));
                entry.copied().unwrap_or(f64::NAN)
            }
            Formula::Source(name, entry) => {
                let source = self.turn.sources.get(name);
                source.map_or(f64::NAN, |&(width, row)| self.row(width, row, *entry))
            }
            Formula::Row(width, row, entry) => self.row(*width, *row, *entry),
            Formula::Name(name) => self.names.get(name).map_or(f64::NAN, |of| of[self.place]),
            Formula::Gathered(numbers) => self.value(&numbers[self.place]),
            Formula::Sum(terms) => self.sum(terms),
            Formula::Product(a, b) => self.value(a) * self.value(b),
            Formula::Quotient(a, b) => self.value(a) / self.value(b),
            Formula::Negative(inner) => -self.value(inner),
            Formula::Call(function, arguments) => {
                let mut arguments = arguments.iter().map(|one| self.value(one));
                let first = arguments.next().unwrap_or(f64::NAN);
                call(*function, first, arguments.next())
            }
            Formula::Part(of, result) => {
                let Formula::Name(name) = &**of else {
                    return f64::NAN;
                };
                let results = self.lists.get(name);
                let result = results.and_then(|results| results.get(*result));
                result.copied().unwrap_or(f64::NAN)
            }
            // Has a line of its own.
            Formula::Several(..) | Formula::Lane(..) => f64::NAN,
        }
    }

    /// Terms that are products are added by multiply–adds.
    fn sum(&self, terms: &[(bool, Formula)]) -> f64 {
        let signed = |minus: bool, value: f64| if minus { -value } else { value };
        let mut terms = Formula::in_order(terms).into_iter();
        let Some((minus, first)) = terms.next() else {
            return 0.0;
        };
        let start = signed(*minus, self.value(first));
        terms.fold(start, |sum, (minus, term)| match term {
            Formula::Product(a, b) => {
                Scalar::mul_add(signed(*minus, self.value(a)), self.value(b), sum)
            }
            term => sum + signed(*minus, self.value(term)),
        })
    }
}
