//! One step of an explicit method in (ϕ, y).

use super::flow::{Flow, Rates, multiply, retract};
use super::residue::{Residue, add_exactly};
use super::{Estimate, StepFailure, Tableau};
use crate::mechanism::Body;
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;

/// The state at the last accepted step, the stages of the one being tried, and its outcome.
pub(super) struct Stepper {
    tableau: &'static Tableau,
    pub(super) configuration: Vec<f64>,
    pub(super) y: Vec<f64>,
    /// Stage 0 holds the rates at the state itself, always.
    stages: Vec<Rates>,
    phi: Vec<f64>,
    next_y: Vec<f64>,
    next_residue: Vec<f64>,
    next_configuration: Vec<f64>,
    /// What Q and y are too coarse to hold.
    residue: Residue,
    /// What counts as one in y.
    units: Vec<f64>,
    /// ϕ to the rotation of each joint at the state, [`Flow::turn_maps`].
    turn_maps: Vec<f64>,
}

impl Stepper {
    pub(super) fn new(
        tableau: &'static Tableau,
        flow: &mut Flow<'_>,
        time: f64,
        configuration: &[f64],
        speeds: &[f64],
    ) -> Result<Self, StepFailure> {
        let y = flow.initial(configuration, speeds)?;
        let mut stepper = Self {
            tableau,
            configuration: configuration.to_vec(),
            stages: tableau.nodes.iter().map(|_| flow.new_rates()).collect(),
            phi: vec![0.0; flow.mechanism.layout().freedoms],
            next_y: y.clone(),
            next_residue: vec![0.0; y.len()],
            next_configuration: configuration.to_vec(),
            residue: Residue::new(&flow.mechanism),
            units: flow.units(configuration)?,
            turn_maps: vec![0.0; 3 * flow.mechanism.layout().freedoms],
            y,
        };
        stepper.evaluate_state(flow, time)?;
        flow.turn_maps(configuration, &mut stepper.turn_maps);
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
            self.check_motion(flow)?;
            let (_, rest) = self.stages.split_at_mut(i);
            let at = time + step * tableau.nodes[i];
            flow.evaluate(
                at,
                &self.configuration,
                &self.phi,
                &self.next_y,
                &mut rest[0],
            )?;
            check_finite(flow, &rest[0])?;
        }
        if !tableau.first_same_as_last {
            self.combine(step, tableau.weights);
            self.check_motion(flow)?;
        }
        Ok(())
    }

    /// Error of the step just tried over the tolerance, and the joint that has it.
    pub(super) fn error(&self, flow: &Flow<'_>, step: f64, tolerance: f64) -> (f64, usize) {
        let unit = step / tolerance;
        match self.tableau.estimate {
            Estimate::None => (0.0, 0),
            Estimate::One(weights) => self.largest(flow, unit, weights),
            Estimate::Pair { fifth, third } => {
                let (fifth, joint) = self.largest(flow, unit, fifth);
                let (third, _) = self.largest(flow, unit, third);
                (paired(fifth, third), joint)
            }
        }
    }

    /// The largest `unit · Σ weights · rates`, in units of ϕ and y, and the joint that has it.
    fn largest(&self, flow: &Flow<'_>, unit: f64, weights: &[f64]) -> (f64, usize) {
        let sum = |entry: &dyn Fn(&Rates) -> f64| {
            let (mut sum, mut size) = (0.0_f64, 0.0);
            for (weight, rates) in weights.iter().zip(&self.stages) {
                let term = weight * entry(rates);
                sum += term;
                size += term.abs();
            }
            // What rounding makes of terms that cancel is no error of the step.
            unit * (sum.abs() - 2.0 * f64::EPSILON * size).max(0.0)
        };
        let mut worst = (0.0, 0);
        for (index, body) in flow.mechanism.bodies().iter().enumerate() {
            let ranges = body.ranges();
            // No sum resolves a part of a step that is longer than 1 better than relative to it.
            let local = ranges
                .freedoms
                .clone()
                .map(|i| sum(&|rates| rates.phi[i]) / self.phi[i].abs().max(1.0));
            let rates = ranges.speeds.clone().map(|i| {
                let scale = self.y[i].abs().max(self.next_y[i].abs()).max(self.units[i]);
                sum(&|rates| rates.y[i]) / scale
            });
            let error = local.chain(rates).fold(0.0, f64::max);
            if error > worst.0 {
                worst = (error, index);
            }
        }
        worst
    }

    /// Makes the step just tried the state, recentred: ϕ is 0 there.
    pub(super) fn accept(&mut self, flow: &mut Flow<'_>, time: f64) -> Result<(), StepFailure> {
        retract(
            &flow.mechanism,
            &self.configuration,
            &self.phi,
            &mut self.next_configuration,
        );
        for body in flow.mechanism.bodies() {
            let own = &mut self.next_configuration[body.ranges().configuration.clone()];
            let projected = body.joint().project(own);
            projected.map_err(|cause| body.finite_map(cause))?;
        }
        let (old, new) = (&self.configuration, &self.next_configuration);
        self.residue.keep(&flow.mechanism, old, new, &self.phi);
        core::mem::swap(&mut self.residue.y, &mut self.next_residue);
        core::mem::swap(&mut self.configuration, &mut self.next_configuration);
        core::mem::swap(&mut self.y, &mut self.next_y);
        flow.turn_maps(&self.configuration, &mut self.turn_maps);
        if !self.tableau.first_same_as_last {
            return self.evaluate_state(flow, time);
        }
        // The last stage was taken here; ϕ̇ alone belongs to the old base point.
        let last = self.stages.len() - 1;
        self.stages.swap(0, last);
        self.phi.fill(0.0);
        flow.recentre(&self.configuration, &self.phi, &mut self.stages[0]);
        Ok(())
    }

    /// Rates at the state with ϕ = 0: stage 0 of the next step.
    fn evaluate_state(&mut self, flow: &mut Flow<'_>, time: f64) -> Result<(), StepFailure> {
        self.phi.fill(0.0);
        flow.evaluate(
            time,
            &self.configuration,
            &self.phi,
            &self.y,
            &mut self.stages[0],
        )?;
        check_finite(flow, &self.stages[0])
    }

    /// Largest rate at the state, in the units of the error estimate, 1/s.
    pub(super) fn pace(&self) -> f64 {
        let rates = &self.stages[0];
        let local = rates.phi.iter().map(|rate| rate.abs());
        let others = rates.y.iter().zip(&self.y).zip(&self.units);
        let others = others.map(|((rate, y), unit)| rate.abs() / y.abs().max(*unit));
        local.chain(others).fold(0.0, f64::max)
    }

    /// ϕ and y after `step · Σ weights · rates`, from what the last step left over on.
    fn combine(&mut self, step: f64, weights: &[f64]) {
        self.phi.copy_from_slice(&self.residue.phi);
        self.next_residue.copy_from_slice(&self.residue.y);
        for (&weight, rates) in weights.iter().zip(&self.stages) {
            if weight == 0.0 {
                continue;
            }
            add(&mut self.phi, step * weight, &rates.phi);
            add(&mut self.next_residue, step * weight, &rates.y);
        }
        let sums = self.next_y.iter_mut().zip(&mut self.next_residue);
        for (&y, (sum, change)) in self.y.iter().zip(sums) {
            (*sum, *change) = add_exactly(y, *change);
        }
    }

    /// Refuses what is not finite, and rotations beyond π where the differential of Φ ends near a full turn. Angles about one
    /// axis add up, so that no step is too long for them.
    fn check_motion(&self, flow: &Flow<'_>) -> Result<(), StepFailure> {
        for body in flow.mechanism.bodies() {
            let ranges = body.ranges();
            let phi = &self.phi[ranges.freedoms.clone()];
            let y = &self.next_y[ranges.speeds.clone()];
            if phi.iter().chain(y).any(|value| !value.is_finite()) {
                return Err(not_finite(body));
            }
            if body.joint().structures().retract_differential.is_identity() {
                continue;
            }
            let mut turn = [0.0; 3];
            let own = 3 * ranges.freedoms.start..3 * ranges.freedoms.end;
            multiply(&self.turn_maps[own], phi, &mut turn);
            let square: f64 = turn.iter().map(|entry| entry * entry).sum();
            if square > PI * PI {
                return Err(StepFailure::Turn {
                    joint: body.joint_name().into(),
                    angle: num_traits::Float::sqrt(square),
                });
            }
        }
        Ok(())
    }
}

fn check_finite(flow: &Flow<'_>, rates: &Rates) -> Result<(), StepFailure> {
    for body in flow.mechanism.bodies() {
        let ranges = body.ranges();
        let phi = &rates.phi[ranges.freedoms.clone()];
        let y = &rates.y[ranges.speeds.clone()];
        if phi.iter().chain(y).any(|value| !value.is_finite()) {
            return Err(not_finite(body));
        }
    }
    Ok(())
}

fn not_finite(body: &Body) -> StepFailure {
    StepFailure::NotFinite {
        joint: body.joint_name().into(),
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
