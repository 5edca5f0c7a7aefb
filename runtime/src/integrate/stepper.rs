//! One step of an explicit method in (ϕ, y).

use super::flow::{Flow, Rates, retract};
use super::residue::{Residue, add_exactly};
use super::turns::{Turns, check_finite};
use super::{Estimate, StepFailure, Tableau};
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

/// The ϕ from which on a joint gets a new base point. Each of them costs one rounding of Q, which a base at every step would
/// cost at every step; from a half on, ϕ bends more than most steps do.
const FAR: f64 = 0.5;

/// The state at the last accepted step, the stages of the one being tried, and its outcome.
pub(super) struct Stepper {
    tableau: &'static Tableau,
    /// Q at the state: `Φ(base, offset)`.
    pub(super) configuration: Vec<f64>,
    pub(super) y: Vec<f64>,
    /// The points around which ϕ is measured.
    base: Vec<f64>,
    /// ϕ at the state.
    offset: Vec<f64>,
    /// Stage 0 holds the rates at the state itself, always.
    stages: Vec<Rates>,
    phi: Vec<f64>,
    next_y: Vec<f64>,
    /// What ϕ and y are too coarse to hold.
    residue: Residue,
    next_residue: Residue,
    /// Estimated errors of ϕ and y, and what that of y amounts to in v̄.
    errors: Rates,
    /// How far each joint turns from its base point.
    turns: Turns,
}

impl Stepper {
    pub(super) fn new(
        tableau: &'static Tableau,
        flow: &mut Flow<'_>,
        time: f64,
        configuration: &[f64],
        speeds: &[f64],
    ) -> Result<Self, StepFailure> {
        let mut speeds = speeds.to_vec();
        flow.mechanism.set_driven_speeds(time, &mut speeds);
        let y = flow.initial(configuration, &speeds)?;
        let freedoms = flow.mechanism.layout().freedoms;
        let mut stepper = Self {
            tableau,
            configuration: configuration.to_vec(),
            base: configuration.to_vec(),
            offset: vec![0.0; freedoms],
            stages: tableau.nodes.iter().map(|_| flow.new_rates()).collect(),
            phi: vec![0.0; freedoms],
            next_y: y.clone(),
            residue: Residue::new(&flow.mechanism),
            next_residue: Residue::new(&flow.mechanism),
            errors: flow.new_rates(),
            turns: Turns::new(&flow.mechanism),
            y,
        };
        stepper.evaluate_state(flow, time)?;
        stepper.turns.set(&flow.mechanism, configuration);
        Ok(stepper)
    }

    /// v̄ at the state.
    pub(super) fn speeds(&self) -> &[f64] {
        &self.stages[0].speeds
    }

    /// Tries a step; the state stays as it is.
    pub(super) fn attempt(
        &mut self,
        flow: &mut Flow<'_>,
        time: f64,
        step: f64,
    ) -> Result<(), StepFailure> {
        let tableau = self.tableau;
        for i in 1..tableau.nodes.len() {
            self.combine(step, tableau.matrix[i]);
            self.turns.check(&flow.mechanism, &self.phi, &self.next_y)?;
            let (_, rest) = self.stages.split_at_mut(i);
            let at = time + step * tableau.nodes[i];
            flow.evaluate(at, &self.base, &self.phi, &self.next_y, &mut rest[0])?;
            check_finite(&flow.mechanism, &rest[0].phi, &rest[0].y)?;
        }
        if !tableau.first_same_as_last {
            self.combine(step, tableau.weights);
            self.turns.check(&flow.mechanism, &self.phi, &self.next_y)?;
        }
        Ok(())
    }

    /// Error of the step just tried over the tolerance, and the joint that has it.
    pub(super) fn error(
        &mut self,
        flow: &mut Flow<'_>,
        step: f64,
        tolerance: f64,
    ) -> Result<(f64, usize), StepFailure> {
        let unit = step / tolerance;
        match self.tableau.estimate {
            Estimate::None => Ok((0.0, 0)),
            Estimate::One(weights) => self.largest(flow, unit, weights),
            Estimate::Pair { fifth, third } => {
                let (fifth, joint) = self.largest(flow, unit, fifth)?;
                let (third, _) = self.largest(flow, unit, third)?;
                Ok((paired(fifth, third), joint))
            }
        }
    }

    /// The largest entry of `unit · Σ weights · rates`, as parts of ϕ and v̄ or of 1, and the joint that has it.
    ///
    /// An error of p̄ counts as what it does to v̄: on a heavy body that carries a light one, the same p̄ is much more.
    fn largest(
        &mut self,
        flow: &mut Flow<'_>,
        unit: f64,
        weights: &[f64],
    ) -> Result<(f64, usize), StepFailure> {
        let Self { stages, errors, .. } = self;
        sum_errors(weights, stages, |rates| &rates.phi, unit, &mut errors.phi);
        sum_errors(weights, stages, |rates| &rates.y, unit, &mut errors.y);
        flow.speeds_of(&self.configuration, &errors.y, &mut errors.speeds)?;
        let last = &stages[stages.len() - 1].speeds;
        let part = |error: f64, size: f64| match error.abs() / size.max(1.0) {
            part if part.is_nan() => f64::INFINITY,
            part => part,
        };
        let mut worst = (0.0, 0);
        for (index, body) in flow.mechanism.bodies().iter().enumerate() {
            let (freedoms, speeds) = (body.ranges().freedoms.clone(), body.ranges().speeds.clone());
            // No sum resolves a part of a step that is longer than 1 better than relative to it.
            let local = freedoms.map(|i| part(errors.phi[i], self.phi[i].abs()));
            let sizes = |i: usize| stages[0].speeds[i].abs().max(last[i].abs());
            let rates = speeds.map(|i| part(errors.speeds[i], sizes(i)));
            let error = local.chain(rates).fold(0.0, f64::max);
            if error > worst.0 {
                worst = (error, index);
            }
        }
        Ok(worst)
    }

    /// Makes the step just tried the state; joints whose ϕ has grown get a new base point.
    pub(super) fn accept(&mut self, flow: &mut Flow<'_>, time: f64) -> Result<(), StepFailure> {
        core::mem::swap(&mut self.residue, &mut self.next_residue);
        core::mem::swap(&mut self.y, &mut self.next_y);
        self.offset.copy_from_slice(&self.phi);
        retract(
            &flow.mechanism,
            &self.base,
            &self.offset,
            &mut self.configuration,
        );
        self.recentre(flow)?;
        let drives = flow.mechanism.drives();
        for drive in drives {
            let own = flow.mechanism.bodies()[drive.body].ranges().speeds.clone();
            self.residue.y[own].fill(0.0);
        }
        // Prescribed speeds are what their laws say, not what steps have made of them.
        flow.mechanism.set_driven_speeds(time, &mut self.y);
        if !self.tableau.first_same_as_last || !drives.is_empty() {
            return self.evaluate_state(flow, time);
        }
        // The last stage was taken here; ϕ̇ alone belongs to the old base points.
        let last = self.stages.len() - 1;
        self.stages.swap(0, last);
        let rates = &mut self.stages[0];
        flow.recentre(&self.configuration, &self.base, &self.offset, rates);
        Ok(())
    }

    /// Moves the base point of every joint that is far from it to the state.
    fn recentre(&mut self, flow: &mut Flow<'_>) -> Result<(), StepFailure> {
        let mechanism = Arc::clone(&flow.mechanism);
        let far = |phi: &[f64]| phi.iter().any(|entry| entry.abs() > FAR);
        let mut moved = false;
        for body in mechanism.bodies() {
            let (freedoms, own) = (&body.ranges().freedoms, &body.ranges().configuration);
            if !far(&self.offset[freedoms.clone()]) {
                continue;
            }
            let (old, new) = (
                &mut self.base[own.clone()],
                &mut self.configuration[own.clone()],
            );
            let projected = body.joint().project(new);
            projected.map_err(|cause| body.finite_map(cause))?;
            let phi = &mut self.offset[freedoms.clone()];
            self.residue.keep(body, old, new, phi);
            old.copy_from_slice(new);
            phi.fill(0.0);
            moved = true;
        }
        if moved {
            self.turns.set(&mechanism, &self.base);
        }
        Ok(())
    }

    /// Rates at the state: stage 0 of the next step.
    pub(super) fn evaluate_state(
        &mut self,
        flow: &mut Flow<'_>,
        time: f64,
    ) -> Result<(), StepFailure> {
        let rates = &mut self.stages[0];
        flow.evaluate(time, &self.base, &self.offset, &self.y, rates)?;
        check_finite(&flow.mechanism, &self.stages[0].phi, &self.stages[0].y)
    }

    /// Largest rate at the state, as [`Stepper::error`] measures it, 1/s.
    pub(super) fn pace(&mut self, flow: &mut Flow<'_>) -> Result<f64, StepFailure> {
        let (rates, accelerations) = (&self.stages[0], &mut self.errors.speeds);
        flow.speeds_of(&self.configuration, &rates.y, accelerations)?;
        let local = rates.phi.iter().map(|rate| rate.abs());
        let others = accelerations.iter().zip(&rates.speeds);
        let others = others.map(|(rate, speed)| rate.abs() / speed.abs().max(1.0));
        Ok(local.chain(others).fold(0.0, f64::max))
    }

    /// ϕ and y after `step · Σ weights · rates`, from what the last step left over on.
    fn combine(&mut self, step: f64, weights: &[f64]) {
        let Residue { phi, y } = &mut self.next_residue;
        phi.copy_from_slice(&self.residue.phi);
        y.copy_from_slice(&self.residue.y);
        for (&weight, rates) in weights.iter().zip(&self.stages) {
            if weight == 0.0 {
                continue;
            }
            add(phi, step * weight, &rates.phi);
            add(y, step * weight, &rates.y);
        }
        add_all_exactly(&self.offset, &mut self.phi, phi);
        add_all_exactly(&self.y, &mut self.next_y, y);
    }
}

/// `unit · Σ weights · rates` into `errors`.
fn sum_errors(
    weights: &[f64],
    stages: &[Rates],
    entries: impl Fn(&Rates) -> &[f64],
    unit: f64,
    errors: &mut [f64],
) {
    for (i, error) in errors.iter_mut().enumerate() {
        let (mut sum, mut size) = (0.0_f64, 0.0);
        for (weight, rates) in weights.iter().zip(stages) {
            let term = weight * entries(rates)[i];
            sum += term;
            size += term.abs();
        }
        // What rounding makes of terms that cancel is no error of the step.
        let beyond = sum.abs() - 2.0 * f64::EPSILON * size;
        *error = if beyond < 0.0 {
            0.0
        } else {
            unit * beyond.copysign(sum)
        };
    }
}

/// `start + change` into `sum`; what it lacks of the exact sums into `change`.
fn add_all_exactly(start: &[f64], sum: &mut [f64], change: &mut [f64]) {
    for ((&start, sum), change) in start.iter().zip(sum).zip(change) {
        (*sum, *change) = add_exactly(start, *change);
    }
}

fn add(sum: &mut [f64], weight: f64, terms: &[f64]) {
    for (sum, term) in sum.iter_mut().zip(terms) {
        *sum += weight * term;
    }
}

/// The estimate of [`Estimate::Pair`]; NaN where a difference is.
fn paired(fifth: f64, third: f64) -> f64 {
    let norm = num_traits::Float::hypot(fifth, 0.1 * third);
    if fifth == 0.0 {
        0.0
    } else {
        fifth * (fifth / norm)
    }
}
