//! What is asked for between the ends of steps: samples and events.

use super::dense::{Dense, Instant};
use super::driver::Driver;
use super::event::Event;
use super::flow::Flow;
use super::lookout::{Found, Lookout};
use super::standing::Standing;
use super::stepper::{Span, Stepper};
use super::{Crossing, Form, Observer, Sampling, State, Step, StepFailure};
use alloc::vec::Vec;

/// The dense output, and who wants it.
pub(super) struct Between<'a> {
    pub(super) dense: Dense,
    lookout: Lookout<'a>,
    pub(super) sampling: Sampling,
}

/// What comes next within a step.
enum Due {
    Sample { part: f64 },
    Crossing(Found),
}

impl<'a> Between<'a> {
    /// Nothing where nothing is asked for.
    pub(super) fn new(
        sampling: Sampling,
        events: Vec<Event<'a>>,
        order: u32,
        (flow, standing, time): (&Flow<'_>, &Standing, f64),
    ) -> Result<Option<Self>, StepFailure> {
        if sampling == Sampling::Landing && events.is_empty() {
            return Ok(None);
        }
        let mut lookout = Lookout::new(events);
        lookout.begin(time, &standing.configuration, standing.speeds())?;
        Ok(Some(Self {
            dense: Dense::new(order, flow),
            lookout,
            sampling,
        }))
    }

    /// Makes ready what is due in the step just accepted, which ends at `time`; whether anything is.
    fn prepare(
        &mut self,
        standing: &Standing,
        flow: &mut Flow<'_>,
        stepper: &dyn Stepper,
        (time, has_sample): (f64, bool),
    ) -> Result<bool, StepFailure> {
        self.dense.finish(standing, flow, time);
        let end = (time, &*standing.configuration, standing.speeds());
        let seen = self.lookout.glance(&mut self.dense, flow, end)?;
        if !seen && !has_sample {
            return Ok(false);
        }
        self.dense.raise(flow, stepper.stage_polynomial())?;
        if seen {
            self.lookout.locate(&mut self.dense, flow)?;
        }
        Ok(true)
    }

    /// What comes next, after `passed` crossings; `sample` is the time of the next sample within the step.
    fn next(&self, passed: usize, sample: Option<f64>) -> Option<Due> {
        let sample = sample.map(|time| self.dense.part(time));
        let crossing = self.lookout.found.get(passed);
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
        if let Some(between) = &mut self.between {
            between.dense.begin(&self.standing, span);
        }
    }

    /// Shows and records what lies within the step just accepted, up to what ends the integration.
    pub(super) fn pass(&mut self, observer: &mut Observer<'_>) -> Result<(), StepFailure> {
        let Some(mut between) = self.between.take() else {
            return Ok(());
        };
        let outcome = self.pass_over(&mut between, observer);
        between.lookout.move_on();
        self.between = Some(between);
        outcome
    }

    fn pass_over(
        &mut self,
        between: &mut Between<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<(), StepFailure> {
        let at = (self.clock.time(), self.sample_within(between).is_some());
        let (flow, stepper) = (&mut self.flow, &*self.stepper);
        if !between.prepare(&self.standing, flow, stepper, at)? {
            return Ok(());
        }
        let mut passed = 0;
        while self.end.is_none() {
            match between.next(passed, self.sample_within(between)) {
                None => break,
                Some(Due::Sample { part }) => self.sample(between, part, observer)?,
                Some(Due::Crossing(found)) => {
                    passed += 1;
                    self.record(between, found)?;
                }
            }
        }
        Ok(())
    }

    /// The next sample, where it lies within the step and is not to be landed on.
    fn sample_within(&self, between: &Between<'_>) -> Option<f64> {
        let time = self.options.samples.get(self.samples.len()).copied()?;
        let lies_within = between.sampling == Sampling::Dense && time < self.clock.time();
        lies_within.then_some(time)
    }

    fn sample(
        &mut self,
        between: &mut Between<'_>,
        part: f64,
        observer: &mut Observer<'_>,
    ) -> Result<(), StepFailure> {
        let index = self.samples.len();
        let time = self.options.samples[index];
        let instant = between.dense.at(&mut self.flow, part)?;
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

    fn record(&mut self, between: &mut Between<'_>, found: Found) -> Result<(), StepFailure> {
        let state = state_of(between.dense.at(&mut self.flow, found.part)?);
        let event = &between.lookout.events[found.event];
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
