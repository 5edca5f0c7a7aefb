//! An integration with all that may be asked of it.

use super::driver::{Driver, Wanted};
use super::inputs::Given;
use super::options::check_length;
use super::{
    Event, InputBends, Inputs, IntegrateError, Observer, Options, PortInputs, Solution, State,
    Step, no_observer,
};
use alloc::boxed::Box;
use alloc::vec::Vec;
use core::fmt::{Debug, Formatter};
use core::ops::ControlFlow;
use hamel_runtime::dynamics::{Dynamics, EffortAtPort};
#[cfg(doc)]
use hamel_runtime::mechanism::Mechanism;

/// Where the states at sample times come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sampling {
    /// From steps that are shortened to land on them.
    #[default]
    Landing,
    /// From dense output, so that samples have no influence on the steps. It has the order of the scheme, and costs (p − 3)(p − 2)/2 evaluations of the
    /// equations in a step with samples, p the order; of stiff implicit steps it is the polynomial of the stages. Of [`Scheme::Exponential`](super::Scheme::Exponential) it
    /// tells no more than polynomials can: take [`Sampling::Landing`] where steps span periods of a stiff spring.
    Dense,
}

/// An integration that is being put together; [`Integration::run`] does it.
///
/// ```
/// # use hamel_runtime::dynamics::Dynamics;
/// # use hamel_integrate::{Event, IntegrateError, Integration, Options, Sampling, Solution, State};
/// # fn throw(dynamics: &mut dyn Dynamics, initial: &State, options: &Options) -> Result<Solution, IntegrateError> {
/// Integration::new(dynamics, initial, options)
///     .sampling(Sampling::Dense)
///     .event(Event::new("apex", |_, _, speeds| speeds[2]).falling())
///     .event(Event::new("landing", |_, q, _| q[2]).falling().stopping())
///     .run()
/// # }
/// ```
#[must_use = "nothing moves before `run`"]
pub struct Integration<'a> {
    dynamics: &'a mut dyn Dynamics,
    initial: &'a State,
    options: &'a Options,
    inputs: Option<Box<Inputs<'a>>>,
    input_bends: Option<Box<InputBends<'a>>>,
    port_inputs: Option<Box<PortInputs<'a>>>,
    period: Option<f64>,
    observer: Box<Observer<'a>>,
    sampling: Sampling,
    events: Vec<Event<'a>>,
    is_open: bool,
    tells_forces: bool,
}

impl<'a> Integration<'a> {
    /// From `initial` to [`Options::t_end`], without inputs, observer or events.
    pub fn new(dynamics: &'a mut dyn Dynamics, initial: &'a State, options: &'a Options) -> Self {
        Self {
            dynamics,
            initial,
            options,
            inputs: None,
            input_bends: None,
            port_inputs: None,
            period: None,
            observer: Box::new(no_observer),
            sampling: Sampling::Landing,
            events: Vec::new(),
            is_open: false,
            tells_forces: false,
        }
    }

    /// With efforts τ (one entry per degree of freedom) from time, q and v̄; entries are zero when it is called.
    pub fn inputs(mut self, inputs: impl FnMut(f64, &[f64], &[f64], &mut [f64]) + 'a) -> Self {
        self.inputs = Some(Box::new(inputs));
        self
    }

    /// With functions of time, q and v̄ at whose zeros the inputs bend, as where an effort reaches its limit: steps end there, so that every method keeps its order and
    /// estimates of errors hold. They are pushed onto a list, as many at all times, each continuous and of the order of 1 away from its zero. Inputs that are held do not need them.
    pub fn bending(mut self, bends: impl FnMut(f64, &[f64], &[f64], &mut Vec<f64>) + 'a) -> Self {
        self.input_bends = Some(Box::new(bends));
        self
    }

    /// With what of the inputs acts at ports of joints, pushed onto a list. The inputs have it already, as what it does on v. Where inputs are held, the efforts at ports are, and what
    /// they do on v follows the configuration; without this, τ is held. By it [`Integration::telling_forces`] also knows where the inputs act, which decides what lies between that port and v.
    pub fn inputs_at_ports(
        mut self,
        efforts: impl FnMut(f64, &[f64], &[f64], &mut Vec<EffortAtPort>) + 'a,
    ) -> Self {
        self.port_inputs = Some(Box::new(efforts));
        self
    }

    /// With inputs that are taken at the initial time and after each `period` (s), and held in between: what a digital controller does. Steps
    /// end at these instants.
    pub const fn held(mut self, period: f64) -> Self {
        self.period = Some(period);
        self
    }

    /// With an observer of the initial state, of every accepted step, and of samples within steps; it breaks to end the integration there.
    pub fn observer(mut self, observer: impl FnMut(&Step<'_>) -> ControlFlow<()> + 'a) -> Self {
        self.observer = Box::new(observer);
        self
    }

    /// With samples from there.
    pub const fn sampling(mut self, sampling: Sampling) -> Self {
        self.sampling = sampling;
        self
    }

    /// With [`Step::carried`] at every sample: what the joints carry there, in either form, with inputs, elements, friction and drives. It costs a forward and an
    /// inverse dynamics a sample.
    pub const fn telling_forces(mut self) -> Self {
        self.tells_forces = true;
        self
    }

    /// With a method that is looked at again on the way, by [`Choice`](super::Choice): where springs stiffen, stops are met or joints fold, an explicit method gives way
    /// to Radau IIA, and the other way round; [`Solution::method_changes`] tells of it. Dense output and events keep the method.
    pub const fn choosing(mut self) -> Self {
        self.is_open = true;
        self
    }

    /// With one event more. Its crossings are in [`Solution::events`], located on the dense output to the rounding of time.
    pub fn event(mut self, event: Event<'a>) -> Self {
        self.events.push(event);
        self
    }

    /// Moves the mechanism, with the friction and the limits of its joints ([`Mechanism::with_frictions`], [`Mechanism::with_stops`]): by smooth
    /// pieces, whose ends are among [`Solution::events`].
    ///
    /// The initial state is checked, not projected; speeds of joints whose motion is prescribed are those of their laws, whatever it says.
    ///
    /// # Errors
    /// Options out of range; a period that is not positive and finite; `t_end` before the initial time; an initial state of the wrong size, not finite,
    /// off the joints' manifolds, or beyond their limits; friction or impacts that are not determined; a joint that chatters; a singular mass matrix; a step that fails at fixed size, or shrinks to nothing under step control; an event whose
    /// function is not finite.
    pub fn run(mut self) -> Result<Solution, IntegrateError> {
        let observer = core::mem::replace(&mut self.observer, Box::new(no_observer));
        self.begin(|driver| {
            let mut observer = observer;
            driver.run(&mut *observer)
        })
    }

    /// Whether it can begin: the options, the first state, and the equations of motion, the inputs and the events there. Nothing moves.
    ///
    /// # Errors
    /// As those of [`Integration::run`] at the first state.
    pub fn check(self) -> Result<(), IntegrateError> {
        self.begin(|_| Ok(()))
    }

    fn begin<R>(
        mut self,
        then: impl FnOnce(Driver<'_>) -> Result<R, IntegrateError>,
    ) -> Result<R, IntegrateError> {
        self.check_request()?;
        let hold = self.period;
        let inputs = self.inputs.as_mut();
        let bends = self.input_bends.as_mut();
        let at_ports = self.port_inputs.as_mut();
        let given = Given {
            inputs: inputs.map(|inputs| -> &mut Inputs<'_> { &mut **inputs }),
            bends: bends.map(|bends| -> &mut InputBends<'_> { &mut **bends }),
            at_ports: at_ports.map(|efforts| -> &mut PortInputs<'_> { &mut **efforts }),
        };
        let (dynamics, options) = (self.dynamics, self.options);
        let wanted = Wanted {
            sampling: self.sampling,
            events: self.events,
            is_open: self.is_open,
            tells_forces: self.tells_forces,
        };
        then(Driver::new(
            dynamics,
            self.initial,
            options,
            hold,
            given,
            wanted,
        )?)
    }

    fn check_request(&self) -> Result<(), IntegrateError> {
        let (initial, options) = (self.initial, self.options);
        let period = self.period.unwrap_or(f64::MAX);
        if !(period > 0.0 && period.is_finite()) {
            return Err(IntegrateError::Option {
                option: "period",
                value: period,
                requirement: "positive and finite",
            });
        }
        options.check(initial.time)?;
        check_length("period", period, initial.time, options.t_end)?;
        let mechanism = self.dynamics.mechanism();
        mechanism.check_configuration(&initial.configuration)?;
        mechanism.check_limits(&initial.configuration)?;
        mechanism.check_speeds("speeds", &initial.speeds)?;
        options.check_scheme(mechanism)
    }
}

impl Debug for Integration<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Integration")
            .field("initial", &self.initial)
            .field("options", &self.options)
            .field("period", &self.period)
            .field("sampling", &self.sampling)
            .field("events", &self.events)
            .finish_non_exhaustive()
    }
}
