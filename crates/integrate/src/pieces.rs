//! The pieces of a motion with friction and limits of joints, from the side of the driver: how each begins and ends.

use super::bends::Bends;
use super::clock::Clock;
use super::driver::Driver;
use super::flow::Flow;
use super::hybrid::{Guard, Guards, Hybrid, Note};
use super::outputs::PieceEnd;
use super::step_state::StepState;
use super::{Crossing, IntegrateError, State, stepper};
use alloc::vec::Vec;

/// The first step of a piece in which joints are held is no longer than this part of the motion: nothing but the efforts that hold them may change in it,
/// which no control of steps sees. No round number, so that steps are not in time with what drives them.
const FIRST: f64 = 6.18e-4;

/// The longest step at the beginning of a piece, over a motion of `span` (s), where it `holds` joints.
pub(super) const fn resolving(span: f64, holds: bool) -> f64 {
    match holds {
        true => FIRST * span,
        false => f64::INFINITY,
    }
}

/// What a motion begins with.
pub(super) struct FirstPiece<'a> {
    pub(super) hybrid: Option<Hybrid<'a>>,
    pub(super) guards: Option<Guards>,
    pub(super) state: State,
    pub(super) crossings: Vec<Crossing>,
}

impl<'a> FirstPiece<'a> {
    /// From `initial`, over a time of `span` (s), with so many events.
    pub(super) fn new(
        flow: &mut Flow<'a>,
        initial: &State,
        (span, events): (f64, usize),
    ) -> Result<Self, IntegrateError> {
        let mut first = Self {
            hybrid: Hybrid::new(&flow.mechanism, span),
            guards: None,
            state: initial.clone(),
            crossings: Vec::new(),
        };
        if let Some(hybrid) = &mut first.hybrid {
            let speeds = &mut first.state.speeds;
            let moment = flow.moment(initial.time);
            flow.mechanism.prescribe_speeds(moment, speeds);
            let (notes, guards) = hybrid.turn(flow, &mut first.state, &[], true)?;
            first.guards = Some(guards);
            first.crossings = crossings(notes, events, &first.state);
        }
        Ok(first)
    }
}

/// What is reported of the end of a piece, after `events` that were asked for.
fn crossings(notes: Vec<Note>, events: usize, state: &State) -> Vec<Crossing> {
    let notes = notes.into_iter();
    let crossings = notes.map(|note| Crossing {
        event: events,
        joint: Some(note.body),
        name: note.name,
        rising: note.rising,
        state: state.clone(),
    });
    crossings.collect()
}

/// What a step began with.
pub(super) struct BeforeStep {
    step_state: StepState,
    clock: Clock,
}

impl BeforeStep {
    /// The clock, `step` later.
    pub(super) fn clock_after(self, step: f64) -> impl FnOnce(f64) -> Clock {
        move |part| {
            let mut clock = self.clock;
            clock.advance(part * step);
            clock
        }
    }
}

impl Driver<'_> {
    /// What to go back to, where the motion has pieces.
    pub(super) fn before_step(&self) -> Option<BeforeStep> {
        self.hybrid.as_ref().map(|_| BeforeStep {
            step_state: self.step_state.clone(),
            clock: self.clock,
        })
    }

    /// Goes back to before a step, and takes one that is no longer than this next.
    pub(super) fn go_back(&mut self, before: BeforeStep, longest: f64) {
        self.statistics.steps -= 1;
        self.resolving = longest;
        self.step_state = before.step_state;
        self.clock = before.clock;
        self.renew_stepper();
    }

    /// Lets steps grow that have told of all ends of pieces. Where joints are held and what acts changes with time by itself, they stay short: it may come and go
    /// within a longer one.
    pub(super) fn widen(&mut self) {
        let longest = match self.flow.is_autonomous() || !self.resolving.is_finite() {
            true => f64::INFINITY,
            false => FIRST * (self.options.t_end - self.start),
        };
        self.resolving = (2.0 * self.resolving).min(longest);
    }

    pub(super) fn renew_stepper(&mut self) {
        self.count_solves();
        let method = &self.options.method;
        let tolerance = method.control().map(|control| control.tolerance);
        self.stepper = stepper::new(
            &self.scheme,
            (tolerance, self.outputs.is_none()),
            &self.flow,
        );
    }

    /// Ends the piece within the step just made, and begins the next; `clock` at that part of the step.
    pub(super) fn end_piece(
        &mut self,
        end: PieceEnd,
        clock: impl FnOnce(f64) -> Clock,
    ) -> Result<(), IntegrateError> {
        // The end of the step is a sample, perhaps, beyond which no rounding may lead.
        let clock = clock(end.part);
        if clock.time() < self.clock.time() {
            self.clock = clock;
        }
        let state = State {
            time: self.clock.time(),
            ..end.state
        };
        self.begin_piece((state, end.travel), &end.guards)
    }

    /// Ends the piece where new inputs are more than what holds a joint; whether they are.
    pub(super) fn end_piece_at_jump(&mut self) -> Result<bool, IntegrateError> {
        let Some(outputs) = self.outputs.as_mut().filter(|_| self.hybrid.is_some()) else {
            return Ok(false);
        };
        let time = self.clock.time();
        let instant = self.step_state.instant(time);
        let broken = outputs.location.broken(&mut self.flow, &instant);
        let broken = broken.map_err(|cause| self.at_state(cause))?;
        if broken.is_empty() {
            return Ok(false);
        }
        instant.travel(&mut self.travel);
        self.begin_piece((self.state(), self.travel.clone()), &broken)?;
        Ok(true)
    }

    /// Takes the next step no longer than the shortest bounce, and some.
    fn reach_over_bounces(&mut self) -> Result<(), IntegrateError> {
        let accelerations = self.step_state.accelerations(&mut self.flow);
        let accelerations = accelerations.map(<[f64]>::to_vec);
        let accelerations = accelerations.map_err(|cause| self.at_state(cause))?;
        let (q, speeds) = (&self.step_state.configuration, self.step_state.speeds());
        let longest = match &self.hybrid {
            Some(hybrid) => hybrid.flight(q, speeds, &accelerations),
            None => f64::INFINITY,
        };
        self.resolving = self.resolving.min(longest);
        Ok(())
    }

    /// From a state and the travel up to it.
    fn begin_piece(
        &mut self,
        (mut state, travel): (State, Vec<f64>),
        ended: &[Guard],
    ) -> Result<(), IntegrateError> {
        let Some(hybrid) = &mut self.hybrid else {
            return Ok(());
        };
        let (notes, guards) = hybrid.turn(&mut self.flow, &mut state, ended, false)?;
        self.resolving = resolving(self.options.t_end - self.start, guards.holds());
        let (q, speeds) = (&state.configuration, &state.speeds);
        let begun = StepState::new(&mut self.flow, state.time, q, speeds);
        self.step_state = begun.map_err(|cause| self.at_state(cause))?;
        self.step_state.passed = travel;
        self.renew_stepper();
        // Speeds that have jumped may have taken inputs to the other side of a bend.
        let bends = Bends::new(&mut self.flow, &self.step_state, state.time);
        self.bends = bends.map_err(|cause| self.at_state(cause))?;
        self.reach_over_bounces()?;
        let order = self.options.method.scheme().order();
        let mut events: usize = 0;
        if let Some(outputs) = &mut self.outputs {
            events = outputs.location.events.len();
            let at = (&mut self.flow, &self.step_state, state.time);
            let begun = outputs.restart(guards, order, at);
            begun.map_err(|cause| self.at_state(cause))?;
        }
        let speeds = self.step_state.speeds().to_vec();
        let state = State { speeds, ..state };
        self.crossings.extend(crossings(notes, events, &state));
        Ok(())
    }
}
