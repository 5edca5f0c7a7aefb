//! What a scheme does: one step, its error, and what it keeps for the next.

use super::collocation::{self, Collocation};
use super::commutator_free::CommutatorFree;
use super::explicit::Explicit;
use super::exponential::Exponential;
use super::flow::Flow;
use super::step_state::{StepState, add};
use super::{Scheme, StepFailure};
use alloc::boxed::Box;
use alloc::vec::Vec;

/// When a step begins, and how long it is, s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) time: f64,
    pub(super) step: f64,
}

/// A scheme at work on one mechanism.
pub(super) trait Stepper {
    /// Tries a step over `span` from the state; `step_state` comes to its end, its state stays as it is.
    fn attempt(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        span: Span,
    ) -> Result<(), StepFailure>;

    /// What the estimated error of a step may come to so that the error of the motion is in proportion to `tolerance`.
    fn allowed(&self, tolerance: f64) -> f64 {
        tolerance
    }

    /// Estimated error of the step just tried over what is `allowed`, and the joint that has it.
    fn error(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        span: Span,
        allowed: f64,
    ) -> Result<(f64, usize), StepFailure>;

    /// Makes the end of the step just tried the state, at `time`, which is the end of `span` up to rounding.
    fn accept(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        time: f64,
        _span: Span,
    ) -> Result<(), StepFailure> {
        step_state.accept(flow, time, None)
    }

    /// The root of the sum of squares of the weights that its estimate has, where it is a sum of rates that cancel: what rounding of these amounts to in it.
    fn estimate_weight(&self) -> Option<f64> {
        None
    }

    /// How rounding of the rates (ϕ̇, then ẏ) changes an implicit step under step control: the largest change, as a multiple of what the iteration may leave unsolved, and its
    /// row of (ϕ, y).
    fn unsolved_by_rounding(
        &mut self,
        _step_state: &StepState,
        _rounding: &mut [f64],
        _step: f64,
    ) -> Option<(f64, usize)> {
        None
    }

    /// The power of the step with which its estimated error falls.
    fn order(&self) -> u32;

    /// The polynomial of the stages of the step just accepted, for a scheme that has one.
    fn stage_polynomial(&self) -> Option<StagePolynomial<'_>> {
        None
    }

    /// The iterations made so far, for an implicit scheme.
    fn solves(&self) -> Solves {
        Solves::default()
    }
}

/// The polynomial in (ϕ, y) through the beginning of a step, all its stages and its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct StagePolynomial<'a> {
    /// c_i.
    pub(super) nodes: &'a [f64],
    /// What the stages add to the state at the beginning: ϕ, then y.
    pub(super) increments: &'a [Vec<f64>],
    /// What one unit of each speed adds to y.
    pub(super) units: &'a [f64],
}

impl StagePolynomial<'_> {
    /// Its slope by the part `tau` of the step.
    pub(super) fn slope(&self, tau: f64, slope: &mut [f64]) {
        slope.fill(0.0);
        for (i, increment) in self.increments.iter().enumerate() {
            add(slope, self.weight(i, tau), increment);
        }
    }

    /// The slope at `tau` of the polynomial that is 1 at node i, and 0 at 0 and at the others.
    fn weight(&self, i: usize, tau: f64) -> f64 {
        let own = self.nodes[i];
        // The linear factors: that of 0, and those of the other nodes.
        let root = |j: usize| if j == i { 0.0 } else { self.nodes[j] };
        let all = 0..self.nodes.len();
        let product = |left_out: usize| {
            let others = all.clone().filter(|j| *j != left_out);
            others
                .map(|j| (tau - root(j)) / (own - root(j)))
                .product::<f64>()
        };
        all.clone().map(|j| product(j) / (own - root(j))).sum()
    }
}

/// What it took to solve the equations of implicit steps.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Solves {
    pub(super) jacobians: usize,
    pub(super) factorizations: usize,
    pub(super) iterations: usize,
}

/// The stepper of a scheme; `tolerance` is that of the step control, if there is one, and `lands` whether nothing is asked for between the ends of steps.
pub(super) fn new(
    scheme: &Scheme,
    (tolerance, lands): (Option<f64>, bool),
    flow: &Flow<'_>,
) -> Box<dyn Stepper> {
    if let Some(tableau) = scheme.tableau() {
        return Box::new(Explicit::new(tableau, tolerance.is_some(), flow));
    }
    match scheme {
        Scheme::Midpoint => Box::new(Collocation::new(&collocation::MIDPOINT, tolerance, flow)),
        Scheme::Gauss2 => Box::new(Collocation::new(&collocation::GAUSS_2, tolerance, flow)),
        Scheme::Gauss3 => Box::new(Collocation::new(&collocation::GAUSS_3, tolerance, flow)),
        Scheme::Radau5 => Box::new(Collocation::new(&collocation::RADAU_5, tolerance, flow)),
        Scheme::Exponential => Box::new(Exponential::new(flow, lands)),
        Scheme::DiscreteGradient => Box::new(Collocation::energy_keeping(flow)),
        _ => Box::new(CommutatorFree::new(flow)),
    }
}
