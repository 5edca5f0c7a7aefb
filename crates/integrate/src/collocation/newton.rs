//! Newton's iteration for the stages of a collocation method, with one matrix for a whole step or many.
//!
//! The increments Z solve `Z = h A F(Z)`. From a residual `R = h A F(Z) − Z` comes a change that nears `(1 − h A⊗J)⁻¹ R`: by the tree where the
//! mechanism is large, else, and where that does not converge, by dense blocks.

use super::coefficients::Coefficients;
use super::dense::Dense;
use super::tree::Tree;
use crate::flow::Flow;
use crate::step_state::StepState;
use crate::stepper::{Solves, Span};
use crate::{Form, StepFailure};
use alloc::boxed::Box;
use alloc::vec::Vec;

/// The number of speeds from which on the tree takes less work than dense blocks, although it takes more iterations.
const LARGE: usize = 16;

/// The same in the port-Hamiltonian form, where the tree leaves out how v̄ changes with Q at the same p̄, and takes many more.
const LARGE_HAMILTONIAN: usize = 96;

/// The number of speeds up to which springs between bodies are worth dense blocks: 100 factorisations a second on one core.
const LARGE_COUPLED: usize = 384;

/// The number of times that a step is shortened on end before the tree is given up: by a factor of 4 each.
const PATIENCE: usize = 6;

/// The linear equations of the iteration.
pub(super) struct Newton {
    system: System,
    method: &'static Coefficients,
    /// The step that the factors are for; NaN where there are none.
    step: f64,
    /// Whether the matrices are to be evaluated before the next iteration.
    stale: bool,
    /// Whether they belong to the state at which the step begins.
    is_fresh: bool,
    /// Q at the state that the matrices belong to.
    place: Vec<f64>,
    /// How many steps on end the tree has been refused.
    refusals: usize,
}

enum System {
    Tree(Box<Tree>),
    Dense(Box<Dense>),
}

impl Newton {
    pub(super) fn new(method: &'static Coefficients, flow: &Flow<'_>) -> Self {
        let mechanism = &flow.mechanism;
        let large = match flow.form {
            Form::Lagrangian => LARGE,
            Form::Hamiltonian => LARGE_HAMILTONIAN,
        };
        let by_tree = mechanism.layout().speeds >= large && mechanism.constraints().is_empty();
        Self {
            system: match by_tree {
                true => System::Tree(Box::new(Tree::new(method, flow))),
                false => System::Dense(Box::new(Dense::new(method, flow))),
            },
            method,
            step: f64::NAN,
            stale: true,
            is_fresh: false,
            place: Vec::new(),
            refusals: 0,
        }
    }

    /// Evaluates and factorises what the step over `span` needs.
    pub(super) fn prepare(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        Span { time, step }: Span,
        solves: &mut Solves,
    ) -> Result<(), StepFailure> {
        if self.stale {
            // Also where they cannot be evaluated: there is nothing newer to try.
            self.is_fresh = true;
            self.place.clone_from(&step_state.configuration);
            if let System::Tree(tree) = &mut self.system {
                tree.evaluate(step_state);
                if tree.leaves_out() && flow.mechanism.layout().speeds < LARGE_COUPLED {
                    self.system = System::Dense(Box::new(Dense::new(self.method, flow)));
                }
            }
            if let System::Dense(dense) = &mut self.system {
                dense.evaluate(step_state, flow, time)?;
            }
            solves.jacobians += 1;
            (self.stale, self.step) = (false, f64::NAN);
        }
        if self.step == step {
            return Ok(());
        }
        self.step = f64::NAN;
        solves.factorizations += match &mut self.system {
            System::Tree(tree) => tree.factorize(step, step_state)?,
            System::Dense(dense) => dense.factorize(flow, step)?,
        };
        self.step = step;
        Ok(())
    }

    /// Q at the state that the matrices belong to.
    pub(super) fn place(&self) -> &[f64] {
        &self.place
    }

    /// Asks for new matrices, and for better ones where the last were new already; whether that leaves anything to try. Where the step can be
    /// shortened, that is tried before the tree is given up.
    pub(super) fn doubt(&mut self, flow: &Flow<'_>, can_shorten: bool) -> bool {
        if self.is_fresh {
            match &mut self.system {
                System::Tree(_) if can_shorten && self.refusals < PATIENCE => {
                    self.refusals += 1;
                    return false;
                }
                System::Tree(_) => {
                    self.system = System::Dense(Box::new(Dense::new(self.method, flow)));
                }
                System::Dense(dense) if dense.is_differenced() => return false,
                System::Dense(dense) => dense.difference(),
            }
        }
        self.stale = true;
        true
    }

    /// The state has moved on; whether the matrices still serve is known by how fast they made the last iteration converge.
    pub(super) fn move_on(&mut self, contraction: f64, slow: f64) {
        self.is_fresh = false;
        self.refusals = 0;
        if contraction > slow || matches!(self.system, System::Tree(_)) {
            self.stale = true;
        }
    }

    /// Residuals of all stages into the changes that they call for.
    pub(super) fn solve(&mut self, residuals: &mut [Vec<f64>]) {
        match &mut self.system {
            System::Tree(tree) => tree.solve(residuals, self.step),
            System::Dense(dense) => dense.solve(residuals),
        }
    }

    /// `(γ − hJ)⁻¹ x` in place, γ the real eigenvalue of A⁻¹.
    pub(super) fn filter(&mut self, x: &mut [f64]) {
        match &mut self.system {
            System::Tree(tree) => tree.filter(x),
            System::Dense(dense) => dense.filter(x),
        }
    }
}
