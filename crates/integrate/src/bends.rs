//! Places at which what elements exert, or inputs, bend: steps end on them, so that every method keeps its order and step control its tolerance.
//!
//! A step that has come past such a place is tried again, shorter, until it ends there. What is exerted is continuous, so that it is the same from
//! both sides, and a step that ends there has seen one of them alone.

use super::StepFailure;
use super::driver::Driver;
use super::flow::{Flow, retract};
use super::pacing::Pacing;
use super::step_state::StepState;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::elements::Element;

/// How near to a bend a step is to end, rad or m, or parts of a limit of inputs, for distances of 1: some roundings.
const NEAR: f64 = 1e-14;

/// A bend within this part of the beginning of a step counts as one at its beginning; otherwise what rests on it would never move on.
const LEAST_PART: f64 = 1e-6;

/// Tries at most to end on a bend. Each has twice the digits of the last but one, or more.
const MOST_TRIES: usize = 20;

/// The bends of a mechanism.
pub(super) struct Bends {
    elements: Vec<Arc<dyn Element>>,
    /// Two for each element and those of inputs, at the beginning of the step and at its end.
    start: Vec<f64>,
    end: Vec<f64>,
    /// The side of each bend on which the step is: 1 or −1, 0 where that is not known yet.
    sides: Vec<f64>,
    configuration: Vec<f64>,
    /// Room for those of inputs.
    of_inputs: Vec<f64>,
}

/// The zero of a function lies between these parts of a step.
#[derive(Clone, Copy)]
struct Bracket {
    index: usize,
    side: f64,
    low: Found,
    high: Found,
    /// Whether the last value was beyond the zero.
    last: Option<bool>,
}

/// Where a function was found, within a step.
#[derive(Clone, Copy)]
struct Found {
    part: f64,
    value: f64,
}

impl Bends {
    /// Those of a mechanism that is at a state.
    pub(super) fn new(
        flow: &mut Flow<'_>,
        step_state: &StepState,
        time: f64,
    ) -> Result<Self, StepFailure> {
        let q = &step_state.configuration;
        let mechanism = &flow.mechanism;
        let has_any =
            |element: &&Arc<dyn Element>| element.bends(mechanism, q).iter().any(|x| !x.is_nan());
        let elements: Vec<_> = mechanism
            .elements()
            .iter()
            .filter(has_any)
            .map(Arc::clone)
            .collect();
        let mut of_inputs = Vec::new();
        flow.input_bends(time, (q, &step_state.y), &mut of_inputs)?;
        let count = 2 * elements.len() + of_inputs.len();
        let mut bends = Self {
            elements,
            start: vec![0.0; count],
            end: vec![0.0; count],
            sides: vec![0.0; count],
            configuration: q.clone(),
            of_inputs,
        };
        bends.evaluate(flow);
        bends.settle(None);
        Ok(bends)
    }

    /// The functions at the configuration, and those of inputs as they are known.
    fn evaluate(&mut self, flow: &Flow<'_>) {
        let elements = self.elements.iter();
        let found = elements.flat_map(|own| own.bends(&flow.mechanism, &self.configuration));
        let found = found.chain(self.of_inputs.iter().copied());
        for (end, found) in self.end.iter_mut().zip(found) {
            *end = found;
        }
    }

    /// Looks at the point that the step has come to, at `time`.
    fn look(
        &mut self,
        flow: &mut Flow<'_>,
        step_state: &StepState,
        time: f64,
    ) -> Result<(), StepFailure> {
        let (base, phi) = (&step_state.base, &step_state.phi);
        retract(&flow.mechanism, base, phi, &mut self.configuration);
        let at = (&*self.configuration, &*step_state.next_y);
        flow.input_bends(time, at, &mut self.of_inputs)?;
        self.evaluate(flow);
        Ok(())
    }

    fn is_near(&self, index: usize) -> bool {
        self.end[index].abs() <= NEAR * self.start[index].abs().max(1.0)
    }

    /// The first function that has come to the other side.
    fn crossed(&self) -> Option<usize> {
        let mut all = 0..self.end.len();
        all.find(|&i| self.end[i] * self.sides[i] < 0.0 && !self.is_near(i))
    }

    /// The beginning of the step, of which the end is not known yet.
    fn bracket(&self, index: usize) -> Bracket {
        let low = Found {
            part: 0.0,
            value: self.start[index],
        };
        Bracket {
            index,
            side: self.sides[index],
            low,
            high: low,
            last: None,
        }
    }

    /// The step is taken; `crossed` is the function on whose zero it ends. Of any other that is near its zero the next step tells the side.
    fn settle(&mut self, crossed: Option<usize>) {
        for i in 0..self.sides.len() {
            let end = self.end[i];
            self.sides[i] = if crossed == Some(i) {
                -self.sides[i]
            } else if end.is_nan() || self.is_near(i) {
                0.0
            } else {
                end.signum()
            };
        }
        self.start.copy_from_slice(&self.end);
    }
}

impl Driver<'_> {
    /// Ends the step just tried on the first bend that it has come past, if there is one; the length that it has then.
    pub(super) fn land_on_bend(
        &mut self,
        pacing: &mut Pacing,
        step: f64,
    ) -> Result<f64, StepFailure> {
        if self.bends.end.is_empty() {
            return Ok(step);
        }
        let start = self.clock.time();
        self.bends
            .look(&mut self.flow, &self.step_state, start + step)?;
        let mut part = 1.0;
        let mut bracket: Option<Bracket> = None;
        for _ in 0..MOST_TRIES {
            let crossed = self.bends.crossed();
            let known = bracket.as_ref().map(|bracket| bracket.index);
            let Some(index) = crossed.or(known) else {
                break;
            };
            if crossed.is_none() && self.bends.is_near(index) {
                break;
            }
            let fitting = bracket.filter(|bracket| bracket.index == index);
            let mut own = fitting.unwrap_or_else(|| self.bends.bracket(index));
            own.narrow(part, self.bends.end[index], crossed.is_some());
            let next = own.next();
            bracket = Some(own);
            // Where the function begins at its zero, or time cannot resolve more.
            if next <= LEAST_PART || next >= 1.0 || next == part {
                break;
            }
            part = next;
            self.attempt(pacing, step * part)?;
            let time = start + step * part;
            self.bends.look(&mut self.flow, &self.step_state, time)?;
        }
        let located = bracket.map(|bracket| bracket.index);
        let is_there = located.filter(|&index| self.bends.is_near(index));
        self.statistics.bends += usize::from(is_there.is_some());
        self.bends.settle(is_there);
        Ok(step * part)
    }
}

impl Bracket {
    /// A new value becomes an end; the other end counts half if it has stayed twice (the Illinois variant of the false position).
    fn narrow(&mut self, part: f64, value: f64, is_beyond: bool) {
        let (moved, other) = match is_beyond {
            true => (&mut self.high, &mut self.low),
            false => (&mut self.low, &mut self.high),
        };
        let is_second = self.last == Some(is_beyond);
        *moved = Found { part, value };
        if is_second {
            other.value *= 0.5;
        }
        self.last = Some(is_beyond);
    }

    /// The next trial point: regula falsi, or bisection where the function is zero at the left end.
    fn next(&self) -> f64 {
        let Self { low, high, .. } = self;
        if low.value * self.side <= NEAR {
            return 0.5 * (low.part + high.part);
        }
        low.part - low.value * (high.part - low.part) / (high.value - low.value)
    }
}
