//! The joints' own part of a linearised step: how local coordinates and ϕ̇ of a stage change.

use crate::flow::multiply;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;
use hamel_runtime::dynamics::Sensitivity;
use hamel_runtime::mechanism::{Body, Mechanism};
use hamel_runtime::steps::ChartDerivatives;

/// [`ChartDerivatives`] of all joints.
#[derive(Clone, Debug)]
pub(crate) struct Charts(Vec<Own>);

#[derive(Clone, Debug)]
struct Own {
    freedoms: Range<usize>,
    speeds: Range<usize>,
    carried: Vec<f64>,
    moved: Vec<f64>,
    rate_by_base: Vec<f64>,
    rate_by_phi: Vec<f64>,
    rate_by_speeds: Vec<f64>,
}

impl Own {
    /// Room for the joint that a body stands for; none for its further bodies.
    fn new(body: &Body) -> Self {
        let (freedoms, speeds) = match body.leads() {
            true => (body.ranges().freedoms.clone(), body.ranges().speeds.clone()),
            false => (0..0, 0..0),
        };
        let square = vec![0.0; freedoms.len() * freedoms.len()];
        Self {
            carried: square.clone(),
            moved: square.clone(),
            rate_by_base: square.clone(),
            rate_by_phi: square,
            rate_by_speeds: vec![0.0; freedoms.len() * speeds.len()],
            freedoms,
            speeds,
        }
    }
}

impl Charts {
    pub(crate) fn new(mechanism: &Mechanism) -> Self {
        Self(mechanism.bodies().iter().map(Own::new).collect())
    }

    /// Evaluates them at base point `base`, `phi` and `speeds`.
    pub(crate) fn set(&mut self, mechanism: &Mechanism, base: &[f64], phi: &[f64], speeds: &[f64]) {
        for (index, body) in mechanism.joints() {
            let own = &mut self.0[index];
            let mut out = ChartDerivatives {
                carried: &mut own.carried,
                moved: &mut own.moved,
                rate_by_base: &mut own.rate_by_base,
                rate_by_phi: &mut own.rate_by_phi,
                rate_by_speeds: &mut own.rate_by_speeds,
            };
            let (phi, speeds) = (&phi[own.freedoms.clone()], &speeds[own.speeds.clone()]);
            body.joint()
                .differentiate(body.configuration(base), phi, speeds, &mut out);
        }
    }

    /// D (K×K) and `∂ϕ̇/∂v̄` (K×S) of one joint, column by column.
    pub(crate) fn of(&self, joint: usize) -> (&[f64], &[f64]) {
        let own = &self.0[joint];
        (&own.moved, &own.rate_by_speeds)
    }

    /// ϕ̇ at v̄, one per degree of freedom.
    pub(super) fn rates(&self, speeds: &[f64], rates: &mut [f64]) {
        for own in &self.0 {
            let speeds = &speeds[own.speeds.clone()];
            multiply(
                &own.rate_by_speeds,
                speeds,
                &mut rates[own.freedoms.clone()],
            );
        }
    }

    /// `ξ = D δϕ_i` into `local`.
    pub(crate) fn localize(&self, phi: &Sensitivity, local: &mut Sensitivity) {
        local.entries_mut().fill(0.0);
        for own in &self.0 {
            let freedoms = &own.freedoms;
            add_block(local, freedoms, &own.moved, (phi, freedoms));
        }
    }

    /// Adds T δϕ to `local`; the first columns are those of δϕ.
    pub(super) fn carry(&self, local: &mut Sensitivity) {
        for own in &self.0 {
            add_square(local, &own.freedoms, &own.carried);
        }
    }

    /// `δϕ̇_i = P δϕ_i + S⁻¹S̄ δv̄_i` into `slopes`.
    pub(crate) fn differentiate(
        &self,
        phi: &Sensitivity,
        faster: &Sensitivity,
        slopes: &mut Sensitivity,
    ) {
        slopes.entries_mut().fill(0.0);
        for own in &self.0 {
            let freedoms = &own.freedoms;
            add_block(slopes, freedoms, &own.rate_by_phi, (phi, freedoms));
            add_block(slopes, freedoms, &own.rate_by_speeds, (faster, &own.speeds));
        }
    }

    /// Adds G δϕ to `slopes`; the first columns are those of δϕ.
    pub(super) fn drag(&self, slopes: &mut Sensitivity) {
        for own in &self.0 {
            add_square(slopes, &own.freedoms, &own.rate_by_base);
        }
    }
}

/// Adds `matrix` times the rows `from` of another matrix to the rows `to`.
fn add_block(
    sum: &mut Sensitivity,
    to: &Range<usize>,
    matrix: &[f64],
    (other, from): (&Sensitivity, &Range<usize>),
) {
    let width = sum.columns();
    for (column, row) in matrix.chunks_exact(to.len().max(1)).zip(from.clone()) {
        let row = &other.entries()[row * width..(row + 1) * width];
        for (weight, target) in column.iter().zip(to.clone()) {
            if *weight != 0.0 {
                let target = &mut sum.entries_mut()[target * width..(target + 1) * width];
                super::add(target, *weight, row);
            }
        }
    }
}

/// Adds `matrix` to the columns of the joint's own δϕ.
fn add_square(sum: &mut Sensitivity, own: &Range<usize>, matrix: &[f64]) {
    let width = sum.columns();
    for (column, j) in matrix.chunks_exact(own.len().max(1)).zip(own.clone()) {
        for (entry, i) in column.iter().zip(own.clone()) {
            sum.entries_mut()[i * width + j] += entry;
        }
    }
}
