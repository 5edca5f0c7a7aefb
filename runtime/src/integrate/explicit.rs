//! One step of an explicit method in (ϕ, y).

use super::flow::{Flow, Rates};
use super::standing::Standing;
use super::stepper::{Span, Stepper};
use super::{Estimate, StepFailure, Tableau};
use alloc::vec::Vec;

/// An explicit Runge–Kutta method.
pub(super) struct Explicit {
    tableau: &'static Tableau,
    /// Rates at the stages from the second on; those of the first are the state's.
    stages: Vec<Rates>,
}

impl Explicit {
    /// `is_controlled` tells whether errors of steps will be asked for.
    pub(super) fn new(tableau: &'static Tableau, is_controlled: bool, flow: &Flow<'_>) -> Self {
        let stages = 1..stages_taken(tableau, is_controlled);
        Self {
            tableau,
            stages: stages.map(|_| flow.new_rates()).collect(),
        }
    }

    /// Moves to `step · Σ weights · rates` from the state.
    fn combine(
        &self,
        standing: &mut Standing,
        flow: &Flow<'_>,
        step: f64,
        weights: &[f64],
    ) -> Result<(), StepFailure> {
        standing.move_by(flow, |first, phi, y| {
            let stages = core::iter::once(first).chain(&self.stages);
            for (&weight, rates) in weights.iter().zip(stages) {
                if weight != 0.0 {
                    rates.add_to(step * weight, phi, y);
                }
            }
        })
    }

    /// The largest entry of `unit · Σ weights · rates` as [`Standing::largest_error`] has it.
    fn largest(
        &self,
        standing: &mut Standing,
        flow: &mut Flow<'_>,
        unit: f64,
        weights: &[f64],
    ) -> Result<(f64, usize), StepFailure> {
        let (errors, first) = standing.errors();
        let sum = |entries: fn(&Rates) -> &[f64], errors: &mut [f64]| {
            let stages = || core::iter::once(first).chain(&self.stages).map(entries);
            sum_errors(weights, stages, unit, errors);
        };
        sum(|rates| &rates.phi, &mut errors.phi);
        sum(|rates| &rates.y, &mut errors.y);
        let last = self.stages.last();
        standing.largest_error(flow, last.map(|rates| &*rates.speeds))
    }
}

impl Stepper for Explicit {
    fn attempt(
        &mut self,
        standing: &mut Standing,
        flow: &mut Flow<'_>,
        Span { time, step }: Span,
    ) -> Result<(), StepFailure> {
        let tableau = self.tableau;
        for i in 1..=self.stages.len() {
            self.combine(standing, flow, step, tableau.matrix[i])?;
            let at = time + step * tableau.nodes[i];
            standing.evaluate_there(flow, at, &mut self.stages[i - 1])?;
        }
        if tableau.first_same_as_last {
            return Ok(());
        }
        self.combine(standing, flow, step, tableau.weights)
    }

    fn error(
        &mut self,
        standing: &mut Standing,
        flow: &mut Flow<'_>,
        Span { step, .. }: Span,
        tolerance: f64,
    ) -> Result<(f64, usize), StepFailure> {
        let unit = step / tolerance;
        match self.tableau.estimate {
            Estimate::None => Ok((0.0, 0)),
            Estimate::One(weights) => self.largest(standing, flow, unit, weights),
            Estimate::Pair { fifth, third } => {
                let (fifth, joint) = self.largest(standing, flow, unit, fifth)?;
                let (third, _) = self.largest(standing, flow, unit, third)?;
                Ok((paired(fifth, third), joint))
            }
        }
    }

    fn accept(
        &mut self,
        standing: &mut Standing,
        flow: &mut Flow<'_>,
        time: f64,
        _span: Span,
    ) -> Result<(), StepFailure> {
        let last = self.stages.last_mut();
        let last = last.filter(|_| self.tableau.first_same_as_last);
        standing.accept(flow, time, last)
    }

    fn order(&self) -> u32 {
        self.tableau.order
    }
}

/// The stages that a step evaluates: the last ones of some methods are for the estimate alone.
fn stages_taken(tableau: &Tableau, is_controlled: bool) -> usize {
    let all = tableau.nodes.len();
    if is_controlled || tableau.first_same_as_last {
        return all;
    }
    let last = tableau.weights.iter().rposition(|&weight| weight != 0.0);
    last.map_or(all, |last| last + 1)
}

/// `unit · Σ weights · rates` into `errors`.
fn sum_errors<'a, I: Iterator<Item = &'a [f64]>>(
    weights: &[f64],
    stages: impl Fn() -> I,
    unit: f64,
    errors: &mut [f64],
) {
    for (i, error) in errors.iter_mut().enumerate() {
        let (mut sum, mut size) = (0.0_f64, 0.0);
        for (weight, rates) in weights.iter().zip(stages()) {
            let term = weight * rates[i];
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

/// The estimate of [`Estimate::Pair`]; NaN where a difference is.
fn paired(fifth: f64, third: f64) -> f64 {
    let norm = num_traits::Float::hypot(fifth, 0.1 * third);
    if fifth == 0.0 {
        0.0
    } else {
        fifth * (fifth / norm)
    }
}
