//! Finds the crossings of events within one step.

use super::StepFailure;
use super::dense::{Dense, Instant};
use super::event::{Direction, Event};
use super::flow::Flow;
use super::root::cross;
use alloc::vec;
use alloc::vec::Vec;

/// In how many parts a step is looked at.
const PARTS: usize = 4;

/// A crossing within the step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Where, from 0 to 1.
    pub(super) part: f64,
    /// Index of the event.
    pub(super) event: usize,
    pub(super) rising: bool,
}

/// What is known of the events' functions.
pub(super) struct EventLocation<'a> {
    pub(super) events: Vec<Event<'a>>,
    /// The last value of each that was not 0; 0 where there has been none.
    sides: Vec<f64>,
    /// The values of each at the ends of all parts of the step.
    values: Vec<[f64; PARTS + 1]>,
    /// In the order of time.
    pub(super) found: Vec<Found>,
}

impl<'a> EventLocation<'a> {
    pub(super) fn new(events: Vec<Event<'a>>) -> Self {
        Self {
            sides: vec![0.0; events.len()],
            values: vec![[0.0; PARTS + 1]; events.len()],
            found: Vec::with_capacity(events.len() * PARTS),
            events,
        }
    }

    /// Takes note of the initial state.
    pub(super) fn begin(
        &mut self,
        time: f64,
        q: &[f64],
        speeds: &[f64],
    ) -> Result<(), StepFailure> {
        for (index, event) in self.events.iter_mut().enumerate() {
            let value = value_of(event, time, q, speeds)?;
            self.values[index][PARTS] = value;
            self.sides[index] = value;
        }
        Ok(())
    }

    /// Looks at the step between the last end and this one on the cubic; whether something seems to be crossed in it.
    pub(super) fn glance(
        &mut self,
        dense: &mut Dense,
        flow: &mut Flow<'_>,
        (time, q, speeds): (f64, &[f64], &[f64]),
    ) -> Result<bool, StepFailure> {
        for (event, values) in self.events.iter_mut().zip(&mut self.values) {
            values[0] = values[PARTS];
            values[PARTS] = value_of(event, time, q, speeds)?;
        }
        self.look_between(dense, flow)?;
        let mut seen = self.sides.iter().zip(&self.values);
        Ok(seen.any(|(side, values)| changes(*side, values).next().is_some()))
    }

    fn look_between(&mut self, dense: &mut Dense, flow: &mut Flow<'_>) -> Result<(), StepFailure> {
        for i in 1..PARTS {
            let instant = dense.at(flow, i as f64 / PARTS as f64)?;
            for (event, values) in self.events.iter_mut().zip(&mut self.values) {
                values[i] = value_at(event, instant)?;
            }
        }
        Ok(())
    }

    /// Locates what is crossed, on the raised polynomial.
    pub(super) fn locate(
        &mut self,
        dense: &mut Dense,
        flow: &mut Flow<'_>,
    ) -> Result<(), StepFailure> {
        self.look_between(dense, flow)?;
        let Self {
            events,
            sides,
            values,
            found,
        } = self;
        for (index, event) in events.iter_mut().enumerate() {
            for (i, rising) in changes(sides[index], &values[index]) {
                if !counts(event.direction, rising) {
                    continue;
                }
                let end = |i: usize| (i as f64 / PARTS as f64, values[index][i]);
                let part = cross(end(i - 1), end(i), dense.resolution(), |part| {
                    value_at(event, dense.at(flow, part)?)
                })?;
                found.push(Found {
                    part,
                    event: index,
                    rising,
                });
            }
        }
        found.sort_unstable_by(|a, b| a.part.total_cmp(&b.part).then(a.event.cmp(&b.event)));
        Ok(())
    }

    /// The step is over.
    pub(super) fn move_on(&mut self) {
        self.found.clear();
        for (side, values) in self.sides.iter_mut().zip(&self.values) {
            let last = values.iter().rev().find(|value| **value != 0.0);
            *side = last.copied().unwrap_or(*side);
        }
    }
}

/// The parts of a step, by their last ends, over which a function changes its sign, and whether it rises; what is 0 belongs to no side.
fn changes(side: f64, values: &[f64; PARTS + 1]) -> impl Iterator<Item = (usize, bool)> {
    let mut side = side;
    let values = values.iter().enumerate().skip(1);
    values.filter_map(move |(i, &value)| {
        if value == 0.0 {
            return None;
        }
        let before = core::mem::replace(&mut side, value);
        let changes = before != 0.0 && (before > 0.0) != (value > 0.0);
        changes.then_some((i, value > 0.0))
    })
}

const fn counts(direction: Direction, rising: bool) -> bool {
    match direction {
        Direction::Any => true,
        Direction::Rising => rising,
        Direction::Falling => !rising,
    }
}

fn value_at(event: &mut Event<'_>, instant: Instant<'_>) -> Result<f64, StepFailure> {
    value_of(event, instant.time, instant.configuration, instant.speeds)
}

fn value_of(
    event: &mut Event<'_>,
    time: f64,
    q: &[f64],
    speeds: &[f64],
) -> Result<f64, StepFailure> {
    let value = (event.function)(time, q, speeds);
    if value.is_finite() {
        return Ok(value);
    }
    Err(StepFailure::Event {
        event: event.name.clone(),
        value,
    })
}
