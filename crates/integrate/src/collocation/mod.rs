//! One step of an implicit method by collocation, in (ϕ, y).
//!
//! The increments Z of all stages over the state solve `Z = h A F(Z)`. Methods without step control, and the discrete gradient, are iterated until rounding stops them
//! (E. Hairer, R. I. McLachlan and A. Razakarivony, *Achieving Brouwer's law with implicit Runge–Kutta methods*, 2008): by fixed points while
//! these converge fast, and by Newton's method from then on. The first guess continues the polynomial of the step before.

mod coefficients;
mod dense;
mod estimate;
mod forces;
mod iteration;
mod modes;
mod newton;
mod quadrature;
mod tree;

pub(super) use coefficients::{Coefficients, GAUSS_2, GAUSS_3, MIDPOINT, RADAU_5};

use super::StepFailure;
use super::discrete_gradient::Correction;
use super::flow::{Flow, Rates};
use super::step_state::StepState;
use super::stepper::{Solves, Span, StagePolynomial, Stepper};
use alloc::vec;
use alloc::vec::Vec;
use forces::Forces;
use newton::Newton;

/// The contraction from which on Newton's method takes less work than fixed points, and J has become too old.
const SLOW: f64 = 0.3;

/// The same under step control, where few digits are asked for: RADAU5's.
const SLOW_CONTROLLED: f64 = 1e-3;

/// A collocation method at work.
pub(super) struct Collocation {
    method: &'static Coefficients,
    /// The tolerance, where as much of a step may be left unsolved as it allows; `None` to iterate to rounding.
    tolerance: Option<f64>,
    freedoms: usize,
    /// Z_i: ϕ, then y.
    increments: Vec<Vec<f64>>,
    /// Residuals, and the changes that come of them.
    changes: Vec<Vec<f64>>,
    stages: Vec<Rates>,
    /// The sizes of the change before, of all stages.
    sizes: Vec<f64>,
    /// What one unit of each speed adds to y; empty before the first step.
    units: Vec<f64>,
    newton: Option<Newton>,
    /// For a method that is for stiff mechanisms.
    forces: Option<Forces>,
    before: Before,
    /// How the last iteration contracted.
    contraction: f64,
    estimate: Vec<f64>,
    /// The rates that the estimate is made with, and Q there.
    probe: Rates,
    here: Vec<f64>,
    solves: Solves,
    /// What makes the midpoint rule keep the energy.
    correction: Option<Correction>,
}

/// The increments of the step before.
struct Before {
    increments: Vec<Vec<f64>>,
    /// Its length; 0 where there is none in the same charts.
    step: f64,
}

impl Collocation {
    pub(super) fn new(
        method: &'static Coefficients,
        tolerance: Option<f64>,
        flow: &Flow<'_>,
    ) -> Self {
        let layout = flow.mechanism.layout();
        let size = layout.freedoms + layout.speeds;
        let increments = vec![vec![0.0; size]; method.nodes.len()];
        let is_stiff = method.estimate.is_some();
        Self {
            tolerance,
            freedoms: layout.freedoms,
            changes: increments.clone(),
            stages: vec![flow.new_rates(); method.nodes.len()],
            sizes: vec![0.0; method.nodes.len() * size],
            units: Vec::new(),
            newton: is_stiff.then(|| Newton::new(method, flow)),
            forces: is_stiff.then(|| Forces::new(method.matrix, flow)).flatten(),
            before: Before {
                increments: increments.clone(),
                step: 0.0,
            },
            contraction: 0.0,
            estimate: vec![0.0; size],
            probe: flow.new_rates(),
            here: Vec::new(),
            increments,
            solves: Solves::default(),
            correction: None,
            method,
        }
    }

    /// The midpoint rule with the correction that makes it a discrete-gradient method.
    pub(super) fn energy_keeping(flow: &Flow<'_>) -> Self {
        Self {
            correction: Some(Correction::new(flow)),
            ..Self::new(&MIDPOINT, None, flow)
        }
    }

    /// Moves to the end of the step.
    fn finish(
        &self,
        step_state: &mut StepState,
        flow: &Flow<'_>,
        step: f64,
    ) -> Result<(), StepFailure> {
        let Coefficients {
            weights,
            rests,
            ends,
            ..
        } = self.method;
        if self.newton.is_some() {
            // F of a stiff mechanism is its increments' rounding, many times over.
            let terms = ends.iter().zip(&self.increments);
            return step_state
                .move_by_increments(flow, terms.map(|(weight, own)| (*weight, own.as_slice())));
        }
        step_state.move_by(flow, |_, phi, y| {
            for ((weight, rest), rates) in weights.iter().zip(*rests).zip(&self.stages) {
                for part in [rest, weight] {
                    rates.add_to(step * part, phi, y);
                }
            }
        })
    }

    fn slow(&self) -> f64 {
        match self.tolerance {
            Some(_) => SLOW_CONTROLLED,
            None => SLOW,
        }
    }
}

impl Stepper for Collocation {
    fn attempt(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        span: Span,
    ) -> Result<(), StepFailure> {
        if self.units.is_empty() {
            self.units = flow.units(&step_state.configuration)?;
        }
        loop {
            self.contraction = 0.0;
            let outcome = self.iterate(step_state, flow, span);
            let Err(cause) = outcome else {
                return self.finish(step_state, flow, span.step);
            };
            let extrapolates = core::mem::replace(&mut self.before.step, 0.0) > 0.0;
            match &mut self.newton {
                // What oscillates fast does not go on as the polynomial does.
                Some(newton) => {
                    if !extrapolates && !newton.doubt(flow, self.tolerance.is_some()) {
                        return Err(cause);
                    }
                }
                None => self.newton = Some(Newton::new(self.method, flow)),
            }
        }
    }

    fn allowed(&self, tolerance: f64) -> f64 {
        match &self.correction {
            Some(_) => quadrature::allowed(tolerance),
            None => estimate::allowed(tolerance),
        }
    }

    fn estimate_weight(&self) -> Option<f64> {
        self.correction.as_ref().map(|_| quadrature::WEIGHT)
    }

    fn unsolved_by_rounding(
        &mut self,
        step_state: &StepState,
        rounding: &mut [f64],
        step: f64,
    ) -> Option<(f64, usize)> {
        let (tolerance, newton) = (self.tolerance?, self.newton.as_mut()?);
        self.method.estimate?;
        newton.filter(rounding);
        let (row, size) = self.worst(rounding, step_state)?;
        Some((step * size / iteration::unsolved(tolerance), row))
    }

    fn error(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        span: Span,
        allowed: f64,
    ) -> Result<(f64, usize), StepFailure> {
        match &self.correction {
            Some(_) => self.compare_with_quadrature(step_state, flow, span, allowed),
            None => self.estimate_twice(step_state, flow, span, allowed),
        }
    }

    fn accept(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        time: f64,
        span: Span,
    ) -> Result<(), StepFailure> {
        let slow = self.slow();
        if let Some(newton) = &mut self.newton {
            newton.move_on(self.contraction, slow);
        }
        if let Some(correction) = &mut self.correction {
            correction.accept();
        }
        let moves = step_state.moves;
        step_state.accept(flow, time, None)?;
        core::mem::swap(&mut self.increments, &mut self.before.increments);
        self.before.step = if step_state.moves == moves {
            span.step
        } else {
            0.0
        };
        Ok(())
    }

    fn order(&self) -> u32 {
        match self.method.estimate {
            // The estimate of Radau IIA is of order 3.
            Some(_) => 4,
            // The error of a step itself.
            None => self.method.order + 1,
        }
    }

    fn stage_polynomial(&self) -> Option<StagePolynomial<'_>> {
        Some(StagePolynomial {
            nodes: self.method.nodes,
            increments: &self.before.increments,
            units: &self.units,
        })
    }

    fn solves(&self) -> Solves {
        self.solves
    }
}

/// The matrix of the iteration is singular in a row.
fn no_solution(flow: &Flow<'_>, row: usize) -> StepFailure {
    StepFailure::SingularIteration {
        joint: flow.row_name(row),
    }
}
