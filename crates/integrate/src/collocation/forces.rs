//! Residuals of the accelerations as forces, so that the rounding of stiff forces stays where these act.
//!
//! A spring or damper of stiffness k rounds its force by some ε k, and M̄⁻¹ of the stage spreads that over all accelerations. The iteration takes it for a
//! residual and undoes it by M̄⁻¹ of the state that its matrix belongs to. What is left at other joints is the rounding times the change of M̄⁻¹ in between:
//! no change shows it, and it does not fall with the step as errors do. With `M̄(matrix)⁻¹ M̄(stage) r` in the place of a residual r both are the same, and a
//! force that is rounded moves its own spring by ε alone. Increments that have no residuals are the same with either.

use crate::Form;
use crate::StepFailure;
use crate::flow::{Flow, Rates};
use crate::step_state::add;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::DMatrix;

/// Roundings of a stiff force, in those of what it is computed of: its terms cancel, and three stages share them.
const ROUNDINGS: f64 = 16.0;

/// What it takes to read residuals as forces.
pub(super) struct Forces {
    /// A⁻¹, row by row.
    inverse: Vec<Vec<f64>>,
    /// The residuals of the last iteration, stage by stage.
    residuals: Vec<Vec<f64>>,
    /// Whether rounding of stiff forces may show, by this step or the one before.
    matter: bool,
    /// The same by this step alone.
    has_mattered: bool,
    residual: Vec<f64>,
    forces: Vec<f64>,
}

impl Forces {
    /// `None` where residuals are forces already, and where constraints determine some of them.
    pub(super) fn new(matrix: &[&[f64]], flow: &Flow<'_>) -> Option<Self> {
        if flow.form == Form::Hamiltonian || !flow.mechanism.constraints().is_empty() {
            return None;
        }
        let size = matrix.len();
        let inverse = DMatrix::from_fn(size, size, |i, j| matrix[i][j]).try_inverse()?;
        let rows = inverse.row_iter();
        let speeds = flow.mechanism.layout().speeds;
        Some(Self {
            inverse: rows.map(|row| row.iter().copied().collect()).collect(),
            residuals: vec![Vec::new(); size],
            matter: false,
            has_mattered: false,
            residual: vec![0.0; speeds],
            forces: vec![0.0; speeds],
        })
    }

    /// A step is begun.
    pub(super) const fn begin(&mut self) {
        self.matter = core::mem::replace(&mut self.has_mattered, false);
    }

    /// The residuals of an iteration, before they are solved for changes.
    pub(super) fn note(&mut self, residuals: &[Vec<f64>]) {
        for (own, residual) in self.residuals.iter_mut().zip(residuals) {
            own.clone_from(residual);
        }
    }

    /// They have called for these `changes`, of which so much is `allowed` to be left over. What is stiff changes little for its residual, and its rounding is
    /// amplified as many times; of that, the part by which M̄ changes within the step, `moved`, shows elsewhere.
    pub(super) fn see(&mut self, changes: &[Vec<f64>], moved: f64, allowed: f64) {
        let rounding = ROUNDINGS * f64::EPSILON * moved.min(1.0);
        let freedoms = changes[0].len() - self.residual.len();
        let pairs = self.residuals.iter().zip(changes);
        let mut pairs = pairs.flat_map(|(some, others)| some.iter().zip(others).skip(freedoms));
        self.has_mattered |= pairs.any(|(residual, change)| {
            let residual = residual.abs();
            residual > allowed && rounding * residual > allowed * change.abs()
        });
        self.matter |= self.has_mattered;
    }

    /// Whether the rounding of stiff forces may come to more than what is allowed.
    pub(super) const fn matter(&self) -> bool {
        self.matter
    }

    /// `M̄(place)⁻¹ M̄(here) x` in place.
    pub(super) fn transfer(
        &mut self,
        flow: &mut Flow<'_>,
        (here, place): (&[f64], &[f64]),
        x: &mut [f64],
    ) -> Result<(), StepFailure> {
        let dynamics = flow.dynamics();
        dynamics.momenta(here, x, &mut self.forces)?;
        Ok(dynamics.speeds(place, &self.forces, x)?)
    }

    /// Makes the accelerations of stage i, at Q `here`, those whose residual is that of its forces.
    pub(super) fn weigh(
        &mut self,
        flow: &mut Flow<'_>,
        (i, rates): (usize, &mut Rates),
        (here, place): (&[f64], &[f64]),
        (increments, step): (&[Vec<f64>], f64),
    ) -> Result<(), StepFailure> {
        let mut residual = core::mem::take(&mut self.residual);
        residual.copy_from_slice(&rates.y);
        for (weight, increment) in self.inverse[i].iter().zip(increments) {
            add(&mut residual, -weight / step, &increment[rates.phi.len()..]);
        }
        add(&mut rates.y, -1.0, &residual);
        let outcome = self.transfer(flow, (here, place), &mut residual);
        add(&mut rates.y, 1.0, &residual);
        self.residual = residual;
        outcome
    }
}
