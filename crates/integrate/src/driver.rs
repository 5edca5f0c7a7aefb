//! From the initial time to the last, by accepted steps, over the sample times.

use super::approach::Watch;
use super::bends::Bends;
use super::carried::Carried;
use super::clock::Clock;
use super::fixed_steps::is_last;
use super::flow::{Flow, Given};
use super::hybrid::{Guards, Hybrid};
use super::kinks::Kinks;
use super::options::{StepControl, least_step};
use super::outputs::{Outputs, Passed};
use super::pieces::{FirstPiece, resolving};
use super::prospect::{Prospect, chosen_method, other_method};
use super::rates_of_loops::has_ends;
use super::reconsider::Reconsideration;
use super::rounding::Rounding;
use super::search::Search;
use super::stalls;
use super::step_control::StepController;
use super::step_state::StepState;
use super::stepper::{self, Span, Stepper};
use super::waypoints::Waypoints;
use super::{
    Crossing, Event, Form, IntegrateError, Method, Near, Observer, Options, Sampling, Scheme,
    Solution, State, Statistics, Step, StepFailure,
};
use alloc::boxed::Box;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use hamel_runtime::dynamics::Dynamics;
use num_traits::Float;

/// A remainder that exceeds a controlled step by less than this is taken at once: it saves a sliver of a step.
const CONTROLLED_STRETCH: f64 = 1.01;

/// An instant for new inputs that is nearer to a sample than this part of the period falls on it: the rest is rounding.
const SAME_INSTANT: f64 = 1e-9;

/// When inputs that are held are taken anew.
struct Hold {
    start: f64,
    period: f64,
    /// How many times they have been.
    count: u64,
}

impl Hold {
    /// The next instant.
    fn next(&self) -> f64 {
        self.start + self.period * self.count as f64
    }

    /// Whether the next instant is `time`, but for rounding.
    fn falls_on(&self, time: f64) -> bool {
        (self.next() - time).abs() <= SAME_INSTANT * self.period
    }
}

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
    hold: Option<Hold>,
    kinks: Kinks,
    pub(super) bends: Bends,
    pub(super) clock: Clock,
    pub(super) start: f64,
    pub(super) statistics: Statistics,
    pub(super) samples: Vec<State>,
    pub(super) crossings: Vec<Crossing>,
    watch: Watch,
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

/// How the next step is chosen.
pub(super) struct Pacing {
    /// The step to try where no sample time is in the way.
    step: f64,
    pub(super) controller: StepController,
    rounding: Rounding,
    /// Where a step of fixed size has failed: shorter ones, up to its end.
    search: Option<Search>,
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
            hold: period.map(|period| Hold {
                start: time,
                period,
                count: 1,
            }),
            kinks,
            bends,
            clock: Clock::new(time),
            start: time,
            statistics: Statistics::default(),
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

    fn pacing(&mut self) -> Result<Pacing, IntegrateError> {
        let order = self.stepper.order();
        let step = match self.options.method {
            Method::Fixed { dt, .. } => dt,
            Method::Controlled { control, .. } => {
                let first = control
                    .first_step
                    .map_or_else(|| self.first_step(control.tolerance, order), Ok);
                first?.min(control.max_step)
            }
        };
        Ok(Pacing {
            step,
            controller: StepController::new(order),
            rounding: Rounding::new(&self.flow),
            search: None,
        })
    }

    /// A step over which the state changes by about `tolerance^(1/order)`.
    fn first_step(&mut self, tolerance: f64, order: u32) -> Result<f64, IntegrateError> {
        let span = self.options.t_end - self.start;
        let change = 0.3 * Float::powf(tolerance, 1.0 / f64::from(order));
        let pace = self.step_state.pace(&mut self.flow);
        let pace = pace.map_err(|cause| self.at_state(cause))?;
        // A hundredth of the shortest spans is nothing: these are one step.
        Ok((change / pace).min(0.01 * span).max(f64::MIN_POSITIVE))
    }

    /// The next sample time, or the end, or the next instant for new inputs, or the next kink of what changes with time.
    fn target(&self) -> f64 {
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

    /// The step to try, and whether it ends on the target.
    fn choose_step(&self, step: f64) -> (f64, bool) {
        let (step, lands) = self.step_to_target(step);
        if let Method::Fixed { .. } = self.options.method {
            return (step, lands);
        }
        let time = self.clock.time();
        let end = time + step;
        let motion = [self.start, self.options.t_end];
        let seen = self.flow.mechanism.end_before_pulse([time, end], motion);
        match seen < end && seen - time > least_step(time, end) {
            true => (seen - time, false),
            false => (step, lands),
        }
    }

    /// The same, however what acts changes with time.
    fn step_to_target(&self, step: f64) -> (f64, bool) {
        let (remaining, step) = (self.clock.until(self.target()), step.min(self.resolving));
        match self.options.method {
            Method::Fixed { .. } if is_last(remaining, step) => (remaining, true),
            Method::Fixed { .. } => (step, false),
            _ if remaining <= step * CONTROLLED_STRETCH => (remaining, true),
            // Two equal steps rather than a full one and a sliver.
            _ if remaining < 2.0 * step => (0.5 * remaining, false),
            _ => (step, false),
        }
    }

    pub(super) fn attempt(&mut self, pacing: &mut Pacing, step: f64) -> Result<(), StepFailure> {
        let span = Span {
            time: self.clock.time(),
            step,
        };
        let Self {
            stepper,
            step_state,
            flow,
            watch,
            ..
        } = self;
        let outcome = stepper
            .attempt(step_state, flow, span)
            .and_then(|()| watch.check(flow, step_state, span));
        let Some(StepControl {
            tolerance,
            max_step,
            ..
        }) = self.options.method.control()
        else {
            return outcome;
        };
        if let Err(cause) = outcome {
            if let StepFailure::NoConvergence { .. } = cause {
                self.statistics.unconverged += 1;
            }
            pacing.step = step * pacing.controller.reject(None);
            return Err(cause);
        }
        let least = stepper.allowed(tolerance);
        if let Some(weight) = stepper.estimate_weight()
            && pacing.rounding.is_due()
        {
            pacing.rounding.look(step_state, flow, span.time, weight);
        }
        let (error, joint) = match stepper.error(step_state, flow, span, least) {
            Ok(found) => found,
            Err(cause) => {
                pacing.step = step * pacing.controller.reject(None);
                return Err(cause);
            }
        };
        let allowed = pacing.rounding.allowed(step, least);
        let part = error / allowed;
        if part.is_nan() || part > 1.0 {
            pacing.rounding.refuse();
            pacing.step = step * pacing.controller.reject(Some(part));
            return Err(self.inaccurate(joint, error));
        }
        pacing.rounding.accept(error, joint, least);
        let factor = pacing.controller.accept(part);
        // Rounding takes the same share of the tolerance at any length of step. Near the end of a joint, relations amplify it beyond what was measured; steps would shrink without end.
        let is_of_relations = has_ends(self.flow.mechanism.bodies()[joint].joint());
        let factor = match allowed > 1.0 && is_of_relations {
            true => factor.max(1.0),
            false => factor,
        };
        let next = step * factor;
        // A step that was cut short to land says nothing against the step that was meant.
        let cut = step < pacing.step;
        pacing.step = if cut { next.max(pacing.step) } else { next }.min(max_step);
        Ok(())
    }

    fn inaccurate(&self, joint: usize, ratio: f64) -> StepFailure {
        StepFailure::Inaccurate {
            joint: self.flow.joint_name(joint),
            ratio,
        }
    }

    /// Ends the integration where no smaller step can help.
    fn refuse(
        &self,
        pacing: &mut Pacing,
        step: f64,
        cause: StepFailure,
    ) -> Result<(), IntegrateError> {
        let cause = cause.of_relations(&self.flow.mechanism);
        let time = self.clock.time();
        if let Method::Fixed { dt, .. } = self.options.method {
            let failure = IntegrateError::Step {
                time,
                step,
                cause: Box::new(cause.clone()),
                near: self.near(),
            };
            if !cause.is_of_length() || !self.watch.knows_ends(&self.flow.mechanism) {
                return Err(failure);
            }
            pacing.step = 0.5 * step;
            (pacing.search).get_or_insert_with(|| Search::new(time + step, dt, failure));
        }
        // From where time does not move on; at time 0, where it always does, by what is nothing of the span.
        let span = self.options.t_end - self.start;
        let limit = least_step(time, f64::EPSILON * span);
        match pacing.step > limit {
            true => Ok(()),
            false => Err(self.underflow(pacing, limit, cause)),
        }
    }

    /// Why steps have become as short as they can be.
    fn underflow(&self, pacing: &Pacing, limit: f64, cause: StepFailure) -> IntegrateError {
        if let StepFailure::NotClosed { joint } | StepFailure::Excluded { joint, .. } = &cause
            && let Some(end) = self.watch.end_of(&self.flow.mechanism, joint, self.at())
        {
            return IntegrateError::Excluded(end);
        }
        if let Some(search) = &pacing.search {
            return search.failure();
        }
        let find = match cause {
            // Of a step that has no solution, the length is not to blame alone.
            StepFailure::NoConvergence { .. } => chosen_method,
            _ => other_method,
        };
        let advice = find(&self.flow, self.options, &self.state());
        IntegrateError::StepUnderflow {
            time: self.clock.time(),
            step: pacing.step,
            limit,
            cause: Box::new(cause),
            near: self.near(),
            advice: advice.map_or_else(String::new, |advice| format!("; {advice}")),
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

    /// The first step of a piece of the motion.
    pub(super) fn pace_anew(&mut self, pacing: &mut Pacing) -> Result<(), IntegrateError> {
        if let Some(control) = self.options.method.control() {
            let first = self.first_step(control.tolerance, self.stepper.order())?;
            pacing.step = first.min(control.max_step);
        }
        Ok(())
    }

    /// Takes new inputs and the next pieces of functions of time where it is time for them, and the rates that they make; whether it is.
    fn renew_inputs(&mut self, time: f64) -> Result<bool, StepFailure> {
        let is_bent = self.kinks.pass(&mut self.flow, time)?;
        let hold = self.hold.as_mut().filter(|hold| hold.falls_on(time));
        let is_due = hold.map(|hold| hold.count += 1).is_some();
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
    fn near(&self) -> Near {
        self.watch.nearest_at(&self.flow.mechanism, self.at())
    }

    /// The time and Q of the state.
    fn at(&self) -> (f64, &[f64]) {
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
