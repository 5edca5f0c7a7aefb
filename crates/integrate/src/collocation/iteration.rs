//! The iteration for the increments of all stages.

use super::{Before, Collocation, SLOW};
use crate::StepFailure;
use crate::discrete_gradient::Correction;
use crate::flow::Flow;
use crate::step_state::{StepState, add};
use crate::stepper::Span;
use alloc::vec::Vec;
use hamel_runtime::mechanism::StateError;
use num_traits::Float;

/// Iterations after which a step is given up. Fixed points that contract by 0.5 need 52 of them.
const MOST_ITERATIONS: usize = 60;

/// What may be left unsolved of the equations of a step under step control, over `tolerance^(6/5)`: it must not show in the result, so it falls with the
/// sixth power of the step as the error of a method of order 5 does. At 1e-4 it is what RADAU5 leaves.
const UNSOLVED: f64 = 0.2;

/// Changes below this that no longer shrink are rounding's: far above what any regular system makes of it, far below any error allowed. As parts of the
/// increments, where these are small.
const STALLED: f64 = 1e-9;

/// Iterations without shrinking after which what is small alone is left to rounding: an energy that is not yet what it shall be, as λ and the
/// increments take turns, so that changes shrink by tenths over several iterations; changes that are not small beside small increments, which may
/// be the rounding of the state or a motion of that size.
const LINGERS: usize = 8;

/// Changes that come to less than this part of the least one so far still shrink.
const SHRINKS: f64 = 0.8;

impl Collocation {
    /// Increments to begin with.
    fn guess(&mut self, step_state: &StepState, step: f64) {
        let ratio = step / self.before.step;
        for (increment, node) in self.increments.iter_mut().zip(self.method.nodes) {
            if self.before.step > 0.0 {
                continued(&self.before, self.method.nodes, node * ratio, increment);
            } else {
                let (phi, y) = increment.split_at_mut(self.freedoms);
                // What is stiff does not go on as it begins.
                let weight = if self.newton.is_some() {
                    0.0
                } else {
                    step * node
                };
                for (part, rates) in [(phi, &step_state.rates.phi), (y, &step_state.rates.y)] {
                    part.fill(0.0);
                    add(part, weight, rates);
                }
            }
        }
    }

    /// Iterates until the increments stand.
    pub(super) fn iterate(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        span: Span,
    ) -> Result<(), StepFailure> {
        if let Some(newton) = &mut self.newton {
            newton.prepare(step_state, flow, span, &mut self.solves)?;
        }
        if let Some(correction) = &mut self.correction {
            correction.begin(step_state, flow)?;
        }
        if let Some(forces) = &mut self.forces {
            forces.begin();
        }
        self.guess(step_state, span.step);
        let allowed = unsolved(self.tolerance.unwrap_or(0.0));
        let pace = step_state.rates.phi.iter();
        let pace = pace.fold(0.0, |most: f64, rate| most.max(rate.abs()));
        let (mut last, mut least, mut idle) = (f64::INFINITY, f64::INFINITY, 0);
        self.sizes.fill(f64::INFINITY);
        for _ in 0..MOST_ITERATIONS {
            self.solves.iterations += 1;
            self.evaluate(step_state, flow, span)?;
            self.take_residuals(span.step);
            if let Some(forces) = &mut self.forces {
                forces.note(&self.changes);
            }
            if let Some(newton) = &mut self.newton {
                newton.solve(&mut self.changes);
            }
            let [size, whole] =
                [&self.changes, &self.increments].map(|all| self.largest(all, step_state));
            if let Some(forces) = &mut self.forces {
                forces.see(&self.changes, span.step * pace, allowed);
            }
            if let Some(correction) = &mut self.correction {
                correction.see(size, whole);
            }
            for (increment, change) in self.increments.iter_mut().zip(&self.changes) {
                add(increment, 1.0, change);
            }
            // The first change says nothing yet of how fast the next will shrink.
            let contraction = if last.is_finite() { size / last } else { 1.0 };
            let before = core::mem::replace(&mut self.contraction, contraction);
            match size < SHRINKS * least {
                true => (least, idle) = (size, 0),
                false => idle += 1,
            }
            let is_faint = size < STALLED * whole.min(1.0);
            let patience = if is_faint && self.is_settled() {
                2
            } else {
                LINGERS
            };
            let stalled = size < STALLED && idle >= patience;
            // Without elements nothing is stiff, and the largest change tells enough.
            let left = match flow.mechanism.elements().is_empty() {
                false => self.note_sizes(step_state),
                true => 0.0,
            };
            if self.stands((size, whole), left, stalled) {
                return Ok(());
            }
            if size.is_nan() || (last.is_finite() && self.is_hopeless(size, whole, before)) {
                break;
            }
            last = size;
        }
        Err(self.no_convergence(step_state, flow))
    }

    /// What the entries that contract most slowly have left, each by its own contraction; the sizes of the change just made stand for the next look.
    ///
    /// The largest change is at first often that of what is stiff, which the matrix solves for at once, and says nothing of how the others contract.
    fn note_sizes(&mut self, step_state: &StepState) -> f64 {
        let mut known = core::mem::take(&mut self.sizes);
        let changes = self.changes.iter();
        let sizes = changes.flat_map(|change| self.sizes_of(change, step_state));
        let mut most = 0.0_f64;
        for (before, size) in known.iter_mut().zip(sizes) {
            let left = match size < *before {
                true => size * size / (*before - size),
                false => size,
            };
            *before = size;
            most = most.max(left);
        }
        self.sizes = known;
        most
    }

    /// Whether the change just made was the last one needed.
    fn stands(&self, (size, whole): (f64, f64), slowest: f64, stalled: bool) -> bool {
        let contraction = self.contraction;
        let left = size * contraction / (1.0 - contraction);
        match self.tolerance {
            _ if size == 0.0 => self.is_settled() || stalled,
            Some(tolerance) => contraction < 1.0 && left.max(slowest) <= unsolved(tolerance),
            // The next change would be lost in rounding; or rounding has stopped them.
            None if stalled => true,
            None => match &self.correction {
                None => contraction < 0.5 && left < 0.05 * f64::EPSILON,
                // Work was counted before this change, and adds up.
                Some(correction) => {
                    correction.is_settled() && size < 4.0 * f64::EPSILON * whole.min(1.0)
                }
            },
        }
    }

    /// Whether nothing but the increments is left to iterate: λ changes by itself.
    fn is_settled(&self) -> bool {
        self.correction.as_ref().is_none_or(Correction::is_settled)
    }

    fn is_hopeless(&self, size: f64, whole: f64, before: f64) -> bool {
        match self.newton {
            // Rounding may be all that is left.
            _ if self.tolerance.is_none() && size < STALLED * whole.min(1.0) => false,
            Some(_) if self.tolerance.is_none() && size < STALLED => false,
            // Step control had better try a shorter step; the correction for the energy may upset one iteration.
            Some(_) => {
                self.contraction.min(if self.tolerance.is_some() {
                    1.0
                } else {
                    before
                }) >= 0.99
            }
            // Newton's method does better.
            None => self.contraction > SLOW && before > SLOW,
        }
    }

    /// F at all stages.
    fn evaluate(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        span: Span,
    ) -> Result<(), StepFailure> {
        let Span { time, step } = span;
        let mut forces = self.forces.as_mut().filter(|forces| forces.matter());
        let stages = self.stages.iter_mut().zip(&self.increments).enumerate();
        for ((i, (rates, increment)), node) in stages.zip(self.method.nodes) {
            step_state.move_by_increment(flow, increment)?;
            step_state.evaluate_there(flow, time + step * node, rates.parts())?;
            if let (Some(forces), Some(newton)) = (&mut forces, &self.newton) {
                self.here.clear();
                self.here.extend_from_slice(flow.configuration());
                let places = (&*self.here, newton.place());
                let increments = (&*self.increments, step);
                forces.weigh(flow, (i, &mut *rates), places, increments)?;
            }
            if let Some(correction) = &mut self.correction {
                correction.apply(step_state, flow, span, increment, rates)?;
            }
        }
        Ok(())
    }

    /// `h A F − Z`.
    fn take_residuals(&mut self, step: f64) {
        let rows = self.method.matrix.iter().zip(&self.increments);
        for (change, (row, increment)) in self.changes.iter_mut().zip(rows) {
            change.fill(0.0);
            let (phi, y) = change.split_at_mut(self.freedoms);
            for (weight, rates) in row.iter().zip(&self.stages) {
                rates.add_to(step * weight, phi, y);
            }
            add(change, -1.0, increment);
        }
    }

    /// The sizes of a change: in radians and metres, then as parts of max(1, |v̄|).
    fn sizes_of<'a>(
        &'a self,
        change: &'a [f64],
        step_state: &'a StepState,
    ) -> impl Iterator<Item = f64> + 'a {
        let (phi, y) = change.split_at(self.freedoms);
        let units = self.units.iter().zip(&step_state.rates.speeds);
        let rates = y
            .iter()
            .zip(units)
            .map(|(y, (unit, speed))| y / (unit * speed.abs().max(1.0)));
        phi.iter().copied().chain(rates).map(f64::abs)
    }

    /// The row of a change with the largest size, and the size.
    pub(super) fn worst(&self, change: &[f64], step_state: &StepState) -> Option<(usize, f64)> {
        let sizes = self.sizes_of(change, step_state).enumerate();
        sizes.max_by(|(_, a), (_, b)| a.total_cmp(b))
    }

    /// The largest size of changes or increments; NaN where one is.
    fn largest(&self, changes: &[Vec<f64>], step_state: &StepState) -> f64 {
        let sizes = changes
            .iter()
            .flat_map(|change| self.sizes_of(change, step_state));
        // A NaN stays.
        sizes.fold(0.0, |most, size| match size > most || size.is_nan() {
            true => size,
            false => most,
        })
    }

    /// The joint that changed most in the last iteration.
    fn no_convergence(&self, step_state: &StepState, flow: &Flow<'_>) -> StepFailure {
        let mut worst = (0, 0.0);
        for change in &self.changes {
            for (row, size) in self.sizes_of(change, step_state).enumerate() {
                if !size.is_finite() {
                    return StepFailure::State(StateError::NoValue {
                        joint: flow.row_name(row),
                        what: "iteration",
                    });
                }
                if size > worst.1 {
                    worst = (row, size);
                }
            }
        }
        StepFailure::NoConvergence {
            joint: flow.row_name(worst.0),
            change: worst.1,
            contraction: self.contraction,
        }
    }
}

/// What may be left unsolved of a step's equations under step control; some roundings at least.
pub(super) fn unsolved(tolerance: f64) -> f64 {
    (UNSOLVED * Float::powf(tolerance, 1.2)).max(10.0 * f64::EPSILON)
}

/// Increments at `node` (in steps) beyond the end of the step before, by its polynomial through 0 and all stages.
fn continued(before: &Before, nodes: &[f64], node: f64, increment: &mut [f64]) {
    increment.fill(0.0);
    for (i, values) in before.increments.iter().enumerate() {
        let weight = lagrange(nodes, i, 1.0 + node) - lagrange(nodes, i, 1.0);
        add(increment, weight, values);
    }
}

/// The polynomial that is 1 at node i, and 0 at 0 and at the others.
fn lagrange(nodes: &[f64], i: usize, at: f64) -> f64 {
    let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
    let factors = others.map(|(_, node)| (at - node) / (nodes[i] - node));
    factors.product::<f64>() * at / nodes[i]
}
