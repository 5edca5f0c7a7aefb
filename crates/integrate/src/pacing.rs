//! The length of steps: the first one, the next one to try, and what follows from one that fails.

use super::driver::Driver;
use super::fixed_steps::is_last;
use super::options::{StepControl, least_step};
use super::positions;
use super::prospect::{chosen_method, other_method};
use super::rates_of_loops::has_ends;
use super::rounding::Rounding;
use super::search::Search;
use super::step_control::StepController;
use super::stepper::Span;
use super::{IntegrateError, Method, Scheme, StepFailure};
use alloc::boxed::Box;
use alloc::format;
use alloc::string::String;
use num_traits::Float;

/// A remainder that exceeds a controlled step by less than this is taken at once: it saves a sliver of a step.
const CONTROLLED_STRETCH: f64 = 1.01;

/// How the next step is chosen.
pub(super) struct Pacing {
    /// The step to try where no sample time is in the way.
    pub(super) step: f64,
    /// The estimated error of the step tried last, over what is allowed; 0 without step control.
    pub(super) error: f64,
    pub(super) controller: StepController,
    pub(super) rounding: Rounding,
    /// Where a step of fixed size has failed: shorter ones, up to its end.
    pub(super) search: Option<Search>,
}

impl Driver<'_> {
    pub(super) fn pacing(&mut self) -> Result<Pacing, IntegrateError> {
        let order = self.stepper.order();
        let step = match self.options.method {
            Method::Fixed { dt, .. } => dt,
            Method::Controlled { control, .. } => {
                let first = control
                    .first_step
                    .map_or_else(|| self.first_step(control.tolerance, order), Ok);
                first?.min(control.max_step)
            }
        };
        Ok(Pacing {
            step,
            error: 0.0,
            controller: StepController::new(order),
            rounding: Rounding::new(&self.flow),
            search: None,
        })
    }

    /// A step over which the state changes by about `tolerance^(1/order)`.
    pub(super) fn first_step(&mut self, tolerance: f64, order: u32) -> Result<f64, IntegrateError> {
        let span = self.options.t_end - self.start;
        let change = 0.3 * Float::powf(tolerance, 1.0 / f64::from(order));
        let pace = self.step_state.pace(&mut self.flow);
        let pace = pace.map_err(|cause| self.at_state(cause))?;
        // A hundredth of the shortest spans is nothing: these are one step.
        Ok((change / pace).min(0.01 * span).max(f64::MIN_POSITIVE))
    }

    /// The step to try, and whether it ends on the target.
    pub(super) fn choose_step(&self, step: f64) -> (f64, bool) {
        let (step, lands) = self.step_to_target(step);
        if let Method::Fixed { .. } = self.options.method {
            return (step, lands);
        }
        let time = self.clock.time();
        let end = time + step;
        let motion = [self.start, self.options.t_end];
        let seen = self.flow.mechanism.end_before_pulse([time, end], motion);
        match seen < end && seen - time > least_step(time, end) {
            true => (seen - time, false),
            false => (step, lands),
        }
    }

    /// Counts a step of fixed size that does not see what acts as a function of time: a method of one stage sees it once a step.
    pub(super) fn count_unseen(&mut self, span: Span) {
        let mechanism = &self.flow.mechanism;
        if self.options.method.control().is_some() || !mechanism.changes_with_time() {
            return;
        }
        let from = span.time;
        let until = self.kinks.before(from + 2.0 * span.step);
        let motion = [self.start, self.options.t_end];
        if mechanism.end_before_pulse([from, until], motion) < until {
            self.statistics.unseen += 1;
        }
    }

    /// The same, however what acts changes with time.
    fn step_to_target(&self, step: f64) -> (f64, bool) {
        let (remaining, step) = (self.clock.until(self.target()), step.min(self.resolving));
        match self.options.method {
            Method::Fixed { .. } if is_last(remaining, step) => (remaining, true),
            Method::Fixed { .. } => (step, false),
            _ if remaining <= step * CONTROLLED_STRETCH => (remaining, true),
            // Two equal steps rather than a full one and a sliver.
            _ if remaining < 2.0 * step => (0.5 * remaining, false),
            _ => (step, false),
        }
    }

    pub(super) fn attempt(&mut self, pacing: &mut Pacing, step: f64) -> Result<(), StepFailure> {
        let span = Span {
            time: self.clock.time(),
            step,
        };
        let Self {
            stepper,
            step_state,
            flow,
            watch,
            ..
        } = self;
        let outcome = stepper
            .attempt(step_state, flow, span)
            .and_then(|()| watch.check(flow, step_state, span));
        let Some(StepControl {
            tolerance,
            max_step,
            ..
        }) = self.options.method.control()
        else {
            return outcome;
        };
        if let Err(cause) = outcome {
            if let StepFailure::NoConvergence { .. } = cause {
                self.statistics.unconverged += 1;
            }
            pacing.step = step * pacing.controller.reject(None);
            return Err(cause);
        }
        let least = stepper.allowed(tolerance);
        if let Some(weight) = stepper.estimate_weight()
            && pacing.rounding.is_due()
        {
            pacing.rounding.look(step_state, flow, span.time, weight);
        }
        let (error, joint) = match stepper.error(step_state, flow, span, least) {
            Ok(found) => found,
            Err(cause) => {
                pacing.step = step * pacing.controller.reject(None);
                return Err(cause);
            }
        };
        let allowed = pacing.rounding.allowed(step, least);
        let part = error / allowed;
        if part.is_nan() || part > 1.0 {
            pacing.rounding.refuse();
            pacing.step = step * pacing.controller.reject(Some(part));
            pacing.rounding.see(step, error);
            return Err(self.inaccurate(joint, error));
        }
        // Rounding takes the same share of the tolerance at any length of step. Near the end of a joint, relations amplify it beyond what was measured; steps would shrink without end.
        let is_of_relations = has_ends(self.flow.mechanism.bodies()[joint].joint());
        // Rounding of the time, where forces change with it, is less in a shorter step.
        if error > 1.0
            && !is_of_relations
            && self.flow.mechanism.changes_with_time()
            && !pacing.rounding.is_all(step, error, stepper.order())
        {
            pacing.rounding.see(step, error);
            pacing.step = step * pacing.controller.reject(Some(error));
            return Err(self.inaccurate(joint, error));
        }
        pacing.rounding.accept(error, joint, least);
        pacing.error = part;
        let factor = pacing.controller.accept(part);
        let factor = match allowed > 1.0 && is_of_relations {
            true => factor.max(1.0),
            false => factor,
        };
        let next = step * factor;
        // A step that was cut short to land says nothing against the step that was meant.
        let cut = step < pacing.step;
        pacing.step = if cut { next.max(pacing.step) } else { next }.min(max_step);
        Ok(())
    }

    fn inaccurate(&self, joint: usize, ratio: f64) -> StepFailure {
        StepFailure::Inaccurate {
            joint: self.flow.joint_name(joint),
            ratio,
        }
    }

    /// Ends the integration where no smaller step can help.
    pub(super) fn refuse(
        &self,
        pacing: &mut Pacing,
        step: f64,
        cause: StepFailure,
    ) -> Result<(), IntegrateError> {
        let cause = cause.of_relations(&self.flow.mechanism);
        let time = self.clock.time();
        if let Method::Fixed { dt, .. } = self.options.method {
            let advice = match self.advice_on_positions(&cause) {
                None if cause.is_of_length() => "take a smaller dt".into(),
                advice => advice.unwrap_or_default(),
            };
            let failure = IntegrateError::Step {
                time,
                step,
                cause: Box::new(cause.clone()),
                near: self.near(),
                advice,
            };
            if !cause.is_of_length() || !self.watch.knows_ends(&self.flow.mechanism) {
                return Err(failure);
            }
            pacing.step = 0.5 * step;
            (pacing.search).get_or_insert_with(|| Search::new(time + step, dt, failure));
        }
        // From where time does not move on; at time 0, where it always does, by what is nothing of the span.
        let span = self.options.t_end - self.start;
        let limit = least_step(time, f64::EPSILON * span);
        match pacing.step > limit {
            true => Ok(()),
            false => Err(self.underflow(pacing, limit, cause)),
        }
    }

    /// Why steps have become as short as they can be.
    fn underflow(&self, pacing: &Pacing, limit: f64, cause: StepFailure) -> IntegrateError {
        if let StepFailure::NotClosed { joint } | StepFailure::Excluded { joint, .. } = &cause
            && let Some(end) = self.watch.end_of(&self.flow.mechanism, joint, self.at())
        {
            return IntegrateError::Excluded(end);
        }
        if let Some(search) = &pacing.search {
            return search.failure();
        }
        let find = match cause {
            // Of a step that has no solution, the length is not to blame alone.
            StepFailure::NoConvergence { .. } => chosen_method,
            _ => other_method,
        };
        let advice = find(&self.flow, self.options, &self.state());
        let advice = advice.or_else(|| self.advice_on_positions(&cause));
        IntegrateError::StepUnderflow {
            time: self.clock.time(),
            step: pacing.step,
            limit,
            cause: Box::new(cause),
            near: self.near(),
            advice: advice.map_or_else(String::new, |advice| format!("; {advice}")),
        }
    }

    /// What to do about a step that is not solved, or that does not keep the energy, where rounding of positions may be the reason.
    fn advice_on_positions(&self, cause: &StepFailure) -> Option<String> {
        let is_implicit = match cause {
            StepFailure::NoConvergence { .. } => true,
            StepFailure::Inaccurate { .. } => self.scheme == Scheme::DiscreteGradient,
            _ => false,
        };
        is_implicit.then(|| positions::advice(&self.flow.mechanism, self.at().1))?
    }

    /// The first step of a piece of the motion.
    pub(super) fn pace_anew(&mut self, pacing: &mut Pacing) -> Result<(), IntegrateError> {
        if let Some(control) = self.options.method.control() {
            let first = self.first_step(control.tolerance, self.stepper.order())?;
            pacing.step = first.min(control.max_step);
        }
        Ok(())
    }
}
