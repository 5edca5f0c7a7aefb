//! The error of a step, as RADAU5 estimates it.

use super::Collocation;
use crate::StepFailure;
use crate::flow::Flow;
use crate::step_state::{StepState, add};
use num_traits::Float;

impl Collocation {
    /// `h f + Σ e_i Z_i` with the f of the probe, filtered, into the errors of `step_state`.
    pub(super) fn estimate(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        (step, tolerance): (f64, f64),
    ) -> Result<(), StepFailure> {
        let (Some(newton), Some(weights)) = (&mut self.newton, self.method.estimate) else {
            return Ok(());
        };
        let estimate = &mut self.estimate;
        estimate.fill(0.0);
        let (phi, y) = estimate.split_at_mut(self.freedoms);
        self.probe.add_to(step, phi, y);
        for (weight, increment) in weights.iter().zip(&self.increments) {
            add(estimate, *weight, increment);
        }
        if let Some(forces) = self.forces.as_mut().filter(|forces| forces.matter()) {
            forces.transfer(
                flow,
                (&self.here, newton.place()),
                &mut estimate[self.freedoms..],
            )?;
        }
        newton.filter(estimate);
        step_state.set_errors(1.0 / tolerance, estimate);
        Ok(())
    }

    pub(super) fn judge(
        &self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
    ) -> Result<(f64, usize), StepFailure> {
        let last = self.stages.last().map(|rates| &*rates.speeds);
        step_state.largest_error(flow, last)
    }
}

/// What an estimate of order 3, of the fourth power of the step, may come to so that the error of a method of order 5 falls with the tolerance: the
/// step falls with its fifth root.
///
/// RADAU5 has `0.1 ε^(2/3)`, by which the error falls with ε^(5/6) alone. The factor leaves loose tolerances, 1e-4, the steps that they have there.
pub(super) fn of_estimate(tolerance: f64) -> f64 {
    0.3 * Float::powf(tolerance, 0.8)
}
