//! What is asked for between the ends of steps: samples and events.

use super::dense::{Dense, Instant};
use super::driver::Driver;
use super::event::Event;
use super::event_location::{EventLocation, Found};
use super::flow::Flow;
use super::hybrid::{Guard, Guards, Hybrid};
use super::step_state::StepState;
use super::stepper::{Span, Stepper};
use super::{Crossing, Form, Observer, Sampling, State, Step, StepFailure};
use alloc::vec::Vec;

/// The dense output, and who wants it.
pub(super) struct Outputs<'a> {
    pub(super) dense: Dense,
    pub(super) location: EventLocation<'a>,
    pub(super) sampling: Sampling,
}

/// What has become of a step that was accepted.
pub(super) enum Passed {
    /// It is behind, with all that lies within it.
    Whole,
    /// A piece of the motion ends within it.
    Until(PieceEnd),
    /// It is too long to tell what ends pieces, and shall be tried again with this part of its length.
    TooLong(f64),
}

/// Where a piece of the motion ends.
pub(super) struct PieceEnd {
    /// The part of the step that has been made.
    pub(super) part: f64,
    pub(super) state: State,
    /// [`Step::travel`] there.
    pub(super) travel: Vec<f64>,
    pub(super) guards: Vec<Guard>,
}

/// What is due within a step.
enum Within {
    Nothing,
    Something,
    Unresolved,
}

/// Pieces that end within this part of a step are told by a step of that length: next to the whole one, little is left of their digits.
const EARLY: f64 = 0.1;

/// What comes next within a step.
enum Due {
    Sample { part: f64 },
    Crossing(Found),
}

impl<'a> Outputs<'a> {
    /// Nothing where nothing is asked for.
    pub(super) fn new(
        sampling: Sampling,
        events: Vec<Event<'a>>,
        order: u32,
        guards: Option<Guards>,
        (flow, step_state, time): (&mut Flow<'_>, &StepState, f64),
    ) -> Result<Option<Self>, StepFailure> {
        if sampling == Sampling::Landing && events.is_empty() && guards.is_none() {
            return Ok(None);
        }
        let mut outputs = Self {
            dense: Dense::new(order, flow),
            location: EventLocation::new(events),
            sampling,
        };
        let instant = step_state.instant(time);
        outputs.location.begin(flow, &instant, guards)?;
        Ok(Some(outputs))
    }

    /// Goes on with another piece of the motion.
    pub(super) fn restart(
        &mut self,
        guards: Guards,
        order: u32,
        (flow, step_state, time): (&mut Flow<'_>, &StepState, f64),
    ) -> Result<(), StepFailure> {
        self.dense = Dense::new(order, flow);
        let instant = step_state.instant(time);
        self.location.begin(flow, &instant, Some(guards))
    }

    /// Makes ready what is due in the step just accepted, which ends at `time`; guards of steps of `short` and less are trusted as they are.
    fn prepare(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        stepper: &dyn Stepper,
        (time, has_sample, is_short): (f64, bool, bool),
    ) -> Result<Within, StepFailure> {
        self.dense.finish(step_state, flow, time);
        let end = step_state.instant(time);
        let mut seen = self.location.glance(&mut self.dense, flow, &end)?;
        if !seen && self.location.may_dip() {
            // The cubic is not good enough to tell.
            self.dense.raise(flow, stepper.stage_polynomial())?;
            seen = self.location.look_again(&mut self.dense, flow)?;
        }
        if !is_short && self.location.is_unresolved() {
            return Ok(Within::Unresolved);
        }
        if !seen && !has_sample {
            return Ok(Within::Nothing);
        }
        self.dense.raise(flow, stepper.stage_polynomial())?;
        if seen {
            self.location.locate(&mut self.dense, flow)?;
        }
        Ok(Within::Something)
    }

    /// What comes next, after `passed` crossings; `sample` is the time of the next sample within the step.
    fn next(&self, passed: usize, sample: Option<f64>) -> Option<Due> {
        let sample = sample.map(|time| self.dense.part(time));
        let crossing = self.location.found.get(passed);
        match (sample, crossing) {
            (Some(part), Some(found)) if found.part < part => Some(Due::Crossing(*found)),
            (Some(part), _) => Some(Due::Sample { part }),
            (None, found) => found.copied().map(Due::Crossing),
        }
    }
}

fn state_of(instant: Instant<'_>) -> State {
    State {
        time: instant.time,
        configuration: instant.configuration.to_vec(),
        speeds: instant.speeds.to_vec(),
    }
}

impl Driver<'_> {
    /// A step over `span` is about to be accepted.
    pub(super) fn leave(&mut self, span: Span) {
        if let Some(outputs) = &mut self.outputs {
            outputs.dense.begin(&self.step_state, span);
        }
    }

    /// Shows and records what lies within the step just accepted, up to what ends the integration or the piece.
    pub(super) fn pass(
        &mut self,
        step: f64,
        observer: &mut Observer<'_>,
    ) -> Result<Passed, StepFailure> {
        let Some(mut outputs) = self.outputs.take() else {
            return Ok(Passed::Whole);
        };
        let outcome = self.pass_over(&mut outputs, step, observer);
        match outcome {
            Ok(Passed::TooLong(_)) => outputs.location.go_back(),
            _ => outputs.location.move_on(),
        }
        self.outputs = Some(outputs);
        outcome
    }

    fn pass_over(
        &mut self,
        outputs: &mut Outputs<'_>,
        step: f64,
        observer: &mut Observer<'_>,
    ) -> Result<Passed, StepFailure> {
        let has_sample = self.sample_within(outputs).is_some();
        let short = self.hybrid.as_ref().map_or(0.0, Hybrid::short);
        let least = f64::EPSILON * short;
        let at = (self.clock.time(), has_sample, step <= short);
        let (flow, stepper) = (&mut self.flow, &*self.stepper);
        match outputs.prepare(&self.step_state, flow, stepper, at)? {
            Within::Nothing => return Ok(Passed::Whole),
            Within::Unresolved => return Ok(Passed::TooLong(0.5)),
            Within::Something => {}
        }
        let end = outputs.location.piece_end().filter(|part| *part < EARLY);
        if end.is_some() && step > least {
            return Ok(Passed::TooLong(EARLY));
        }
        let mut passed = 0;
        while self.end.is_none() {
            match outputs.next(passed, self.sample_within(outputs)) {
                None => break,
                Some(Due::Sample { part }) => self.sample(outputs, part, observer)?,
                Some(Due::Crossing(found)) => {
                    let guards = outputs.location.ended_by(found);
                    if !guards.is_empty() {
                        let part = found.part;
                        let instant = outputs.dense.at(&mut self.flow, part)?;
                        instant.travel(&mut self.travel);
                        return Ok(Passed::Until(PieceEnd {
                            part,
                            state: state_of(instant),
                            travel: self.travel.clone(),
                            guards,
                        }));
                    }
                    passed += 1;
                    self.record(outputs, found)?;
                }
            }
        }
        Ok(Passed::Whole)
    }

    /// The next sample, where it lies within the step and is not to be landed on.
    fn sample_within(&self, outputs: &Outputs<'_>) -> Option<f64> {
        let time = self.options.samples.get(self.samples.len()).copied()?;
        let lies_within = outputs.sampling == Sampling::Dense && time < self.clock.time();
        lies_within.then_some(time)
    }

    fn sample(
        &mut self,
        outputs: &mut Outputs<'_>,
        part: f64,
        observer: &mut Observer<'_>,
    ) -> Result<(), StepFailure> {
        let index = self.samples.len();
        let time = self.options.samples[index];
        let instant = outputs.dense.at(&mut self.flow, part)?;
        let state = State {
            time,
            ..state_of(instant)
        };
        instant.travel(&mut self.travel);
        let at = (instant.configuration, instant.speeds);
        let carried = self.carried.as_mut();
        let hybrid = self.hybrid.as_ref();
        let carried = carried.map(|carried| carried.at((&mut self.flow, hybrid), time, at));
        let carried = carried.transpose()?;
        let step = Step {
            time,
            number: self.statistics.steps,
            configuration: instant.configuration,
            speeds: instant.speeds,
            travel: &self.travel,
            momenta: (self.flow.form == Form::Hamiltonian).then_some(instant.y),
            sample: Some(index),
            is_within: true,
            carried,
        };
        if observer(&step).is_break() {
            self.end = Some(state.clone());
        }
        self.samples.push(state);
        Ok(())
    }

    fn record(&mut self, outputs: &mut Outputs<'_>, found: Found) -> Result<(), StepFailure> {
        let instant = outputs.dense.at(&mut self.flow, found.part)?;
        instant.travel(&mut self.travel);
        let state = state_of(instant);
        let event = &mut outputs.location.events[found.event];
        if let Some(condition) = &mut event.condition
            && !condition(state.time, &state.configuration, &state.speeds)
        {
            return Ok(());
        }
        if event.stops {
            self.end = Some(state.clone());
        }
        self.crossings.push(Crossing {
            event: found.event,
            joint: None,
            name: event.name.clone(),
            rising: found.rising,
            state,
        });
        Ok(())
    }
}
