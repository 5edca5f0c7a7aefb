//! Newton's iteration for the stages of a collocation method, with one matrix for a whole step or many.
//!
//! The increments Z solve `Z = h A F(Z)`. From a residual `R = h A F(Z) − Z` comes the change `(1 − h A⊗J)⁻¹ R`, in the blocks of
//! [`modes`]: `ΔZ = T (Λ − hJ)⁻¹ Λ T⁻¹ R`.

use super::coefficients::Coefficients;
use super::modes::{Line, Mode, modes};
use crate::integrate::StepFailure;
use crate::integrate::flow::Flow;
use crate::integrate::jacobian::Jacobian;
use crate::integrate::standing::Standing;
use crate::integrate::stepper::{Solves, Span};
use crate::lu::Lu;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Complex, ComplexField};

/// J and the factors made of it.
pub(super) struct Newton {
    jacobian: Jacobian,
    blocks: Vec<Block>,
    /// The step that the factors are for; NaN where there are none.
    step: f64,
    /// Whether J is to be evaluated before the next iteration.
    stale: bool,
    /// Whether J belongs to the state at which the step begins.
    pub(super) is_fresh: bool,
}

enum Block {
    Real(Factors<f64>),
    Pair(Factors<Complex<f64>>),
}

/// One block at work.
struct Factors<T> {
    line: Line<T>,
    factors: Lu<T>,
    vector: Vec<T>,
}

impl<T: ComplexField<RealField = f64> + Copy> Factors<T> {
    fn new(line: Line<T>, size: usize) -> Self {
        Self {
            line,
            factors: Lu::new(size),
            vector: vec![T::zero(); size],
        }
    }

    /// Factorises `λ − hJ`; the row that depends on others where it is singular.
    fn factorize(&mut self, jacobian: &Jacobian, step: f64) -> Result<(), usize> {
        let value = self.line.value;
        let entry = |i: usize, j: usize| {
            let entry = T::from_real(-step * jacobian.entry(i, j));
            if i == j { entry + value } else { entry }
        };
        self.factors.factorize(entry, 0.0).map_err(|(row, _)| row)
    }

    /// `(λ − hJ)⁻¹ λ` times this mode's part of `residuals`.
    fn solve(&mut self, residuals: &[Vec<f64>]) {
        for (k, sum) in self.vector.iter_mut().enumerate() {
            let terms = self.line.row.iter().zip(residuals);
            *sum = terms.fold(T::zero(), |sum, (row, residual)| {
                sum + *row * T::from_real(residual[k])
            }) * self.line.value;
        }
        self.factors.solve(&mut self.vector);
    }

    /// Adds `weight` times what the solution is of stage i.
    fn add(&self, i: usize, weight: f64, change: &mut [f64]) {
        for (change, entry) in change.iter_mut().zip(&self.vector) {
            *change += weight * (self.line.column[i] * *entry).real();
        }
    }
}

impl Newton {
    pub(super) fn new(method: &Coefficients, flow: &Flow<'_>) -> Self {
        let jacobian = Jacobian::new(flow);
        let size = jacobian.size();
        let block = |mode| match mode {
            Mode::Real(line) => Block::Real(Factors::new(line, size)),
            Mode::Pair(line) => Block::Pair(Factors::new(line, size)),
        };
        Self {
            blocks: modes(method.matrix).into_iter().map(block).collect(),
            jacobian,
            step: f64::NAN,
            stale: true,
            is_fresh: false,
        }
    }

    /// Evaluates and factorises what the step over `span` needs.
    pub(super) fn prepare(
        &mut self,
        standing: &Standing,
        flow: &mut Flow<'_>,
        span: Span,
        solves: &mut Solves,
    ) -> Result<(), StepFailure> {
        if self.stale {
            self.jacobian.evaluate(standing, flow, span.time)?;
            solves.jacobians += 1;
            (self.stale, self.is_fresh, self.step) = (false, true, f64::NAN);
        }
        if self.step == span.step {
            return Ok(());
        }
        self.step = f64::NAN;
        for block in &mut self.blocks {
            let outcome = match block {
                Block::Real(factors) => factors.factorize(&self.jacobian, span.step),
                Block::Pair(factors) => factors.factorize(&self.jacobian, span.step),
            };
            outcome.map_err(|row| super::no_solution(flow, row))?;
            solves.factorizations += 1;
        }
        self.step = span.step;
        Ok(())
    }

    /// Asks for a new J, and for one of differences where the last was new already; whether that leaves anything to try.
    pub(super) fn doubt(&mut self) -> bool {
        if self.is_fresh && self.jacobian.is_differenced() {
            return false;
        }
        if self.is_fresh {
            self.jacobian.difference();
        }
        self.stale = true;
        true
    }

    /// The state has moved on; whether J still serves is known by how fast it made the last iteration converge.
    pub(super) const fn move_on(&mut self, contraction: f64, slow: f64) {
        self.is_fresh = false;
        if contraction > slow {
            self.stale = true;
        }
    }

    /// Residuals of all stages into the changes that they call for.
    pub(super) fn solve(&mut self, residuals: &mut [Vec<f64>]) {
        for block in &mut self.blocks {
            match block {
                Block::Real(factors) => factors.solve(residuals),
                Block::Pair(factors) => factors.solve(residuals),
            }
        }
        for (i, change) in residuals.iter_mut().enumerate() {
            change.fill(0.0);
            for block in &self.blocks {
                match block {
                    Block::Real(factors) => factors.add(i, 1.0, change),
                    Block::Pair(factors) => factors.add(i, 2.0, change),
                }
            }
        }
    }

    /// `(γ − hJ)⁻¹ x` in place, γ the real eigenvalue.
    pub(super) fn filter(&mut self, x: &mut [f64]) {
        if let Some(Block::Real(factors)) = self.blocks.first_mut() {
            factors.factors.solve(x);
        }
    }
}
