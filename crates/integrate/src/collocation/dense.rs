//! Changes of the stages with the whole of J, in the blocks of [`modes`]: `ΔZ = T (Λ − hJ)⁻¹ Λ T⁻¹ R`.

use super::coefficients::Coefficients;
use super::modes::{Line, Mode, modes};
use crate::StepFailure;
use crate::flow::Flow;
use crate::jacobian::Jacobian;
use crate::step_state::StepState;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::lu::Lu;
use nalgebra::{Complex, ComplexField};

/// J and the factors made of it.
pub(super) struct Dense {
    jacobian: Jacobian,
    blocks: Vec<Block>,
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

impl Dense {
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
        }
    }

    /// Whether J is made of differences.
    pub(super) const fn is_differenced(&self) -> bool {
        self.jacobian.is_differenced()
    }

    /// From now on it is.
    pub(super) fn difference(&mut self) {
        self.jacobian.difference();
    }

    /// J at the state.
    pub(super) fn evaluate(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        time: f64,
    ) -> Result<(), StepFailure> {
        self.jacobian.evaluate(step_state, flow, time)
    }

    /// Factorises for steps of `step`; how many matrices.
    pub(super) fn factorize(&mut self, flow: &Flow<'_>, step: f64) -> Result<usize, StepFailure> {
        for block in &mut self.blocks {
            let outcome = match block {
                Block::Real(factors) => factors.factorize(&self.jacobian, step),
                Block::Pair(factors) => factors.factorize(&self.jacobian, step),
            };
            outcome.map_err(|row| super::no_solution(flow, row))?;
        }
        Ok(self.blocks.len())
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
