//! Finds the crossings of events, and of the guards that end a piece, within one step.

use super::StepFailure;
use super::dense::{Dense, Instant};
use super::event::{Direction, Event};
use super::flow::Flow;
use super::hybrid::{Guard, Guards, resolution};
use super::root::cross;
use alloc::vec;
use alloc::vec::Vec;

/// In how many parts a step is looked at.
pub(super) const PARTS: usize = 4;

/// A crossing within the step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Where, from 0 to 1.
    pub(super) part: f64,
    /// Index of the event; guards follow the events.
    pub(super) event: usize,
    pub(super) rising: bool,
}

/// What is known of the events' functions.
pub(super) struct EventLocation<'a> {
    pub(super) events: Vec<Event<'a>>,
    guards: Option<Guards>,
    /// Whether the piece that they end begins with the step.
    is_first: bool,
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
            guards: None,
            is_first: true,
        }
    }

    /// From here on, with the guards of a piece: takes note of the state at which it begins. A jump of an event's function crosses nothing.
    pub(super) fn begin(
        &mut self,
        flow: &mut Flow<'_>,
        instant: &Instant<'_>,
        guards: Option<Guards>,
    ) -> Result<(), StepFailure> {
        let count = self.events.len() + guards.as_ref().map_or(0, |guards| guards.list.len());
        self.sides.resize(count, 0.0);
        self.values.resize(count, [0.0; PARTS + 1]);
        self.guards = guards;
        self.is_first = true;
        self.read(flow, instant, PARTS)?;
        let (events, guards) = self.sides.split_at_mut(self.events.len());
        for (side, values) in events.iter_mut().zip(&self.values) {
            let value = values[PARTS];
            *side = if value == 0.0 { *side } else { value };
        }
        // Where a piece begins, its guards are 0 or more, up to rounding.
        guards.fill(1.0);
        Ok(())
    }

    /// The guards that a jump of the inputs has made negative at `instant`.
    pub(super) fn broken(
        &mut self,
        flow: &mut Flow<'_>,
        instant: &Instant<'_>,
    ) -> Result<Vec<Guard>, StepFailure> {
        let Some(guards) = self.guards.as_mut().filter(|guards| guards.holds()) else {
            return Ok(Vec::new());
        };
        let mut broken = Vec::new();
        guards.values(flow, instant, |index, value| {
            if value < 0.0 {
                broken.push(index);
            }
        })?;
        let list = broken.into_iter().map(|index| guards.list[index]);
        Ok(list.filter(|guard| guard.is_of_holding()).collect())
    }

    /// The values of all functions, at the end of that part of the step.
    fn read(
        &mut self,
        flow: &mut Flow<'_>,
        instant: &Instant<'_>,
        part: usize,
    ) -> Result<(), StepFailure> {
        let (events, guards) = self.values.split_at_mut(self.events.len());
        for (event, values) in self.events.iter_mut().zip(events) {
            values[part] = value_at(event, instant)?;
        }
        match &mut self.guards {
            Some(own) => own.values(flow, instant, |index, value| guards[index][part] = value),
            None => Ok(()),
        }
    }

    /// Looks at the step between the last end and this one on the cubic; whether something seems to be crossed in it.
    pub(super) fn glance(
        &mut self,
        dense: &mut Dense,
        flow: &mut Flow<'_>,
        end: &Instant<'_>,
    ) -> Result<bool, StepFailure> {
        for values in &mut self.values {
            values[0] = values[PARTS];
        }
        self.read(flow, end, PARTS)?;
        self.look_again(dense, flow)
    }

    /// Looks at the same step on the polynomial as it stands now.
    pub(super) fn look_again(
        &mut self,
        dense: &mut Dense,
        flow: &mut Flow<'_>,
    ) -> Result<bool, StepFailure> {
        self.look_between(dense, flow)?;
        let mut seen = self.sides.iter().zip(&self.values);
        Ok(seen.any(|(side, values)| changes(*side, values).next().is_some()))
    }

    /// Whether a guard that nothing seems to cross has a least value within the step that is small.
    pub(super) fn may_dip(&self) -> bool {
        let guards = self.values.get(self.events.len()..).unwrap_or_default();
        guards.iter().any(resolution::may_dip)
    }

    /// Whether guards change too much within the step for four parts of it to tell what they do.
    pub(super) fn is_unresolved(&self) -> bool {
        let guards = self.values.get(self.events.len()..).unwrap_or_default();
        guards
            .iter()
            .any(|values| resolution::is_unresolved(values, self.is_first))
    }

    /// The step just looked at is not taken.
    pub(super) fn go_back(&mut self) {
        self.found.clear();
        for values in &mut self.values {
            values[PARTS] = values[0];
        }
    }

    fn look_between(&mut self, dense: &mut Dense, flow: &mut Flow<'_>) -> Result<(), StepFailure> {
        for i in 1..PARTS {
            let instant = dense.at(flow, i as f64 / PARTS as f64)?;
            self.read(flow, &instant, i)?;
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
            guards,
            sides,
            values,
            found,
            ..
        } = self;
        let end = |index: usize, i: usize| (i as f64 / PARTS as f64, values[index][i]);
        for (index, event) in events.iter_mut().enumerate() {
            for (i, rising) in changes(sides[index], &values[index]) {
                if !counts(event.direction, rising) {
                    continue;
                }
                let ends = (end(index, i - 1), end(index, i));
                let part = cross(ends.0, ends.1, dense.resolution(), |part| {
                    value_at(event, &dense.at(flow, part)?)
                })?;
                found.push(Found {
                    part,
                    event: index,
                    rising,
                });
            }
        }
        if let Some(guards) = guards {
            for index in 0..guards.list.len() {
                let event = events.len() + index;
                let mut falls = changes(sides[event], &values[event]);
                let Some((i, _)) = falls.find(|(_, rising)| !rising) else {
                    continue;
                };
                let (from, mut at_from) = end(event, i - 1);
                // Where the piece begins, 0 counts as its inside.
                at_from = at_from.max(f64::MIN_POSITIVE);
                let part = cross((from, at_from), end(event, i), f64::EPSILON, |part| {
                    let instant = dense.at(flow, part)?;
                    guards.value(index, flow, &instant)
                })?;
                found.push(Found {
                    part,
                    event,
                    rising: false,
                });
            }
        }
        found.sort_unstable_by(|a, b| a.part.total_cmp(&b.part).then(a.event.cmp(&b.event)));
        Ok(())
    }

    /// The part of the step in which the piece ends, if it does.
    pub(super) fn piece_end(&self) -> Option<f64> {
        let events = self.events.len();
        let mut ends = self.found.iter().filter(|found| found.event >= events);
        ends.next().map(|found| found.part)
    }

    /// The guards that are crossed as early as `first`, which is one of them; none where it is an event.
    pub(super) fn ended_by(&self, first: Found) -> Vec<Guard> {
        let Some(guards) = &self.guards else {
            return Vec::new();
        };
        let guard_of = |found: &Found| {
            let index = found.event.checked_sub(self.events.len())?;
            guards.list.get(index).copied()
        };
        if guard_of(&first).is_none() {
            return Vec::new();
        }
        let together = |found: &&Found| found.part - first.part <= 4.0 * f64::EPSILON;
        let found = self.found.iter().filter(|found| found.part >= first.part);
        found.filter(together).filter_map(guard_of).collect()
    }

    /// The step is over.
    pub(super) fn move_on(&mut self) {
        self.found.clear();
        self.is_first = false;
        let events = self.sides.iter_mut().take(self.events.len());
        for (side, values) in events.zip(&self.values) {
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

fn value_at(event: &mut Event<'_>, instant: &Instant<'_>) -> Result<f64, StepFailure> {
    let value = (event.function)(instant.time, instant.configuration, instant.speeds);
    if value.is_finite() {
        return Ok(value);
    }
    Err(StepFailure::Event {
        event: event.name.clone(),
        value,
    })
}
