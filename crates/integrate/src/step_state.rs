//! Where a step begins, and where the step being tried ends: what all schemes share.

use super::StepFailure;
use super::compensation::{Compensation, add_exactly};
use super::dense::Instant;
use super::flow::{Flow, Rates, RatesMut, retract};
use super::nearby::{Nearby, Place};
use super::rates_of_loops::{RatesOfLoops, has_ends};
use super::turns::Turns;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::erased::AnyJoint;

/// The ϕ from which on a joint gets a new base point. Each of them costs one rounding of Q, which a base at every step would
/// cost at every step; from a half on, ϕ bends more than most steps do.
const FAR: f64 = 0.5;

/// The change of what vanishes where a joint ends, as a part of its value at the base point, from which on a joint gets a new base point if relations alone give
/// its Φ: Newton's method finds Φ from the base point, and not past such an end.
const NEARER: f64 = 0.2;

/// Whether a joint at `configuration`, which is Φ(`base`, `phi`), gets a new base point.
fn is_far(joint: &dyn AnyJoint, base: &[f64], configuration: &[f64], phi: &[f64]) -> bool {
    let is_nearer = || {
        let there = joint.singularity(base);
        (joint.singularity(configuration) - there).abs() > NEARER * there
    };
    phi.iter().any(|entry| entry.abs() > FAR) || has_ends(joint) && is_nearer()
}

/// The state at the last accepted step, and the end of the one being tried.
#[derive(Clone, Debug)]
pub(super) struct StepState {
    /// Q at the state: `Φ(base, offset)`.
    pub(super) configuration: Vec<f64>,
    /// y at the state.
    pub(super) y: Vec<f64>,
    /// The points around which ϕ is measured.
    pub(super) base: Vec<f64>,
    /// ϕ at the state.
    pub(super) offset: Vec<f64>,
    /// The sum of ϕ over the base points before these, from the beginning of the motion.
    pub(super) passed: Vec<f64>,
    /// Rates at the state, always.
    pub(super) rates: Rates,
    /// ϕ at the point that a step has come to: a stage, or its end.
    pub(super) phi: Vec<f64>,
    /// y there.
    pub(super) next_y: Vec<f64>,
    /// What ϕ and y are too coarse to hold.
    compensation: Compensation,
    next_compensation: Compensation,
    /// Estimated errors of ϕ and y, and what they amount to in v̄.
    errors: Rates,
    nearby: Nearby,
    /// What errors of a loop's ϕ and v̄ make of its dependent coordinates.
    loops: RatesOfLoops,
    /// What of an estimated error of ϕ is the rounding of v̄ = M̄⁻¹ p̄, over the length of a step, 1/s; 0 in the Lagrangian form, which has v̄ itself.
    scatter: Vec<f64>,
    /// How far each joint turns from its base point.
    turns: Turns,
    /// How often base points have moved.
    pub(super) moves: usize,
}

impl StepState {
    pub(super) fn new(
        flow: &mut Flow<'_>,
        time: f64,
        configuration: &[f64],
        speeds: &[f64],
    ) -> Result<Self, StepFailure> {
        flow.mechanism.check_poses(configuration)?;
        flow.mechanism.check_speeds("speeds", speeds)?;
        let mut speeds = speeds.to_vec();
        let moment = flow.moment(time);
        flow.mechanism.prescribe_speeds(moment, &mut speeds);
        let y = flow.initial(configuration, &speeds)?;
        let freedoms = flow.mechanism.layout().freedoms;
        let mut step_state = Self {
            configuration: configuration.to_vec(),
            base: configuration.to_vec(),
            offset: vec![0.0; freedoms],
            passed: vec![0.0; freedoms],
            rates: flow.new_rates(),
            phi: vec![0.0; freedoms],
            next_y: y.clone(),
            compensation: Compensation::new(&flow.mechanism),
            next_compensation: Compensation::new(&flow.mechanism),
            errors: flow.new_rates(),
            nearby: Nearby::new(flow),
            loops: RatesOfLoops::new(&flow.mechanism),
            scatter: vec![0.0; freedoms],
            turns: Turns::new(&flow.mechanism),
            moves: 0,
            y,
        };
        step_state.evaluate(flow, time)?;
        step_state.turns.set(&flow.mechanism, configuration);
        Ok(step_state)
    }

    /// v̄ at the state.
    pub(super) fn speeds(&self) -> &[f64] {
        &self.rates.speeds
    }

    /// The state, at `time`.
    pub(super) fn instant(&self, time: f64) -> Instant<'_> {
        Instant {
            time,
            configuration: &self.configuration,
            speeds: self.speeds(),
            y: &self.y,
            base: &self.base,
            passed: &self.passed,
            phi: &self.offset,
        }
    }

    /// Rates at the state.
    pub(super) fn evaluate(&mut self, flow: &mut Flow<'_>, time: f64) -> Result<(), StepFailure> {
        let rates = self.rates.parts();
        flow.evaluate(time, &self.base, &self.offset, &self.y, rates)
    }

    /// Rates at the point that the step has come to.
    pub(super) fn evaluate_there(
        &self,
        flow: &mut Flow<'_>,
        time: f64,
        rates: RatesMut<'_>,
    ) -> Result<(), StepFailure> {
        flow.evaluate(time, &self.base, &self.phi, &self.next_y, rates)
    }

    /// Moves the point to the state and what `add` adds to it in ϕ and y, from what the last step left over on.
    pub(super) fn move_by(
        &mut self,
        flow: &Flow<'_>,
        add: impl FnOnce(&Rates, &mut [f64], &mut [f64]),
    ) -> Result<(), StepFailure> {
        let Compensation { phi, y } = &mut self.next_compensation;
        phi.copy_from_slice(&self.compensation.phi);
        y.copy_from_slice(&self.compensation.y);
        add(&self.rates, phi, y);
        add_all_exactly(&self.offset, &mut self.phi, phi);
        add_all_exactly(&self.y, &mut self.next_y, y);
        self.turns.check(&flow.mechanism, &self.phi, &self.next_y)
    }

    /// Refuses a ϕ that turns a joint too far: of one that has been composed, where Φ and its inverse tell rotations within half a turn alone.
    pub(super) fn check_turns(&self, flow: &Flow<'_>, phi: &[f64]) -> Result<(), StepFailure> {
        self.turns.check(&flow.mechanism, phi, &self.next_y)
    }

    /// Moves the point to the state and one increment, ϕ first and then y.
    pub(super) fn move_by_increment(
        &mut self,
        flow: &Flow<'_>,
        increment: &[f64],
    ) -> Result<(), StepFailure> {
        let (turned, pushed) = increment.split_at(self.offset.len());
        let (rest, lost) = (&self.compensation, &mut self.next_compensation);
        let parts = [
            (
                &self.offset,
                turned,
                &rest.phi,
                &mut self.phi,
                &mut lost.phi,
            ),
            (&self.y, pushed, &rest.y, &mut self.next_y, &mut lost.y),
        ];
        for (start, change, rest, sum, lost) in parts {
            let terms = start.iter().zip(change).zip(rest);
            for (((&start, change), rest), (sum, lost)) in terms.zip(sum.iter_mut().zip(lost)) {
                (*sum, *lost) = add_exactly(start, change + rest);
            }
        }
        self.turns.check(&flow.mechanism, &self.phi, &self.next_y)
    }

    /// Moves the point to the state and a weighted sum of increments, ϕ first and then y.
    pub(super) fn move_by_increments<'a>(
        &mut self,
        flow: &Flow<'_>,
        terms: impl Iterator<Item = (f64, &'a [f64])>,
    ) -> Result<(), StepFailure> {
        self.move_by(flow, |_, phi, y| {
            for (weight, increment) in terms {
                let (turned, pushed) = increment.split_at(phi.len());
                add(phi, weight, turned);
                add(y, weight, pushed);
            }
        })
    }

    /// Makes `weight` times `found`, ϕ first and then y, the estimate of the errors.
    pub(super) fn set_errors(&mut self, weight: f64, found: &[f64]) {
        let (turned, pushed) = found.split_at(self.offset.len());
        let Rates { phi, y, .. } = &mut self.errors;
        phi.fill(0.0);
        y.fill(0.0);
        add(phi, weight, turned);
        add(y, weight, pushed);
    }

    /// Takes differences of rates that rounding makes, of ϕ̇ and then of ẏ. In the Hamiltonian form those of ϕ̇ are taken out: they are no errors of Q that would count
    /// for v̄. `weight` is what of them an estimate may hold, `memory` what is left of older ones.
    pub(super) fn set_scatter(
        &mut self,
        flow: &Flow<'_>,
        (weight, memory): (f64, f64),
        differences: &mut [f64],
    ) {
        if flow.y_is_speeds() {
            return;
        }
        for (scatter, difference) in self.scatter.iter_mut().zip(differences) {
            *scatter = (weight * difference.abs()).max(memory * *scatter);
            *difference = 0.0;
        }
    }

    /// Takes what rounding of ϕ̇ makes in a step over a tolerance out of the errors.
    pub(super) fn forget_scatter(&mut self, step: f64) {
        for (error, scatter) in self.errors.phi.iter_mut().zip(&self.scatter) {
            // What is not finite stays so.
            let beyond = error.abs() - step * scatter;
            *error = if beyond < 0.0 {
                0.0
            } else {
                beyond.copysign(*error)
            };
        }
    }

    /// The largest of the estimated errors, as parts of ϕ and v̄ or of 1, and the joint that has it; `last` are speeds at or near the end of
    /// the step, if the scheme has them.
    ///
    /// Errors of ϕ and p̄ count as what both do to v̄ as well: on a heavy body that carries a light one, the same p̄ is much more, and on a body that turns
    /// fast the same ϕ. Where relations alone give a joint's Φ, errors of its dependent coordinates count too: near an end of its motion they are many times those of ϕ
    /// and v̄.
    pub(super) fn largest_error(
        &mut self,
        flow: &mut Flow<'_>,
        last: Option<&[f64]>,
    ) -> Result<(f64, usize), StepFailure> {
        if let Some(index) = self.errors.first_infinite(&flow.mechanism) {
            return Ok((f64::INFINITY, index));
        }
        self.change_speeds(flow)?;
        let Self {
            phi,
            rates,
            errors,
            loops,
            configuration,
            ..
        } = self;
        let last = last.unwrap_or(&rates.speeds);
        let mut worst = (0.0, 0);
        for (index, body) in flow.mechanism.joints() {
            let (freedoms, speeds) = (body.ranges().freedoms.clone(), body.ranges().speeds.clone());
            // No sum resolves a part of a step that is longer than 1 better than relative to it.
            let local = freedoms.map(|i| part(errors.phi[i], phi[i].abs()));
            let sizes = |i: usize| rates.speeds[i].abs().max(last[i].abs());
            let rated = speeds.map(|i| part(errors.speeds[i], sizes(i)));
            let error = local.chain(rated).fold(0.0, f64::max);
            if error > worst.0 {
                worst = (error, index);
            }
        }
        let speeds = (&*errors.speeds, &*rates.speeds, last);
        let worst_of_loops =
            loops.largest_error(&flow.mechanism, configuration, &errors.phi, speeds);
        Ok(if worst_of_loops.0 > worst.0 {
            worst_of_loops
        } else {
            worst
        })
    }

    /// Makes the point that the step has come to the state; joints whose ϕ has grown get a new base point. `last` are ẏ and v̄ there, if the
    /// scheme has them already.
    pub(super) fn accept(
        &mut self,
        flow: &mut Flow<'_>,
        time: f64,
        last: Option<(&[f64], &[f64])>,
    ) -> Result<(), StepFailure> {
        core::mem::swap(&mut self.compensation, &mut self.next_compensation);
        core::mem::swap(&mut self.y, &mut self.next_y);
        self.offset.copy_from_slice(&self.phi);
        retract(
            &flow.mechanism,
            &self.base,
            &self.offset,
            &mut self.configuration,
        );
        // A joint may be beyond the range of numbers where its rates are not.
        flow.mechanism.check_poses(&self.configuration)?;
        self.recentre(flow)?;
        let drives = flow.mechanism.drives();
        for drive in drives {
            let own = flow.mechanism.bodies()[drive.body].ranges().speeds.clone();
            self.compensation.y[own].fill(0.0);
        }
        // Prescribed speeds are what their laws say, not what steps have made of them.
        let moment = flow.moment(time);
        flow.mechanism.prescribe_speeds(moment, &mut self.y);
        let Some((y, speeds)) = last.filter(|_| drives.is_empty()) else {
            return self.evaluate(flow, time);
        };
        // ϕ̇ belongs to the old base points.
        let rates = &mut self.rates;
        rates.y.copy_from_slice(y);
        rates.speeds.copy_from_slice(speeds);
        flow.recentre(&self.configuration, &self.base, &self.offset, rates);
        Ok(())
    }

    /// Moves the base point of every joint that is far from it to the state.
    fn recentre(&mut self, flow: &mut Flow<'_>) -> Result<(), StepFailure> {
        let mechanism = Arc::clone(&flow.mechanism);
        let mut moved = false;
        for (_, body) in mechanism.joints() {
            let (freedoms, own) = (&body.ranges().freedoms, &body.ranges().configuration);
            let (base, here) = (&self.base[own.clone()], &self.configuration[own.clone()]);
            if !is_far(body.joint(), base, here, &self.offset[freedoms.clone()]) {
                continue;
            }
            let (old, new) = (
                &mut self.base[own.clone()],
                &mut self.configuration[own.clone()],
            );
            let phi = &mut self.offset[freedoms.clone()];
            let passed = &mut self.passed[freedoms.clone()];
            let projected = body.joint().project(new);
            if projected.is_err() && has_ends(body.joint()) {
                // Next to an end all gradients of the relations may be nearly parallel, as where a parallelogram folds. Φ is on the relations without it.
                body.joint().retract(old, phi, new);
                continue;
            }
            projected.map_err(|cause| body.finite_map(cause))?;
            self.compensation.keep(body, old, new, phi);
            add(passed, 1.0, phi);
            old.copy_from_slice(new);
            phi.fill(0.0);
            moved = true;
        }
        if moved {
            self.moves += 1;
            self.turns.set(&mechanism, &self.base);
        }
        Ok(())
    }

    /// What the errors of ϕ and y at the state amount to in v̄.
    fn change_speeds(&mut self, flow: &mut Flow<'_>) -> Result<(), StepFailure> {
        let place = Place {
            base: &self.base,
            phi: &self.offset,
            y: &self.y,
            speeds: &self.rates.speeds,
        };
        self.nearby.change_speeds(flow, place, &mut self.errors)
    }

    /// v̄̇ at the state.
    pub(super) fn accelerations(&mut self, flow: &mut Flow<'_>) -> Result<&[f64], StepFailure> {
        self.errors.copy_from(&self.rates);
        self.change_speeds(flow)?;
        Ok(&self.errors.speeds)
    }

    /// Largest rate at the state, as [`StepState::largest_error`] measures it, 1/s.
    pub(super) fn pace(&mut self, flow: &mut Flow<'_>) -> Result<f64, StepFailure> {
        self.accelerations(flow)?;
        let (rates, accelerations) = (&self.rates, &self.errors.speeds);
        let local = rates.phi.iter().map(|rate| rate.abs());
        let others = accelerations.iter().zip(&rates.speeds);
        let others = others.map(|(rate, speed)| rate.abs() / speed.abs().max(1.0));
        Ok(local.chain(others).fold(0.0, f64::max))
    }
}

/// An error as a part of a size, or of 1 where that is more; infinite where it is not a number.
pub(super) fn part(error: f64, size: f64) -> f64 {
    match error.abs() / size.max(1.0) {
        part if part.is_nan() => f64::INFINITY,
        part => part,
    }
}

/// `start + change` into `sum`; what it lacks of the exact sums into `change`.
fn add_all_exactly(start: &[f64], sum: &mut [f64], change: &mut [f64]) {
    for ((&start, sum), change) in start.iter().zip(sum).zip(change) {
        (*sum, *change) = add_exactly(start, *change);
    }
}

/// Adds `weight · terms`.
pub(super) fn add(sum: &mut [f64], weight: f64, terms: &[f64]) {
    for (sum, term) in sum.iter_mut().zip(terms) {
        *sum += weight * term;
    }
}
