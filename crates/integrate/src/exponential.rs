//! One step of an exponential Rosenbrock method of order 4(3): the equations linearised at the state are solved exactly, what is left is
//! taken as in an explicit method.
//!
//! M. Hochbruck, A. Ostermann and J. Schweitzer, *Exponential Rosenbrock-type methods*, 2009: exprb43. A stiff spring at a joint is linear except for the curvature of the local coordinates, so that one step may span many periods, damped or not. The matrices are dense: made for up to some
//! tens of degrees of freedom. Bodies that nothing but uniform gravity acts on it takes in closed form ([`FreeBodies`]), over steps of any length.

use super::StepFailure;
use super::flow::{Flow, Rates};
use super::free_motion::FreeBodies;
use super::jacobian::Jacobian;
use super::phi::Phi;
use super::step_state::{StepState, add};
use super::stepper::{Solves, Span, Stepper};
use alloc::vec;
use alloc::vec::Vec;

/// From where to where derivatives in time are taken, as a part of the step.
const PART_OF_STEP: f64 = 1e-3;

/// The method at work. Vectors have ϕ first, then y.
pub(super) struct Exponential {
    /// Where all bodies are free, and nothing is asked for between the ends of steps.
    free: Option<FreeBodies>,
    jacobian: Jacobian,
    phi: Phi,
    /// The matrix for which φ was evaluated last, by rows, and the step.
    of: (Vec<f64>, f64),
    /// Where the step just tried began; NaN at first. Another try from there keeps J.
    at: f64,
    /// f and its derivative in time at the state.
    first: Vec<f64>,
    drift: Vec<f64>,
    increment: Vec<f64>,
    /// What the equations are at both stages beyond those at the state, linearised: D₂, D₃.
    remainders: [Vec<f64>; 2],
    combined: Vec<f64>,
    rates: Rates,
    error: Vec<f64>,
    solves: Solves,
}

impl Exponential {
    pub(super) fn new(flow: &Flow<'_>, lands: bool) -> Self {
        let is_left_alone = lands && flow.is_left_alone();
        let jacobian = Jacobian::new(flow);
        let size = jacobian.size();
        let vector = vec![0.0; size];
        Self {
            free: is_left_alone
                .then(|| FreeBodies::new(&flow.mechanism))
                .flatten(),
            phi: Phi::new(size),
            of: (vec![f64::NAN; size * size], f64::NAN),
            at: f64::NAN,
            first: vector.clone(),
            drift: vector.clone(),
            increment: vector.clone(),
            remainders: [vector.clone(), vector.clone()],
            combined: vector.clone(),
            rates: flow.new_rates(),
            error: vector,
            solves: Solves::default(),
            jacobian,
        }
    }

    /// f, its derivative in time, and φ of hJ.
    fn linearize(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        span: Span,
    ) -> Result<(), StepFailure> {
        let Span { time, step } = span;
        if self.at != time {
            store(&step_state.rates, &mut self.first);
            self.differentiate_in_time(step_state, flow, span)?;
            self.jacobian.evaluate(step_state, flow, time)?;
            self.solves.jacobians += 1;
            self.at = time;
        }
        let (known, of_step) = &mut self.of;
        let entries = self.jacobian.entries();
        if known.as_slice() == entries && *of_step == step {
            return Ok(());
        }
        known.copy_from_slice(entries);
        *of_step = step;
        self.solves.factorizations += 1;
        if !self.phi.evaluate(|i, j| step * self.jacobian.entry(i, j)) {
            *of_step = f64::NAN;
            return Err(StepFailure::SingularIteration {
                joint: flow.row_name(self.stiffest()),
            });
        }
        Ok(())
    }

    /// The largest row of J, or one that is not finite.
    fn stiffest(&self) -> usize {
        let size = self.jacobian.size();
        let rows = self.jacobian.entries().chunks_exact(size.max(1));
        let sizes = rows.map(|row| row.iter().map(|entry| entry.abs()).sum::<f64>());
        let largest = sizes.enumerate().fold((0, 0.0), |largest, (row, size)| {
            match size > largest.1 || size.is_nan() {
                true => (row, size),
                false => largest,
            }
        });
        largest.0
    }

    /// ∂f/∂t at the state: that of inputs and prescribed motions alone.
    ///
    /// From f after one and two parts of the step, `(−3 f₀ + 4 f₁ − f₂) / 2d`: within the step, since inputs may jump where it begins. With d so long, rounding
    /// of f adds less than 1e-12 of it to the result of a step, and what the difference leaves out is 1e-6 of what the method does.
    fn differentiate_in_time(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        Span { time, step }: Span,
    ) -> Result<(), StepFailure> {
        let first = time + PART_OF_STEP * step;
        let later = first - time;
        if later <= 0.0 || flow.is_autonomous() {
            self.drift.fill(0.0);
            return Ok(());
        }
        for (drift, here) in self.drift.iter_mut().zip(&self.first) {
            *drift = -1.5 * here / later;
        }
        for (instant, weight) in [(first, 2.0), (first + later, -0.5)] {
            flow.evaluate(
                instant,
                &step_state.base,
                &step_state.offset,
                &step_state.y,
                self.rates.parts(),
            )?;
            let rates = self.rates.phi.iter().chain(&self.rates.y);
            for (drift, there) in self.drift.iter_mut().zip(rates) {
                *drift += weight * there / later;
            }
        }
        Ok(())
    }

    /// Moves to the increment.
    fn move_on(&self, step_state: &mut StepState, flow: &Flow<'_>) -> Result<(), StepFailure> {
        step_state.move_by_increment(flow, &self.increment)
    }

    /// D of a stage at `time`, where `step_state` has come to after `later` seconds: `f − f₀ − J Z − later · ∂f/∂t`.
    fn remain(
        &mut self,
        stage: usize,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        Span { time, step: later }: Span,
    ) -> Result<(), StepFailure> {
        step_state.evaluate_there(flow, time + later, self.rates.parts())?;
        let remainder = &mut self.remainders[stage];
        store(&self.rates, remainder);
        add(remainder, -1.0, &self.first);
        add(remainder, -later, &self.drift);
        for (i, remainder) in remainder.iter_mut().enumerate() {
            let row = self.increment.iter().enumerate();
            let linear: f64 = row.map(|(j, z)| self.jacobian.entry(i, j) * z).sum();
            *remainder -= linear;
        }
        Ok(())
    }
}

impl Stepper for Exponential {
    fn attempt(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        span: Span,
    ) -> Result<(), StepFailure> {
        if let Some(free) = &mut self.free
            && free.attempt(step_state, flow, span)?
        {
            self.error.fill(0.0);
            return Ok(());
        }
        self.linearize(step_state, flow, span)?;
        let Span { time, step } = span;
        let (phi, first, drift) = (&self.phi, &self.first, &self.drift);
        self.increment.fill(0.0);
        phi.add(true, 1, 0.5 * step, first, &mut self.increment);
        phi.add(true, 2, 0.25 * step * step, drift, &mut self.increment);
        self.move_on(step_state, flow)?;
        let half = Span {
            time,
            step: 0.5 * step,
        };
        self.remain(0, step_state, flow, half)?;

        let Self {
            phi,
            first,
            drift,
            increment,
            remainders,
            combined,
            ..
        } = self;
        increment.fill(0.0);
        combined.copy_from_slice(first);
        add(combined, 1.0, &remainders[0]);
        phi.add(false, 1, step, combined, increment);
        phi.add(false, 2, step * step, drift, increment);
        self.move_on(step_state, flow)?;
        self.remain(1, step_state, flow, span)?;

        let Self {
            phi,
            first,
            drift,
            increment,
            remainders: [second, third],
            combined,
            error,
            ..
        } = self;
        increment.fill(0.0);
        phi.add(false, 1, step, first, increment);
        phi.add(false, 2, step * step, drift, increment);
        combined.fill(0.0);
        add(combined, 16.0, second);
        add(combined, -2.0, third);
        phi.add(false, 3, step, combined, increment);
        combined.fill(0.0);
        add(combined, -48.0, second);
        add(combined, 12.0, third);
        error.fill(0.0);
        phi.add(false, 4, step, combined, error);
        add(increment, 1.0, error);
        self.move_on(step_state, flow)
    }

    fn error(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        _span: Span,
        tolerance: f64,
    ) -> Result<(f64, usize), StepFailure> {
        step_state.set_errors(1.0 / tolerance, &self.error);
        step_state.largest_error(flow, Some(&self.rates.speeds))
    }

    fn order(&self) -> u32 {
        4
    }

    fn solves(&self) -> Solves {
        self.solves
    }
}

/// ϕ̇ and ẏ, one after the other.
fn store(rates: &Rates, into: &mut [f64]) {
    let (phi, y) = into.split_at_mut(rates.phi.len());
    phi.copy_from_slice(&rates.phi);
    y.copy_from_slice(&rates.y);
}
