//! A motion of a model, asked for step by step.

use crate::error::Error;
use hamel_control::Feedback;
use hamel_integrate::{
    Event, Form, GlobalError, Integration, Method, Observer, Options, Solution, State, Step, Tuned,
};
use hamel_runtime::dynamics::Dynamics;
use hamel_scene::{Arithmetic, Company, Scene, Settings};
use std::cell::RefCell;
use std::ops::ControlFlow;

/// Efforts τ, one per entry of v, from time (s), Q and v̄; they are zero when it is called.
type Inputs<'a> = Box<dyn FnMut(f64, &[f64], &[f64], &mut [f64]) + 'a>;

/// Makes the equations of motion of one motion.
type Equations<'a> = Box<dyn Fn() -> Box<dyn Dynamics> + 'a>;

/// Sees the steps of a motion.
type Sight<'a> = Box<dyn FnMut(&Step<'_>) + 'a>;

/// A motion that is being put together; [`Simulation::run`] moves the model.
#[must_use = "nothing moves before `run`"]
pub struct Simulation<'a> {
    scene: &'a Scene,
    settings: Settings,
    start: State,
    times: Option<Vec<f64>>,
    inputs: Option<Inputs<'a>>,
    equations: Option<Equations<'a>>,
    events: Vec<Event<'a>>,
    stop: Option<Box<dyn Fn() -> bool + 'a>>,
    sight: Option<Sight<'a>>,
}

impl<'a> Simulation<'a> {
    pub(crate) fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            settings: scene.settings,
            start: scene.start(),
            times: None,
            inputs: None,
            equations: None,
            events: Vec::new(),
            stop: None,
            sight: None,
        }
    }

    /// From this state, instead of the initial one of the file. A controller of the scene still counts its time from 0.
    pub fn starting_at(mut self, state: State) -> Self {
        self.start = state;
        self
    }

    /// Until this time, s; it is a time, not a duration.
    pub const fn until(mut self, time: f64) -> Self {
        self.settings.t_end = time;
        self
    }

    /// With a sample at the start, one each `step` seconds after it, and one at the end.
    pub fn sample_every(mut self, step: f64) -> Self {
        self.settings.sample_step = step;
        self.times = None;
        self
    }

    /// With samples at these times alone, s, ascending.
    pub fn sample_at(mut self, times: impl Into<Vec<f64>>) -> Self {
        self.times = Some(times.into());
        self
    }

    /// By this method; with this tolerance or step too, unless [`Simulation::accuracy`] comes after it.
    pub const fn method(mut self, method: Method) -> Self {
        self.settings.method = method;
        self.settings.chooses = false;
        self.settings.accuracy = None;
        self
    }

    /// Chooses the method automatically from the initial state, with this tolerance per step; [`Simulation::chosen_method`] tells which, and why.
    pub const fn tolerance(mut self, tolerance: f64) -> Self {
        self.settings.method = Method::dormand_prince(tolerance);
        self.settings.chooses = true;
        self.settings.accuracy = None;
        self
    }

    /// With an error of the last state of at most `error`, as [`hamel_integrate::ErrorParts`] measures it: attitudes in rad, positions and velocities as parts
    /// of max(1 SI unit, size). The tolerance is searched for by motions that are integrated and estimated for this alone, two as a rule; inputs are asked for
    /// their efforts too. [`Simulation::run`] refuses an accuracy that is not reached, or that no reliable
    /// estimate confirms; [`Simulation::run_estimated`] tells the error, and whether its estimate is reliable.
    pub const fn accuracy(mut self, error: f64) -> Self {
        self.settings.accuracy = Some(error);
        if let Method::Fixed { .. } = self.settings.method {
            self = self.tolerance(Settings::DEFAULT_TOL);
        }
        self
    }

    /// With equations of motion in this arithmetic. Where it is [`Arithmetic::Auto`], a motion in doubles comes first, and inputs are asked for its efforts too.
    pub const fn arithmetic(mut self, arithmetic: Arithmetic) -> Self {
        self.settings.arithmetic = arithmetic;
        self
    }

    /// With equations of motion that `make` gives to each motion, such as compiled ones, in place of the tree in doubles. Refined arithmetic is the tree's all the same.
    pub fn equations(mut self, make: impl Fn() -> Box<dyn Dynamics> + 'a) -> Self {
        self.equations = Some(Box::new(make));
        self
    }

    /// In this form of the equations of motion.
    pub const fn form(mut self, form: Form) -> Self {
        self.settings.form = form;
        self
    }

    /// With one event more than the scene has. [`Crossing::event`](hamel_integrate::Crossing::event) counts those of the scene first.
    pub fn event(mut self, event: Event<'a>) -> Self {
        self.events.push(event);
        self
    }

    /// Under efforts τ (one per entry of v, N m or N) from time, Q and v̄, instead of the scene's controller; they are zero when it is called.
    pub fn inputs(mut self, inputs: impl FnMut(f64, &[f64], &[f64], &mut [f64]) + 'a) -> Self {
        self.inputs = Some(Box::new(inputs));
        self
    }

    /// With a question after each step, whether it is to end there, such as when the user interrupts it; [`Solution::stopped`] tells. The motions that are made for
    /// an estimate, or in the search for an accuracy, ask too.
    pub fn stopping(mut self, stop: impl Fn() -> bool + 'a) -> Self {
        self.stop = Some(Box::new(stop));
        self
    }

    /// With a look at the initial state ([`Step::number`] 0), each step, and each sample within one. Where a tolerance is searched for, or arithmetic is left open,
    /// the motions before the last are seen too, each from its initial state; companions of an estimate are not.
    pub fn observing(mut self, observer: impl FnMut(&Step<'_>) + 'a) -> Self {
        self.sight = Some(Box::new(observer));
        self
    }

    /// Moves the model: its last state, its samples and its events.
    ///
    /// # Errors
    /// A state, settings or events that are refused; a controller or equations that fail on the way; an accuracy that is not reached.
    pub fn run(mut self) -> Result<Solution, Error> {
        if let Some(wanted) = self.settings.accuracy {
            let found = self.search(wanted)?;
            if !found.is_reached {
                let (error, rounding) = (found.error.total(), found.error.rounding);
                return Err(Error::Accuracy {
                    wanted,
                    error,
                    rounding,
                    doubt: found.doubt,
                });
            }
        }
        let moved = self.moved();
        match self.refines(&moved) {
            true => self.moved(),
            false => moved,
        }
    }

    /// As [`Simulation::run`], with an estimate of the error of its states. It takes about as many evaluations of the equations again; inputs are asked for
    /// the efforts of companion motions too. An accuracy that is not reached is no error here: the estimate says so.
    ///
    /// # Errors
    /// Those of [`Simulation::run`].
    pub fn run_estimated(mut self) -> Result<(Solution, GlobalError), Error> {
        if let Some(wanted) = self.settings.accuracy {
            self.search(wanted)?;
        }
        let moved = self.moved();
        let solution = match self.refines(&moved) {
            true => self.moved(),
            false => moved,
        }?;
        let error = self.estimate(&solution)?;
        Ok((solution, error))
    }

    /// Settles the tolerance at which the last state has the accuracy that is wanted, and the arithmetic where that is left open.
    fn search(&mut self, wanted: f64) -> Result<Tuned, Error> {
        let is_open = self.settings.arithmetic == Arithmetic::Auto;
        let mut is_limited = false;
        let found = Tuned::search(wanted, |tolerance| {
            self.settings = self.settings.with_tolerance(tolerance);
            let moved = self.moved();
            is_limited |= self.reason_to_refine(&moved).is_some();
            let solution = moved?;
            self.estimate(&solution)
        });
        let is_short = match &found {
            Ok(found) => !found.is_reached && (is_limited || found.error.rounding > wanted),
            Err(_) => is_limited,
        };
        if is_open && is_short {
            self.settings.arithmetic = Arithmetic::Refined;
            return self.search(wanted);
        }
        let found = found?;
        if is_open {
            self.settings.arithmetic = Arithmetic::Doubles;
        }
        self.settings = self.settings.with_tolerance(found.tolerance);
        Ok(found)
    }

    /// Whether a motion that ended like this is to be made again in refined arithmetic, which is settled then.
    fn refines(&mut self, moved: &Result<Solution, Error>) -> bool {
        let refines = self.reason_to_refine(moved).is_some();
        if refines {
            self.settings.arithmetic = Arithmetic::Refined;
        }
        refines
    }

    fn reason_to_refine(&self, moved: &Result<Solution, Error>) -> Option<String> {
        let ended = match moved {
            Ok(solution) => Ok(solution),
            Err(Error::Integrate(error)) => Err(error),
            Err(_) => return None,
        };
        self.settings.arithmetic.reason_to_refine(ended)
    }

    fn moved(&mut self) -> Result<Solution, Error> {
        let options = self.options()?;
        self.motion(&mut *self.dynamics(), &options)
    }

    fn estimate(&mut self, solution: &Solution) -> Result<GlobalError, Error> {
        let (start, options) = (self.start.clone(), self.options()?);
        let (mut own, mut others) = (self.dynamics(), self.dynamics());
        let mut companion = |start: &State, options: &Options, observer: &mut Observer<'_>| {
            // A companion changes its method where the motion did.
            let chooses = self.settings.chooses && !solution.method_changes.is_empty();
            let of = (start, options, chooses);
            let motion = self.integrate(&mut *others, of, vec![], observer);
            motion.map_err(|error| error.to_string())
        };
        Ok(GlobalError::estimate(
            &mut *own,
            &start,
            &options,
            solution,
            &mut companion,
        ))
    }

    fn dynamics(&self) -> Box<dyn Dynamics> {
        match (&self.equations, self.settings.arithmetic) {
            (Some(make), Arithmetic::Doubles | Arithmetic::Auto) => make(),
            (_, arithmetic) => arithmetic.dynamics(&self.scene.mechanism),
        }
    }

    /// The motion itself, with its events.
    fn motion(
        &mut self,
        dynamics: &mut dyn Dynamics,
        options: &Options,
    ) -> Result<Solution, Error> {
        let mechanism = &self.scene.mechanism;
        let own = self.scene.events.iter().map(|event| event.event(mechanism));
        // The caller's own are wanted again where a tolerance is searched for.
        let mut others = std::mem::take(&mut self.events);
        let others_again = others.iter_mut().map(Event::by_ref);
        let events = own.chain(others_again).collect();
        let start = self.start.clone();
        let mut sight = self.sight.take();
        let of = (&start, options, self.settings.chooses);
        let moved = self.integrate(dynamics, of, events, &mut |step| {
            if let Some(sight) = &mut sight {
                sight(step);
            }
            ControlFlow::Continue(())
        });
        self.events = others;
        self.sight = sight;
        moved
    }

    /// One motion under the inputs, or a controller that begins with it; whether its method may change on the way.
    fn integrate(
        &mut self,
        dynamics: &mut dyn Dynamics,
        (start, options, chooses): (&State, &Options, bool),
        events: Vec<Event<'_>>,
        observer: &mut Observer<'_>,
    ) -> Result<Solution, Error> {
        let mechanism = &self.scene.mechanism;
        let control = self.scene.control.as_ref();
        let control = control.filter(|_| self.inputs.is_none());
        let mut controller = control
            .map(|control| control.controller(mechanism, options.t_end))
            .transpose()
            .map_err(Error::Controller)?;
        let feedback = controller
            .as_mut()
            .map(|law| RefCell::new(Feedback::new(&mut **law)));
        let stop = self.stop.as_deref();
        let mut motion = Integration::new(dynamics, start, options)
            .sampling(self.settings.sampling)
            .observer(|step| {
                if let Some(feedback) = &feedback {
                    feedback.borrow_mut().accepted();
                }
                match stop.is_some_and(|stop| stop()) {
                    true => ControlFlow::Break(()),
                    false => observer(step),
                }
            });
        if chooses {
            motion = motion.choosing();
        }
        for event in events {
            motion = motion.event(event);
        }
        if let Some(inputs) = &mut self.inputs {
            motion = motion.inputs(inputs);
        } else if let Some(feedback) = &feedback {
            motion = motion.inputs(|time, q, speeds, efforts| {
                feedback.borrow_mut().fill(time, q, speeds, efforts);
            });
            motion = motion.bending(|time, q, speeds, bends| {
                feedback.borrow_mut().bends(time, q, speeds, bends);
            });
            motion = motion.inputs_at_ports(|time, q, speeds, efforts| {
                let feedback = &mut *feedback.borrow_mut();
                feedback.efforts_at_ports(time, q, speeds, efforts);
            });
        }
        if let Some(period) = control.and_then(|control| control.period) {
            motion = motion.held(period);
        }
        let ended = motion.run();
        let failure = feedback.and_then(|feedback| feedback.borrow().failure().cloned());
        match (ended, failure) {
            (Ok(solution), _) => Ok(solution),
            (Err(_), Some((time, cause))) => Err(Error::Control { time, cause }),
            (Err(error), None) => Err(error.into()),
        }
    }

    fn options(&self) -> Result<Options, Error> {
        let samples = match &self.times {
            Some(times) => times.clone(),
            None => self.settings.sample_times(self.start.time)?,
        };
        Ok(Options {
            form: self.settings.form,
            method: self.chosen_method()?.0,
            t_end: self.settings.t_end,
            samples,
        })
    }

    /// The method that [`Simulation::run`] will take, and why, where the choice is left open.
    ///
    /// # Errors
    /// A first state that the equations of motion cannot be evaluated at.
    pub fn chosen_method(&self) -> Result<(Method, Option<String>), Error> {
        let company = Company {
            has_inputs: self.inputs.is_some() || self.scene.control.is_some(),
            has_events: !self.events.is_empty(),
        };
        Ok(self
            .scene
            .choose_method(&self.settings, &self.start, company)?)
    }
}

impl std::fmt::Debug for Simulation<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Simulation")
            .field("scene", &self.scene.name)
            .field("settings", &self.settings)
            .field("start", &self.start)
            .field("events", &self.events)
            .finish_non_exhaustive()
    }
}
