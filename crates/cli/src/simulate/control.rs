//! The controller in the loop, and how well it did.

use super::plan::Plan;
use hamel::control::{Controller, Measure};
use hamel::dynamics::EffortAtPort;
use hamel::integrate::{HeldInputs, Step};
use hamel::mechanism::Mechanism;
use hamel::shown::Number;
use hamel_console::output::Failure;
use serde::Serialize;
use std::cell::RefCell;
use std::fmt;
use std::sync::Arc;

/// A controller that is at work: the integrator asks it for efforts, the recorder shows it states.
#[derive(Debug)]
pub struct Loop {
    state: RefCell<State>,
    period: Option<f64>,
}

#[derive(Debug)]
struct State {
    controller: Box<dyn Controller>,
    kind: &'static str,
    failure: Option<String>,
    errors: Vec<MeasureOutcome>,
    values: Vec<f64>,
    /// τ as it was taken last, one entry per degree of freedom.
    efforts: Vec<f64>,
    largest_effort: f64,
    mechanism: Arc<Mechanism>,
    /// The τ that was taken last, where it is held; `None` before.
    held: Option<HeldInputs>,
}

/// What a controller did.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// Which law it follows.
    pub kind: &'static str,
    /// Time between two readings of the state, s; absent for feedback at every instant.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub period_s: Option<f64>,
    /// The quantities by which it is judged.
    pub errors: Vec<MeasureOutcome>,
    /// The largest effort of any degree of freedom at the ends of steps, N m or N.
    pub largest_effort: f64,
}

/// One quantity by which a controller is judged.
#[derive(Clone, Debug, Serialize)]
pub struct MeasureOutcome {
    /// What it is called.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// At time 0.
    pub start: f64,
    /// The largest absolute value of all steps.
    pub largest: f64,
    /// At the end.
    pub end: f64,
}

impl MeasureOutcome {
    const fn new(measure: &Measure) -> Self {
        Self {
            name: measure.name,
            unit: measure.unit,
            start: 0.0,
            largest: 0.0,
            end: 0.0,
        }
    }

    fn see(&mut self, value: f64, first: bool) {
        if first {
            self.start = value;
        }
        // NaN stays.
        if value.is_nan() || value.abs() > self.largest {
            self.largest = value.abs();
        }
        self.end = value;
    }
}

impl Loop {
    /// The controller of `plan`, if it has one.
    ///
    /// # Errors
    /// What the law refuses, such as a reference that is too long for the time asked for.
    pub fn new(plan: &Plan) -> Result<Option<Self>, Failure> {
        let Some(control) = &plan.control else {
            return Ok(None);
        };
        let controller = control.controller(&plan.scene.mechanism, plan.settings.t_end);
        let controller =
            controller.map_err(|error| Failure::Simulation(format!("controller: {error}")))?;
        let errors: Vec<_> = controller
            .measures()
            .iter()
            .map(MeasureOutcome::new)
            .collect();
        let state = State {
            controller,
            kind: control.kind,
            failure: None,
            values: vec![0.0; errors.len()],
            errors,
            efforts: vec![0.0; plan.scene.mechanism.layout().freedoms],
            largest_effort: 0.0,
            held: None,
            mechanism: Arc::clone(&plan.scene.mechanism),
        };
        Ok(Some(Self {
            state: RefCell::new(state),
            period: control.period,
        }))
    }

    /// Time between two readings of the state, s.
    pub const fn period(&self) -> Option<f64> {
        self.period
    }

    /// τ into `efforts`; NaN where the law fails, so that the integration ends.
    pub fn fill(&self, time: f64, q: &[f64], speeds: &[f64], efforts: &mut [f64]) {
        let state = &mut *self.state.borrow_mut();
        state.take(time, q, speeds);
        if self.period.is_some() {
            state.hold(time, q, speeds);
        }
        efforts.copy_from_slice(&state.efforts);
    }

    /// Where the law's efforts bend; nothing where it fails, which its efforts tell as well.
    pub fn bends(&self, time: f64, q: &[f64], speeds: &[f64], bends: &mut Vec<f64>) {
        let state = &mut *self.state.borrow_mut();
        if let Err(cause) = state.controller.bends(time, q, speeds, bends) {
            state.fail(time, &cause);
        }
    }

    /// What of the law's efforts acts at ports; nothing where it fails, which its efforts tell as well.
    pub fn efforts_at_ports(
        &self,
        time: f64,
        q: &[f64],
        speeds: &[f64],
        efforts: &mut Vec<EffortAtPort>,
    ) {
        let state = &mut *self.state.borrow_mut();
        let found = state.controller.efforts_at_ports(time, q, speeds, efforts);
        if let Err(cause) = found {
            state.fail(time, &cause);
        }
    }

    /// τ from the end of `step` on: where efforts are held, those that were taken last, which is then at the latest.
    pub fn efforts(&self, step: &Step<'_>) -> Vec<f64> {
        let state = &mut *self.state.borrow_mut();
        state.bring(step, self.period);
        state.efforts.clone()
    }

    /// Judges the controller by a step that was accepted: step control went round what failed before.
    pub fn see(&self, step: &Step<'_>) {
        let state = &mut *self.state.borrow_mut();
        state.failure = None;
        state.bring(step, self.period);
        let sizes = state.efforts.iter().map(|effort| effort.abs());
        state.largest_effort = sizes.fold(state.largest_effort, f64::max);
        let (q, speeds) = (step.configuration, step.speeds);
        let values = &mut state.values;
        match state.controller.measure(step.time, q, speeds, values) {
            Ok(()) => {
                for (error, &value) in state.errors.iter_mut().zip(values.iter()) {
                    error.see(value, step.number == 0);
                }
            }
            Err(cause) => state.fail(step.time, &cause),
        }
    }

    /// Why the controller failed, if it did.
    pub fn failure(&self) -> Option<String> {
        self.state.borrow().failure.clone()
    }

    /// What it did.
    pub fn finish(self) -> Outcome {
        let state = self.state.into_inner();
        Outcome {
            kind: state.kind,
            period_s: self.period,
            errors: state.errors,
            largest_effort: state.largest_effort,
        }
    }
}

impl State {
    /// Takes τ at the end of `step`, or makes it what the efforts that are held do there.
    fn bring(&mut self, step: &Step<'_>, period: Option<f64>) {
        let q = step.configuration;
        if period.is_none() {
            return self.take(step.time, q, step.speeds);
        }
        if let Some(held) = &self.held {
            held.efforts_at(&self.mechanism, q, &mut self.efforts);
        }
    }

    /// Holds the τ just taken.
    fn hold(&mut self, time: f64, q: &[f64], speeds: &[f64]) {
        let mut at_ports = Vec::new();
        let found = (self.controller).efforts_at_ports(time, q, speeds, &mut at_ports);
        if let Err(cause) = found {
            self.fail(time, &cause);
        }
        let efforts = self.efforts.clone();
        self.held = Some(HeldInputs::new(&self.mechanism, q, efforts, at_ports));
    }

    /// τ of the law; NaN where it fails.
    fn take(&mut self, time: f64, q: &[f64], speeds: &[f64]) {
        self.efforts.fill(0.0);
        let taken = self.controller.efforts(time, q, speeds, &mut self.efforts);
        if let Err(cause) = taken {
            self.fail(time, &cause);
            self.efforts.fill(f64::NAN);
        }
    }

    fn fail(&mut self, time: f64, cause: &dyn fmt::Display) {
        let kind = self.kind;
        let message = || format!("at {time} s the controller `{kind}` fails: {cause}");
        self.failure.get_or_insert_with(message);
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let effort = self.largest_effort;
        match self.period_s {
            None => write!(f, "control     {} at every instant", self.kind)?,
            Some(period) => write!(f, "control     {} each {:?} s", self.kind, Number(period))?,
        }
        writeln!(f, "; largest effort {effort:.4e} N m or N")?;
        for error in &self.errors {
            let MeasureOutcome {
                name,
                unit,
                start,
                largest,
                end,
            } = error;
            writeln!(
                f,
                "            {name}: {start:.2e} at the start, {largest:.2e} at most, {end:.2e} at the end ({unit})"
            )?;
        }
        Ok(())
    }
}
