//! MPC: each period an optimum over a short horizon, with inputs within limits.

mod program;
mod stability;

use super::error::{positive, require, size};
use super::regulator::{Equilibrium, Weights};
use super::riccati::{self, Optimum, Weighting};
use super::stabilizability::Time;
use super::state::check_state;
use super::{ControlError, Controller, DEVIATIONS, Measure};
use alloc::sync::Arc;
use core::fmt;
use hamel_integrate::{Form, LinearStep, Spectrum, Tableau};
use hamel_runtime::mechanism::Mechanism;
use nalgebra::{DMatrix, DVector, DVectorView};
use program::Program;

/// Programs in the first period at most, which has no plan to go on from.
const FIRST_PROGRAMS: usize = 30;

/// The most inputs of a plan: its matrix of 4096² numbers takes 128 MiB.
const MOST_INPUTS: usize = 4096;

/// How often a change that makes the plan worse is halved: a program sees motions to first order.
const MOST_HALVINGS: i32 = 8;

/// Holds an equilibrium with efforts within limits, by the optimum over a horizon of some periods, found anew in each period.
///
/// The motion that the last optimum foresees is taken as it comes, by steps of order 4 in local coordinates, each with its linearisation
/// A and B ([`LinearStep`]); about it the sum of `½ xᵀQx + ½ (u − u*)ᵀR(u − u*)` with x = (ϕ, v̄) read about the goal becomes a
/// quadratic program in the changes of the inputs, which the interior-point solver Clarabel solves. What comes after the horizon costs
/// `½ xᵀPx`, P from the Riccati equation at the goal. One program a period: the next one starts from where this one ends, or from linear feedback that is cut off at
/// the limits where that is better; and of the change that a program proposes so much is taken as makes the plan better (M. Diehl,
/// H. G. Bock and J. P. Schlöder, *A real-time iteration scheme for nonlinear optimization in optimal feedback control*, 2005).
///
/// [`Controller::efforts`] is to be called once a period, as [`integrate_held`](hamel_integrate::integrate_held) does. It allocates.
pub struct PredictiveRegulator {
    equilibrium: Equilibrium,
    period: f64,
    limits: Vec<f64>,
    /// K of the linear feedback in discrete time.
    gain: DMatrix<f64>,
    /// Q, and P after the horizon.
    costs: [DMatrix<f64>; 2],
    input_weights: Vec<f64>,
    step: LinearStep,
    program: Program,
    /// The inputs of the horizon, period by period.
    plan: Vec<f64>,
    /// The period up to which a motion was foreseen last.
    reached: usize,
    begun: bool,
    x: Vec<f64>,
}

/// What to go through a motion for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Task {
    /// Its cost alone.
    Judge,
    /// What changes of the plan do to it, into the program.
    Learn,
    /// To make the plan by linear feedback on the way.
    FeedBack,
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
    /// mechanism that cannot be linearised, or that the inputs cannot bring back; a period that is too long for steps of order 4 to foresee its fastest motion.
    pub fn new(
        equilibrium: Equilibrium,
        weights: &Weights,
        horizon: usize,
        period: f64,
        limits: &[f64],
    ) -> Result<Self, ControlError> {
        positive("period", period)?;
        size("limits", equilibrium.inputs().len(), limits.len())?;
        let allowed = 1..=MOST_INPUTS / limits.len().max(1);
        require(
            "horizon",
            horizon as f64,
            allowed.contains(&horizon),
            "at least 1, and times the inputs at most 4096",
        )?;
        let rest = equilibrium
            .inputs()
            .iter()
            .map(|&i| equilibrium.efforts()[i]);
        let mechanism = equilibrium.mechanism();
        for ((&limit, effort), &freedom) in
            limits.iter().zip(rest.clone()).zip(equilibrium.inputs())
        {
            positive("a limit", limit)?;
            if effort.abs() > limit {
                return Err(weak(mechanism, freedom, effort, limit));
            }
        }
        let (state, input) = weights.matrices(&equilibrium)?;
        // Of the motion itself: the step damps what swings, and so hides what no input reaches.
        let (a, b) = equilibrium.linearized()?;
        riccati::solvable(&a, &b, &state, Time::Continuous)
            .map_err(|cause| equilibrium.locate(cause))?;
        foreseeable(&equilibrium, &a, period)?;
        let mut step = LinearStep::new(mechanism, Form::Lagrangian, &Tableau::RK4);
        let still = vec![0.0; mechanism.layout().speeds];
        step.linearize(equilibrium.goal(), &still, equilibrium.efforts(), period)?;
        let (a, b) = (step.by_state().matrix(), columns(&step, &equilibrium));
        let weighting = Weighting {
            state: &state,
            input: &input,
        };
        let Optimum { cost, gain } =
            riccati::discrete(&a, &b, weighting).map_err(|cause| equilibrium.locate(cause))?;
        let rest: Vec<f64> = rest.collect();
        Ok(Self {
            program: Program::new(horizon * limits.len())?,
            plan: rest.repeat(horizon),
            reached: 0,
            begun: false,
            gain,
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
        let inputs = self.limits.len();
        self.plan.rotate_left(inputs);
        let last = self.plan.len() - inputs;
        for (slot, &freedom) in self.plan[last..].iter_mut().zip(self.equilibrium.inputs()) {
            *slot = self.equilibrium.efforts()[freedom];
        }
    }

    /// What the plan costs from (q, v̄) on; infinity where its motion cannot be foreseen.
    fn cost(&mut self, q: &[f64], speeds: &[f64]) -> f64 {
        self.foresee(q, speeds, Task::Judge)
            .ok()
            .filter(|cost| cost.is_finite())
            .unwrap_or(f64::INFINITY)
    }

    /// Goes through the motion of the plan from (q, v̄) on; what the plan costs.
    fn foresee(&mut self, q: &[f64], speeds: &[f64], task: Task) -> Result<f64, ControlError> {
        let (inputs, states) = (self.limits.len(), self.x.len());
        let (mut q, mut speeds) = (q.to_vec(), speeds.to_vec());
        let mut efforts = self.equilibrium.efforts().to_vec();
        let mut change = DMatrix::zeros(states, self.plan.len());
        let mut cost = 0.0;
        self.program.clear();
        for k in 0..self.horizon() {
            self.reached = k;
            let now = k * inputs..(k + 1) * inputs;
            if task == Task::FeedBack {
                self.feed_back(&q, &speeds, k)?;
            }
            for (&freedom, &input) in self.equilibrium.inputs().iter().zip(&self.plan[now]) {
                efforts[freedom] = input;
            }
            self.step.linearize(&q, &speeds, &efforts, self.period)?;
            q.copy_from_slice(self.step.configuration());
            speeds.copy_from_slice(self.step.y());
            self.equilibrium.state(&q, &speeds, &mut self.x)?;
            let last = k + 1 == self.horizon();
            let weight = &self.costs[usize::from(last)];
            let x = DVectorView::from_slice(&self.x, states);
            cost += 0.5 * x.dot(&(weight * x));
            if task == Task::Learn {
                change = self.step.by_state().matrix() * change;
                let reach = columns(&self.step, &self.equilibrium);
                change.columns_mut(k * inputs, inputs).copy_from(&reach);
                let seen = seen_from(&self.equilibrium, &self.x) * &change;
                self.program.add(&seen, weight, &self.x);
            }
        }
        Ok(cost + self.weigh_inputs())
    }

    /// The inputs of period `k` by linear feedback from (q, v̄), cut off at the limits.
    fn feed_back(&mut self, q: &[f64], speeds: &[f64], k: usize) -> Result<(), ControlError> {
        self.equilibrium.state(q, speeds, &mut self.x)?;
        let start = k * self.limits.len();
        for (row, &freedom) in self.equilibrium.inputs().iter().enumerate() {
            let terms = self.gain.row(row).into_iter().zip(&self.x);
            let input = terms.fold(self.equilibrium.efforts()[freedom], |u, (k, x)| u - k * x);
            self.plan[start + row] = input.clamp(-self.limits[row], self.limits[row]);
        }
        Ok(())
    }

    /// A plan to begin with: what is left of the last one, or linear feedback that is cut off, whichever costs less; and its cost.
    fn begin(&mut self, q: &[f64], speeds: &[f64]) -> Result<f64, ControlError> {
        self.shift();
        let (kept, cost) = (self.plan.clone(), self.cost(q, speeds));
        let simple = self.foresee(q, speeds, Task::FeedBack);
        match simple {
            Ok(simple) if simple < cost => Ok(simple),
            _ if cost.is_finite() => {
                self.plan = kept;
                Ok(cost)
            }
            Err(cause) => Err(self.lost(&cause)),
            Ok(_) => Err(self.lost(&"the cost is not finite")),
        }
    }

    /// The refusal of a motion that was foreseen as far as [`Self::reached`].
    fn lost(&self, cause: &dyn fmt::Display) -> ControlError {
        let (period, horizon) = (self.reached + 1, self.horizon());
        self.no_plan(
            self.reached,
            format!("in period {period} of {horizon} ahead, {cause}"),
        )
    }

    /// The refusal of a plan, with the inputs that it has at their limits in a period.
    fn no_plan(&self, period: usize, cause: String) -> ControlError {
        let start = period * self.limits.len();
        let now = self.plan[start..].iter().zip(&self.limits);
        let bound = now.zip(self.equilibrium.inputs());
        let bound = bound.filter(|((input, limit), _)| input.abs() >= **limit);
        let bound: Vec<String> = bound
            .map(|((_, limit), &freedom)| {
                let joint = owner(self.equilibrium.mechanism(), freedom);
                format!("the input of joint `{joint}` is at its limit of {limit} N m or N")
            })
            .collect();
        ControlError::NoPlan {
            cause,
            binding: match bound.is_empty() {
                true => String::from("no input is at its limit then"),
                false => bound.join(", "),
            },
        }
    }

    /// One program, and as much of its change of the plan as makes the plan better; whether any does.
    fn improve(
        &mut self,
        (q, speeds): (&[f64], &[f64]),
        cost: &mut f64,
    ) -> Result<bool, ControlError> {
        let foreseen = self.foresee(q, speeds, Task::Learn);
        foreseen.map_err(|cause| self.lost(&cause))?;
        let change = self.program.solve().map(<[f64]>::to_vec);
        let told = |status| format!("the optimiser ends with `{status}`");
        let change = change.map_err(|status| self.no_plan(0, told(status)))?;
        let kept = self.plan.clone();
        let inputs = self.limits.len();
        for halvings in 0..MOST_HALVINGS {
            let part = 0.5_f64.powi(halvings);
            for (place, input) in self.plan.iter_mut().enumerate() {
                let limit = self.limits[place % inputs];
                // An interior point may lie outside by the solver's tolerance.
                *input = (kept[place] + part * change[place]).clamp(-limit, limit);
            }
            let found = self.cost(q, speeds);
            if found < *cost {
                *cost = found;
                return Ok(true);
            }
        }
        self.plan = kept;
        Ok(false)
    }

    /// Bounds and costs of the inputs, into the program; what they cost.
    fn weigh_inputs(&mut self) -> f64 {
        let inputs = self.limits.len();
        let mut cost = 0.0;
        for (place, &input) in self.plan.iter().enumerate() {
            let rest = self.equilibrium.efforts()[self.equilibrium.inputs()[place % inputs]];
            let weight = self.input_weights[place % inputs];
            let limit = self.limits[place % inputs];
            self.program.weigh(place, weight, input - rest);
            self.program.bound(place, [limit - input, limit + input]);
            cost += 0.5 * weight * (input - rest) * (input - rest);
        }
        cost
    }
}

/// Whether steps of a period are stable for all motions of `ẋ = a x` that do not grow by themselves; where these cannot be found it is believed.
fn foreseeable(
    equilibrium: &Equilibrium,
    a: &DMatrix<f64>,
    period: f64,
) -> Result<(), ControlError> {
    let Some(spectrum) = Spectrum::of(equilibrium.mechanism(), a.clone()) else {
        return Ok(());
    };
    let modes = spectrum.modes().iter().filter(|mode| !mode.is_growing());
    let mut limits = modes.map(|mode| (mode, stability::limit(mode)));
    match limits.find(|(mode, limit)| period * mode.rate() > *limit) {
        Some((mode, limit)) => Err(ControlError::PeriodTooLong {
            joint: spectrum.joint(mode).into(),
            period,
            rate: mode.rate(),
            limit,
        }),
        None => Ok(()),
    }
}

/// The name of the joint that a degree of freedom belongs to.
fn owner(mechanism: &Mechanism, freedom: usize) -> &str {
    let mut bodies = mechanism.bodies().iter();
    let owner = bodies.find(|body| body.ranges().freedoms.contains(&freedom));
    owner.map_or("", |body| body.joint_name())
}

/// The refusal of a limit below what the joint of `freedom` needs at rest.
fn weak(mechanism: &Mechanism, freedom: usize, effort: f64, limit: f64) -> ControlError {
    ControlError::Weak {
        joint: owner(mechanism, freedom).into(),
        effort,
        limit,
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
    for (_, body) in mechanism.joints() {
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
        _time: f64,
        q: &[f64],
        speeds: &[f64],
        efforts: &mut [f64],
    ) -> Result<(), ControlError> {
        check_state(self.equilibrium.mechanism(), q, speeds, efforts)?;
        let mut cost = self.begin(q, speeds)?;
        let programs = match core::mem::replace(&mut self.begun, true) {
            true => 1,
            false => FIRST_PROGRAMS,
        };
        for _ in 0..programs {
            if !self.improve((q, speeds), &mut cost)? {
                break;
            }
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
