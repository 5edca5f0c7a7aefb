//! One step of an explicit method in (ϕ, y).

use super::flow::Flow;
use super::stages::{Stages, Terms, terms};
use super::step_state::StepState;
use super::stepper::{Span, Stepper};
use super::{Estimate, StepFailure, Tableau};
use alloc::vec::Vec;
use num_traits::Float;

/// An explicit Runge–Kutta method.
pub(super) struct Explicit {
    tableau: &'static Tableau,
    /// What leads to each stage that is evaluated, of the rows of the matrix.
    paths: Vec<Terms>,
    /// What leads to the end.
    end: Terms,
    estimate: Combined,
    stages: Stages,
}

/// [`Estimate`] without the weights that are 0.
enum Combined {
    None,
    One(Terms),
    Pair { fifth: Terms, third: Terms },
}

impl Explicit {
    /// `is_controlled` tells whether errors of steps will be asked for.
    pub(super) fn new(tableau: &'static Tableau, is_controlled: bool, flow: &Flow<'_>) -> Self {
        let count = stages_taken(tableau, is_controlled);
        let rows = tableau.matrix.iter().take(count);
        Self {
            tableau,
            paths: rows.map(|row| terms(row)).collect(),
            end: terms(tableau.weights),
            estimate: match tableau.estimate {
                Estimate::None => Combined::None,
                Estimate::One(weights) => Combined::One(terms(weights)),
                Estimate::Pair { fifth, third } => Combined::Pair {
                    fifth: terms(fifth),
                    third: terms(third),
                },
            },
            stages: Stages::new(count, &flow.mechanism),
        }
    }
}

impl Stepper for Explicit {
    fn attempt(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        Span { time, step }: Span,
    ) -> Result<(), StepFailure> {
        let Self {
            tableau,
            paths,
            end,
            stages,
            ..
        } = self;
        stages.begin(&step_state.rates);
        for (i, path) in paths.iter().enumerate().skip(1) {
            step_state.move_by_increment(flow, stages.sum(step, path))?;
            step_state.evaluate_there(flow, time + step * tableau.nodes[i], stages.room(i))?;
        }
        if tableau.first_same_as_last {
            return Ok(());
        }
        step_state.move_by_increment(flow, stages.sum(step, end))
    }

    fn error(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        Span { step, .. }: Span,
        tolerance: f64,
    ) -> Result<(f64, usize), StepFailure> {
        let Self {
            estimate, stages, ..
        } = self;
        let mut largest = |weights: &Terms| {
            let errors = stages.sum_beyond_rounding(step, weights);
            step_state.set_errors(1.0 / tolerance, errors);
            step_state.forget_scatter(step / tolerance);
            step_state.largest_error(flow, Some(stages.last_speeds()))
        };
        match estimate {
            Combined::None => Ok((0.0, 0)),
            Combined::One(weights) => largest(weights),
            Combined::Pair { fifth, third } => {
                let (fifth, joint) = largest(fifth)?;
                let (third, _) = largest(third)?;
                Ok((paired(fifth, third), joint))
            }
        }
    }

    fn accept(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        time: f64,
        _span: Span,
    ) -> Result<(), StepFailure> {
        let is_same = self.tableau.first_same_as_last;
        step_state.accept(flow, time, is_same.then(|| self.stages.last()))
    }

    fn estimate_weight(&self) -> Option<f64> {
        let norm = |weights: &Terms| {
            let squares = weights.iter().map(|(_, weight)| weight * weight);
            Float::sqrt(squares.sum::<f64>())
        };
        match &self.estimate {
            Combined::None => None,
            Combined::One(weights) => Some(norm(weights)),
            // Beside the estimate of order 3 it counts less.
            Combined::Pair { fifth, .. } => Some(norm(fifth) / 3.0),
        }
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

/// The estimate of [`Estimate::Pair`]; NaN where a difference is.
fn paired(fifth: f64, third: f64) -> f64 {
    let norm = Float::hypot(fifth, 0.1 * third);
    if fifth == 0.0 {
        0.0
    } else {
        fifth * (fifth / norm)
    }
}
