//! What is asked for between the ends of steps: samples and events.

use super::dense::{Dense, Instant};
use super::driver::Driver;
use super::event::Event;
use super::event_location::{EventLocation, Found};
use super::flow::Flow;
use super::step_state::StepState;
use super::stepper::{Span, Stepper};
use super::{Crossing, Form, Observer, Sampling, State, Step, StepFailure};
use alloc::vec::Vec;

/// The dense output, and who wants it.
pub(super) struct Outputs<'a> {
    pub(super) dense: Dense,
    location: EventLocation<'a>,
    pub(super) sampling: Sampling,
}

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
        (flow, step_state, time): (&Flow<'_>, &StepState, f64),
    ) -> Result<Option<Self>, StepFailure> {
        if sampling == Sampling::Landing && events.is_empty() {
            return Ok(None);
        }
        let mut location = EventLocation::new(events);
        location.begin(time, &step_state.configuration, step_state.speeds())?;
        Ok(Some(Self {
            dense: Dense::new(order, flow),
            location,
            sampling,
        }))
    }

    /// Makes ready what is due in the step just accepted, which ends at `time`; whether anything is.
    fn prepare(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        stepper: &dyn Stepper,
        (time, has_sample): (f64, bool),
    ) -> Result<bool, StepFailure> {
        self.dense.finish(step_state, flow, time);
        let end = (time, &*step_state.configuration, step_state.speeds());
        let seen = self.location.glance(&mut self.dense, flow, end)?;
        if !seen && !has_sample {
            return Ok(false);
        }
        self.dense.raise(flow, stepper.stage_polynomial())?;
        if seen {
            self.location.locate(&mut self.dense, flow)?;
        }
        Ok(true)
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

    /// Shows and records what lies within the step just accepted, up to what ends the integration.
    pub(super) fn pass(&mut self, observer: &mut Observer<'_>) -> Result<(), StepFailure> {
        let Some(mut outputs) = self.outputs.take() else {
            return Ok(());
        };
        let outcome = self.pass_over(&mut outputs, observer);
        outputs.location.move_on();
        self.outputs = Some(outputs);
        outcome
    }

    fn pass_over(
        &mut self,
        outputs: &mut Outputs<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<(), StepFailure> {
        let at = (self.clock.time(), self.sample_within(outputs).is_some());
        let (flow, stepper) = (&mut self.flow, &*self.stepper);
        if !outputs.prepare(&self.step_state, flow, stepper, at)? {
            return Ok(());
        }
        let mut passed = 0;
        while self.end.is_none() {
            match outputs.next(passed, self.sample_within(outputs)) {
                None => break,
                Some(Due::Sample { part }) => self.sample(outputs, part, observer)?,
                Some(Due::Crossing(found)) => {
                    passed += 1;
                    self.record(outputs, found)?;
                }
            }
        }
        Ok(())
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
        let step = Step {
            time,
            number: self.statistics.steps,
            configuration: instant.configuration,
            speeds: instant.speeds,
            momenta: (self.flow.form == Form::Hamiltonian).then_some(instant.y),
            sample: Some(index),
            is_within: true,
        };
        if observer(&step).is_break() {
            self.end = Some(state.clone());
        }
        self.samples.push(state);
        Ok(())
    }

    fn record(&mut self, outputs: &mut Outputs<'_>, found: Found) -> Result<(), StepFailure> {
        let state = state_of(outputs.dense.at(&mut self.flow, found.part)?);
        let event = &outputs.location.events[found.event];
        if event.stops {
            self.end = Some(state.clone());
        }
        self.crossings.push(Crossing {
            event: found.event,
            name: event.name.clone(),
            rising: found.rising,
            state,
        });
        Ok(())
    }
}
