//! MPC: each period an optimum over a short horizon, with inputs within limits.

mod program;

use super::error::{positive, require, size};
use super::regulator::{Equilibrium, Weights};
use super::riccati::{self, Weighting};
use super::state::check_sizes;
use super::{ControlError, Controller, DEVIATIONS, Measure};
use crate::integrate::{Form, LinearStep, Method};
use crate::mechanism::Mechanism;
use alloc::sync::Arc;
use core::fmt;
use nalgebra::{DMatrix, DVector};
use program::Program;

/// Holds an equilibrium with efforts within limits, by the optimum over a horizon of some periods, found anew in each period.
///
/// The motion that the last optimum foresees is taken as it comes, by steps of order 4 in local coordinates, each with its linearisation
/// A and B ([`LinearStep`]); about it the sum of `½ xᵀQx + ½ (u − u*)ᵀR(u − u*)` with x = (ϕ, v̄) read about the goal becomes a
/// quadratic program in the changes of the inputs, which the interior-point solver Clarabel solves. What comes after the horizon costs
/// `½ xᵀPx`, P from the Riccati equation at the goal. One program a period: the next one starts from where this one ends (M. Diehl,
/// H. G. Bock and J. P. Schlöder, *A real-time iteration scheme for nonlinear optimization in optimal feedback control*, 2005).
///
/// [`Controller::efforts`] is to be called once a period, as [`integrate_held`](crate::integrate::integrate_held) does. It allocates.
pub struct PredictiveRegulator {
    equilibrium: Equilibrium,
    period: f64,
    limits: Vec<f64>,
    /// Q, and P after the horizon.
    costs: [DMatrix<f64>; 2],
    input_weights: Vec<f64>,
    step: LinearStep,
    program: Program,
    /// The inputs of the horizon, period by period.
    plan: Vec<f64>,
    begun: bool,
    x: Vec<f64>,
}

impl fmt::Debug for PredictiveRegulator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PredictiveRegulator")
            .field("equilibrium", &self.equilibrium)
            .field("period", &self.period)
            .field("limits", &self.limits)
            .field("plan", &self.plan)
            .finish_non_exhaustive()
    }
}

impl PredictiveRegulator {
    /// The law that looks `horizon` periods of `period` (s) ahead, with efforts τ up to `limits` (one an input).
    ///
    /// # Errors
    /// Weights or limits of the wrong size, or out of range; an effort at rest beyond its limit; an empty horizon; a period that is not positive; a
    /// mechanism that cannot be linearised, or that the inputs cannot bring back.
    pub fn new(
        equilibrium: Equilibrium,
        weights: &Weights,
        horizon: usize,
        period: f64,
        limits: &[f64],
    ) -> Result<Self, ControlError> {
        positive("period", period)?;
        require("horizon", horizon as f64, horizon > 0, "at least 1")?;
        size("limits", equilibrium.inputs().len(), limits.len())?;
        let rest = equilibrium
            .inputs()
            .iter()
            .map(|&i| equilibrium.efforts()[i]);
        for (&limit, rest) in limits.iter().zip(rest.clone()) {
            positive("a limit", limit)?;
            let holds = rest.abs() <= limit;
            require("the effort at rest", rest, holds, "within its limit")?;
        }
        let mechanism = equilibrium.mechanism();
        let (state, input) = weights.matrices(&equilibrium)?;
        let mut step = LinearStep::new(mechanism, Form::Lagrangian, &Method::Rk4 { dt: period });
        let still = vec![0.0; mechanism.layout().speeds];
        step.linearize(equilibrium.goal(), &still, equilibrium.efforts(), period)?;
        let (a, b) = (step.by_state().matrix(), columns(&step, &equilibrium));
        let weighting = Weighting {
            state: &state,
            input: &input,
        };
        let cost = riccati::discrete(&a, &b, weighting)?.cost;
        let rest: Vec<f64> = rest.collect();
        Ok(Self {
            program: Program::new(horizon * limits.len())?,
            plan: rest.repeat(horizon),
            begun: false,
            x: vec![0.0; equilibrium.states()],
            costs: [state, cost],
            input_weights: weights.effort.clone(),
            limits: limits.to_vec(),
            step,
            period,
            equilibrium,
        })
    }

    /// The inputs that it has planned, period by period, those of this period first.
    pub fn plan(&self) -> &[f64] {
        &self.plan
    }

    const fn horizon(&self) -> usize {
        self.plan.len() / self.limits.len()
    }

    /// Moves the plan on by a period; what comes after it is rest.
    fn shift(&mut self) {
        if core::mem::replace(&mut self.begun, true) {
            let inputs = self.limits.len();
            self.plan.rotate_left(inputs);
            let last = self.plan.len() - inputs;
            for (slot, &freedom) in self.plan[last..].iter_mut().zip(self.equilibrium.inputs()) {
                *slot = self.equilibrium.efforts()[freedom];
            }
        }
    }

    /// Fills the program with what changes of the plan do to the cost, from (q, v̄) on.
    fn foresee(&mut self, q: &[f64], speeds: &[f64]) -> Result<(), ControlError> {
        let (inputs, states) = (self.limits.len(), self.x.len());
        let (mut q, mut speeds) = (q.to_vec(), speeds.to_vec());
        let mut efforts = self.equilibrium.efforts().to_vec();
        let mut change = DMatrix::zeros(states, self.plan.len());
        self.program.clear();
        for k in 0..self.horizon() {
            let planned = &self.plan[k * inputs..(k + 1) * inputs];
            for (&freedom, &input) in self.equilibrium.inputs().iter().zip(planned) {
                efforts[freedom] = input;
            }
            self.step.linearize(&q, &speeds, &efforts, self.period)?;
            change = self.step.by_state().matrix() * change;
            let reach = columns(&self.step, &self.equilibrium);
            change.columns_mut(k * inputs, inputs).copy_from(&reach);
            q.copy_from_slice(self.step.configuration());
            speeds.copy_from_slice(self.step.y());
            self.equilibrium.state(&q, &speeds, &mut self.x)?;
            let seen = seen_from(&self.equilibrium, &self.x) * &change;
            let last = k + 1 == self.horizon();
            self.program
                .add(&seen, &self.costs[usize::from(last)], &self.x);
        }
        self.weigh_inputs();
        Ok(())
    }

    fn weigh_inputs(&mut self) {
        let inputs = self.limits.len();
        for (place, &input) in self.plan.iter().enumerate() {
            let rest = self.equilibrium.efforts()[self.equilibrium.inputs()[place % inputs]];
            let weight = self.input_weights[place % inputs];
            let limit = self.limits[place % inputs];
            self.program.weigh(place, weight, input - rest);
            self.program.bound(place, [limit - input, limit + input]);
        }
    }
}

/// B with the columns of the inputs alone.
fn columns(step: &LinearStep, equilibrium: &Equilibrium) -> DMatrix<f64> {
    let all = step.by_efforts();
    DMatrix::from_fn(all.rows(), equilibrium.inputs().len(), |i, j| {
        all.entry(i, equilibrium.inputs()[j])
    })
}

/// What a small motion about a state does to x = (ϕ, v̄) as the goal sees it: D⁻¹ of each joint, and the identity.
fn seen_from(equilibrium: &Equilibrium, x: &[f64]) -> DMatrix<f64> {
    let mut map = DMatrix::identity(x.len(), x.len());
    let mechanism: &Arc<Mechanism> = equilibrium.mechanism();
    for body in mechanism.bodies() {
        let own = body.ranges().freedoms.clone();
        let (start, size) = (own.start, own.len());
        let goal = body.configuration(equilibrium.goal());
        let (mut unit, mut rate) = (DVector::zeros(size), DVector::zeros(size));
        for column in 0..size {
            unit.fill(0.0);
            unit[column] = 1.0;
            body.joint().retract_differential_inverse(
                goal,
                &x[own.clone()],
                unit.as_slice(),
                rate.as_mut_slice(),
            );
            map.view_mut((start, start + column), (size, 1))
                .copy_from(&rate);
        }
    }
    map
}

impl Controller for PredictiveRegulator {
    fn efforts(
        &mut self,
        time: f64,
        q: &[f64],
        speeds: &[f64],
        efforts: &mut [f64],
    ) -> Result<(), ControlError> {
        check_sizes(self.equilibrium.mechanism(), q, speeds, efforts)?;
        self.shift();
        self.foresee(q, speeds)?;
        let change = self.program.solve();
        let change = change.map_err(|status| ControlError::Optimizer { time, status })?;
        let inputs = self.limits.len();
        for (place, (input, change)) in self.plan.iter_mut().zip(change).enumerate() {
            let limit = self.limits[place % inputs];
            // An interior point may lie outside by the solver's tolerance.
            *input = (*input + change).clamp(-limit, limit);
        }
        efforts.copy_from_slice(self.equilibrium.efforts());
        for (&freedom, &input) in self.equilibrium.inputs().iter().zip(&self.plan) {
            efforts[freedom] = input;
        }
        Ok(())
    }

    fn measures(&self) -> &'static [Measure] {
        DEVIATIONS
    }

    fn measure(
        &mut self,
        _time: f64,
        q: &[f64],
        speeds: &[f64],
        values: &mut [f64],
    ) -> Result<(), ControlError> {
        self.equilibrium.measure(q, speeds, &mut self.x, values)
    }
}
