//! From the initial time to the last, by accepted steps, over the sample times.

use super::approach::Watch;
use super::bends::Bends;
use super::carried::Carried;
use super::clock::Clock;
use super::flow::Flow;
use super::hybrid::{Guards, Hybrid};
use super::inputs::{Given, Hold};
use super::kinks::Kinks;
use super::outputs::{Outputs, Passed};
use super::pacing::Pacing;
use super::pieces::{FirstPiece, resolving};
use super::prospect::Prospect;
use super::reconsider::Reconsideration;
use super::stalls;
use super::step_state::StepState;
use super::stepper::{self, Span, Stepper};
use super::waypoints::Waypoints;
use super::{
    Crossing, Event, Form, IntegrateError, Near, Observer, Options, Sampling, Scheme, Solution,
    State, Statistics, Step, StepErrors, StepFailure,
};
use alloc::boxed::Box;
use alloc::vec::Vec;
use hamel_runtime::dynamics::Dynamics;

/// An integration under way.
pub(super) struct Driver<'a> {
    pub(super) flow: Flow<'a>,
    pub(super) step_state: StepState,
    pub(super) stepper: Box<dyn Stepper>,
    /// That of the stepper.
    pub(super) scheme: Scheme,
    /// The choice of the scheme, where it was left open.
    pub(super) reconsideration: Option<Reconsideration>,
    pub(super) options: &'a Options,
    pub(super) hold: Option<Hold>,
    pub(super) kinks: Kinks,
    pub(super) bends: Bends,
    pub(super) clock: Clock,
    pub(super) start: f64,
    pub(super) statistics: Statistics,
    step_errors: StepErrors,
    pub(super) samples: Vec<State>,
    pub(super) crossings: Vec<Crossing>,
    pub(super) watch: Watch,
    waypoints: Waypoints,
    prospect: Prospect,
    /// What is wanted between the ends of steps, if anything is.
    pub(super) outputs: Option<Outputs<'a>>,
    /// What makes the motion go by pieces, if anything does.
    pub(super) hybrid: Option<Hybrid<'a>>,
    /// The longest step that tells of the ends of pieces, s.
    pub(super) resolving: f64,
    /// Where something within a step has ended the integration.
    pub(super) end: Option<State>,
    /// [`Step::travel`] of the state that was shown last, or at which the integration ends.
    pub(super) travel: Vec<f64>,
    /// What the joints carry at samples, where that is asked for.
    pub(super) carried: Option<Carried>,
}

/// What an integration is asked for beside its options.
pub(super) struct Wanted<'a> {
    pub(super) sampling: Sampling,
    pub(super) events: Vec<Event<'a>>,
    /// Whether the method is looked at again on the way.
    pub(super) is_open: bool,
    /// Whether samples tell what the joints carry.
    pub(super) tells_forces: bool,
}

impl<'a> Driver<'a> {
    pub(super) fn new(
        dynamics: &'a mut dyn Dynamics,
        initial: &State,
        options: &'a Options,
        period: Option<f64>,
        inputs: Given<'a>,
        wanted: Wanted<'a>,
    ) -> Result<Self, IntegrateError> {
        let Wanted {
            sampling,
            events,
            is_open,
            tells_forces,
        } = wanted;
        let mut flow = Flow::new(dynamics, inputs, options.form);
        let watch = Watch::new(&flow.mechanism);
        let time = initial.time;
        let kinks = Kinks::new(&mut flow, time, options.t_end);
        let kinks = kinks.map_err(|cause| IntegrateError::AtState {
            time,
            cause: Box::new(cause.into()),
            near: Near::default(),
        })?;
        if period.is_some() {
            flow.hold(time, &initial.configuration, &initial.speeds);
        }
        let first = FirstPiece::new(&mut flow, initial, (options.t_end - time, events.len()))?;
        let FirstPiece {
            hybrid,
            guards,
            state,
            crossings,
        } = first;
        let holds = guards.as_ref().is_some_and(Guards::holds);
        let begun = StepState::new(&mut flow, time, &state.configuration, &state.speeds).and_then(
            |step_state| {
                let mechanism = &flow.mechanism;
                // Rates may be finite where squares of speeds are not.
                mechanism.check_energy(&step_state.configuration, step_state.speeds())?;
                let order = options.method.scheme().order();
                let at = (&mut flow, &step_state, time);
                let outputs = Outputs::new(sampling, events, order, guards, at)?;
                Ok((step_state, outputs))
            },
        );
        let (step_state, outputs) = begun.map_err(|cause| IntegrateError::AtState {
            time,
            cause: Box::new(cause),
            near: watch.nearest_at(&flow.mechanism, (time, &initial.configuration)),
        })?;
        let tolerance = options.method.control().map(|control| control.tolerance);
        let bends = Bends::new(&mut flow, &step_state, time);
        let bends = bends.map_err(|cause| IntegrateError::AtState {
            time,
            cause: Box::new(cause),
            near: watch.nearest_at(&flow.mechanism, (time, &initial.configuration)),
        })?;
        let travel = step_state.passed.clone();
        Ok(Self {
            watch,
            waypoints: Waypoints::new(flow.mechanism.layout()),
            prospect: Prospect::new(time),
            stepper: stepper::new(
                options.method.scheme(),
                (tolerance, outputs.is_none()),
                &flow,
            ),
            scheme: *options.method.scheme(),
            reconsideration: is_open.then(Reconsideration::new),
            flow,
            step_state,
            options,
            hold: period.map(|period| Hold::new(time, period)),
            kinks,
            bends,
            clock: Clock::new(time),
            start: time,
            statistics: Statistics::default(),
            step_errors: StepErrors::default(),
            samples: Vec::with_capacity(options.samples.len()),
            crossings,
            outputs,
            hybrid,
            resolving: resolving(options.t_end - time, holds),
            end: None,
            travel,
            carried: tells_forces.then(Carried::default),
        })
    }

    /// Steps until the end, or until the observer breaks.
    pub(super) fn run(mut self, observer: &mut Observer<'_>) -> Result<Solution, IntegrateError> {
        let mut pacing = self.pacing()?;
        let mut stopped = self.report(observer)?;
        while !stopped && self.clock.time() < self.options.t_end {
            self.advance(&mut pacing, observer)?;
            // What ends on the end of the step is a sample as well, if one falls there.
            let is_past = self.end.as_ref();
            let is_past = is_past.is_some_and(|end| end.time < self.clock.time());
            stopped = is_past || self.report(observer)? || self.end.is_some();
            if !stopped {
                self.look_ahead(&mut pacing)?;
                self.reconsider(&mut pacing)?;
            }
        }
        self.count_solves();
        self.statistics.evaluations = self.flow.evaluations;
        Ok(Solution {
            state: self.end.take().unwrap_or_else(|| self.state()),
            travel: self.travel,
            samples: self.samples,
            waypoints: self.waypoints.finish(),
            scheme: *self.options.method.scheme(),
            method_changes: self
                .reconsideration
                .map_or_else(Vec::new, |own| own.changes),
            events: self.crossings,
            statistics: self.statistics,
            step_errors: self.step_errors,
            approaches: self.watch.finish(),
            rounding: pacing.rounding.limit(&self.flow),
            stopped,
        })
    }

    /// Whether the end is within reach at the present pace. What takes many steps may do so for rounding in Q, which is looked at then.
    fn look_ahead(&mut self, pacing: &mut Pacing) -> Result<(), IntegrateError> {
        let Self {
            prospect,
            flow,
            clock,
            options,
            statistics,
            step_state,
            stepper,
            ..
        } = self;
        let time = clock.time();
        let state = || State {
            time,
            configuration: step_state.configuration.clone(),
            speeds: step_state.speeds().to_vec(),
        };
        if !prospect.check(flow, (options, statistics), (time, &pacing.rounding), state)? {
            return Ok(());
        }
        pacing.rounding.count_configurations();
        stalls::check(
            (step_state, flow),
            (time, pacing.step),
            (&mut pacing.rounding, &mut **stepper),
            statistics,
        )
    }

    /// Adds the work of the stepper, which is not used any more.
    pub(super) fn count_solves(&mut self) {
        let solves = self.stepper.solves();
        self.statistics.iterations += solves.iterations;
        self.statistics.jacobians += solves.jacobians;
        self.statistics.factorizations += solves.factorizations;
    }

    /// The next sample time, or the end, or the next instant for new inputs, or the next kink of what changes with time.
    pub(super) fn target(&self) -> f64 {
        let is_dense = self
            .outputs
            .as_ref()
            .is_some_and(|outputs| outputs.sampling == Sampling::Dense);
        let sample = self.options.samples.get(self.samples.len()).copied();
        let sample = sample.filter(|_| !is_dense);
        let target = sample.unwrap_or(self.options.t_end);
        let target = match &self.hold {
            Some(hold) if !hold.falls_on(target) => target.min(hold.next()),
            _ => target,
        };
        self.kinks.before(target)
    }

    /// One accepted step.
    fn advance(
        &mut self,
        pacing: &mut Pacing,
        observer: &mut Observer<'_>,
    ) -> Result<(), IntegrateError> {
        loop {
            let (step, lands) = self.choose_step(pacing.step);
            let attempt = self.attempt(pacing, step);
            let attempt = attempt.and_then(|()| self.land_on_bend(pacing, step));
            match attempt {
                Ok(taken) => {
                    let lands = lands && taken == step;
                    if self.accept(pacing, (taken, lands), observer)? {
                        self.step_errors.see(pacing.error);
                        let search = pacing.search.as_ref();
                        let next = search.map(|own| own.goes_on(self.clock.time(), taken));
                        pacing.step = next.transpose()?.unwrap_or(pacing.step);
                        return Ok(());
                    }
                    self.statistics.rejected += 1;
                }
                Err(cause) => {
                    self.statistics.rejected += 1;
                    self.refuse(pacing, step, cause)?;
                }
            }
        }
    }

    /// Takes the step just tried, up to the end of the piece if that lies within; whether it is not too long for that.
    fn accept(
        &mut self,
        pacing: &mut Pacing,
        (step, lands): (f64, bool),
        observer: &mut Observer<'_>,
    ) -> Result<bool, IntegrateError> {
        let before = self.before_step();
        let start = self.clock.time();
        if lands {
            self.clock = Clock::new(self.target());
        } else {
            self.clock.advance(step);
        }
        let time = self.clock.time();
        let span = Span { time: start, step };
        self.leave(span);
        let accepted = self
            .stepper
            .accept(&mut self.step_state, &mut self.flow, time, span);
        accepted.map_err(|cause| self.at_state(cause))?;
        self.statistics.steps += 1;
        self.count_unseen(span);
        // Before the inputs change: what lies within the step moved under those that were held.
        let passed = self.pass(step, observer);
        let passed = passed.map_err(|cause| self.at_state(cause))?;
        match (passed, before) {
            (Passed::TooLong(part), Some(before)) => {
                self.go_back(before, (part * step).max(f64::MIN_POSITIVE));
                return Ok(false);
            }
            (Passed::Until(end), Some(before)) => {
                self.end_piece(end, before.clock_after(step))?;
                self.renew_and_go_on()?;
                self.pace_anew(pacing)?;
            }
            _ if self.end.is_some() => {}
            _ => {
                self.widen();
                if self.renew_and_go_on()? {
                    self.pace_anew(pacing)?;
                }
            }
        }
        Ok(true)
    }

    /// Takes new inputs and the next pieces of functions of time where it is time for them; whether that ends a piece of the motion.
    fn renew_and_go_on(&mut self) -> Result<bool, IntegrateError> {
        let renewed = self.renew_inputs(self.clock.time());
        let renewed = renewed.map_err(|cause| self.at_state(cause))?;
        Ok(renewed && self.end_piece_at_jump()?)
    }

    /// Takes new inputs and the next pieces of functions of time where it is time for them, and the rates that they make; whether it is.
    fn renew_inputs(&mut self, time: f64) -> Result<bool, StepFailure> {
        let is_bent = self.kinks.pass(&mut self.flow, time)?;
        let hold = self.hold.as_mut().filter(|hold| hold.falls_on(time));
        let is_due = hold.map(Hold::pass).is_some();
        if is_due {
            let (q, speeds) = (&self.step_state.configuration, self.step_state.speeds());
            self.flow.hold(time, q, speeds);
        }
        if is_bent || is_due {
            self.step_state.evaluate(&mut self.flow, time)?;
        }
        Ok(is_bent || is_due)
    }

    pub(super) fn at_state(&self, cause: StepFailure) -> IntegrateError {
        IntegrateError::AtState {
            time: self.clock.time(),
            cause: Box::new(cause.of_relations(&self.flow.mechanism)),
            near: self.near(),
        }
    }

    /// The joint that is nearest to a singular set of its own.
    pub(super) fn near(&self) -> Near {
        self.watch.nearest_at(&self.flow.mechanism, self.at())
    }

    /// The time and Q of the state.
    pub(super) fn at(&self) -> (f64, &[f64]) {
        (self.clock.time(), &self.step_state.configuration)
    }

    /// Records the samples that fall on this time and shows the state; whether to stop.
    fn report(&mut self, observer: &mut Observer<'_>) -> Result<bool, IntegrateError> {
        let time = self.clock.time();
        let q = &self.step_state.configuration;
        if let Some(end) = self.watch.see(&self.flow.mechanism, time, q) {
            return Err(IntegrateError::Excluded(end));
        }
        let at = (&*self.step_state.configuration, self.step_state.speeds());
        self.waypoints.see(self.statistics.steps, time, at);
        let mut sample = None;
        while self.options.samples.get(self.samples.len()) == Some(&self.clock.time()) {
            sample = Some(self.samples.len());
            self.samples.push(self.state());
        }
        let carried = self.carried.as_mut().filter(|_| sample.is_some());
        let hybrid = self.hybrid.as_ref();
        let carried = carried.map(|carried| carried.at((&mut self.flow, hybrid), time, at));
        let carried = carried.transpose();
        let carried = carried.map_err(|cause| IntegrateError::AtState {
            time,
            cause: Box::new(cause),
            near: (self.watch).nearest_at(&self.flow.mechanism, (time, at.0)),
        })?;
        self.step_state.instant(time).travel(&mut self.travel);
        let step = Step {
            time: self.clock.time(),
            number: self.statistics.steps,
            configuration: &self.step_state.configuration,
            speeds: self.step_state.speeds(),
            travel: &self.travel,
            momenta: (self.flow.form == Form::Hamiltonian).then_some(&*self.step_state.y),
            sample,
            is_within: false,
            carried,
        };
        Ok(observer(&step).is_break())
    }

    pub(super) fn state(&self) -> State {
        State {
            time: self.clock.time(),
            configuration: self.step_state.configuration.clone(),
            speeds: self.step_state.speeds().to_vec(),
        }
    }
}
