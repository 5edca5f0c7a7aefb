//! What a scheme does: one step, its error, and what it keeps for the next.

use super::collocation::{self, Collocation};
use super::commutator_free::CommutatorFree;
use super::explicit::Explicit;
use super::exponential::Exponential;
use super::flow::Flow;
use super::standing::Standing;
use super::{Scheme, StepFailure};
use alloc::boxed::Box;

/// When a step begins, and how long it is, s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) time: f64,
    pub(super) step: f64,
}

/// A scheme at work on one mechanism.
pub(super) trait Stepper {
    /// Tries a step over `span` from the state; `standing` comes to its end, its state stays as it is.
    fn attempt(
        &mut self,
        standing: &mut Standing,
        flow: &mut Flow<'_>,
        span: Span,
    ) -> Result<(), StepFailure>;

    /// Error of the step just tried over the tolerance, and the joint that has it.
    fn error(
        &mut self,
        standing: &mut Standing,
        flow: &mut Flow<'_>,
        span: Span,
        tolerance: f64,
    ) -> Result<(f64, usize), StepFailure>;

    /// Makes the end of the step just tried the state, at `time`, which is the end of `span` but for rounding.
    fn accept(
        &mut self,
        standing: &mut Standing,
        flow: &mut Flow<'_>,
        time: f64,
        span: Span,
    ) -> Result<(), StepFailure>;

    /// The power of the step with which its estimated error falls.
    fn order(&self) -> u32;

    /// The iterations made so far, for an implicit scheme.
    fn solves(&self) -> Solves {
        Solves::default()
    }
}

/// What it took to solve the equations of implicit steps.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Solves {
    pub(super) jacobians: usize,
    pub(super) factorizations: usize,
    pub(super) iterations: usize,
}

/// The stepper of a scheme; `tolerance` is that of the step control, if there is one.
pub(super) fn new(scheme: &Scheme, tolerance: Option<f64>, flow: &Flow<'_>) -> Box<dyn Stepper> {
    if let Some(tableau) = scheme.tableau() {
        return Box::new(Explicit::new(tableau, flow));
    }
    match scheme {
        Scheme::Midpoint => Box::new(Collocation::new(&collocation::MIDPOINT, tolerance, flow)),
        Scheme::Gauss2 => Box::new(Collocation::new(&collocation::GAUSS_2, tolerance, flow)),
        Scheme::Gauss3 => Box::new(Collocation::new(&collocation::GAUSS_3, tolerance, flow)),
        Scheme::Radau5 => Box::new(Collocation::new(&collocation::RADAU_5, tolerance, flow)),
        Scheme::Exponential => Box::new(Exponential::new(flow)),
        Scheme::DiscreteGradient => Box::new(Collocation::energy_keeping(flow)),
        _ => Box::new(CommutatorFree::new(flow)),
    }
}
