//! Derivatives of forward dynamics and of the port-Hamiltonian form by products with M̄⁻¹, where joints carry several bodies.
//!
//! With `M̄ v̄̇ = S̄ᵀτ − n` they are `∂v̄̇ = M̄⁻¹ (∂(S̄ᵀτ) − ∂n)` at fixed v̄̇, where n is what inverse dynamics needs, and with `p̄ = M̄ v̄` at fixed p̄
//! `∂v̄/∂ϕ = −M̄⁻¹ ∂(M̄ v̄)/∂ϕ`. M̄⁻¹ comes from the factors of the articulated recursion, a row for each speed.
//!
//! Driven joints do not give way: their rows and columns of M̄⁻¹ are zero, and one unit of a driven rate moves the others by `−M̄⁻¹ M̄ e`.

use super::fold::is_folded;
use super::hamiltonian::HamiltonianDerivatives;
use super::inverse::InverseDerivatives;
use super::product::negative_product;
use super::{ForwardDerivatives, Sensitivity};
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::dynamics::recursive::{MassMatrix, Recursive};
use crate::mechanism::Mechanism;

/// M̄⁻¹, and room for what it is multiplied with.
#[derive(Clone, Debug)]
pub(super) struct Dense {
    inverse: Sensitivity,
    mass: MassMatrix,
    needed: InverseDerivatives,
}

impl Dense {
    /// `None` for a mechanism whose joints carry one body each.
    pub(super) fn new(mechanism: &Mechanism) -> Option<Self> {
        let speeds = mechanism.layout().speeds;
        is_folded(mechanism).then(|| Self {
            inverse: Sensitivity::new(speeds, speeds),
            mass: MassMatrix::new(mechanism),
            needed: InverseDerivatives::new(mechanism),
        })
    }

    /// `M̄⁻¹ S̄ᵀ e` for unit efforts e, or what prescribed rates do, into the columns of a joint.
    fn answer(&self, driven: bool, column: usize, weights: &[(usize, f64)], out: &mut Sensitivity) {
        for row in 0..self.inverse.rows() {
            let terms = weights.iter().map(|&(speed, weight)| match driven {
                false => weight * self.inverse.entry(row, speed),
                true => {
                    let others = 0..self.inverse.columns();
                    let moved = others.map(|other| {
                        self.inverse.entry(row, other) * self.mass.entry(other, speed)
                    });
                    let own = if row == speed { 1.0 } else { 0.0 };
                    own - moved.sum::<f64>()
                }
            });
            out.set(row, column, terms.sum());
        }
    }
}

impl Recursive {
    /// M̄⁻¹ from the factors of the last elimination, and with driven joints M̄; twists, wrenches and loads are lost.
    pub(super) fn invert_mass(&mut self, dense: &mut Dense) {
        self.invert_row_by_row(&mut dense.inverse);
        if !self.mechanism.drives().is_empty() {
            self.compose();
            self.fill_mass_matrix(&mut dense.mass);
        }
    }

    /// What is left of the derivatives at (q, v̄, τ) once v̄̇ has been found.
    pub(super) fn differentiate_dense(
        &mut self,
        (q, speeds, efforts): (&[f64], &[f64], &[f64]),
        dense: &mut Dense,
        out: &mut ForwardDerivatives,
    ) {
        self.invert_mass(dense);
        self.advance(q, speeds, Some(&out.rates));
        self.differentiate_needed(q, speeds, &out.rates, &mut dense.needed);
        for index in 0..self.links.len() {
            self.add_effort_slopes(index, (q, efforts), -1.0, &mut dense.needed.by_local);
        }
        negative_product(&dense.inverse, &dense.needed.by_local, &mut out.by_local);
        negative_product(&dense.inverse, &dense.needed.by_speeds, &mut out.by_speeds);
        self.answer_efforts_densely(q, dense, &mut out.by_efforts);
    }

    /// `∂v̄̇/∂τ`.
    fn answer_efforts_densely(&self, q: &[f64], dense: &Dense, out: &mut Sensitivity) {
        out.clear();
        for link in self.links.iter().filter(|link| link.leads) {
            let q = &q[link.configuration.clone()];
            for (b, slot) in link.freedoms.clone().enumerate() {
                let mut weights = [(0, 0.0); MOST_FREEDOMS];
                let weights = &mut weights[..link.speeds.len()];
                if link.driven {
                    // The first efforts are the rates of the speeds.
                    if let Some(speed) = link.speeds.clone().nth(b) {
                        dense.answer(true, slot, &[(speed, 1.0)], out);
                    }
                    continue;
                }
                let (mut unit, mut forces) = ([0.0; MOST_FREEDOMS], [0.0; MOST_FREEDOMS]);
                unit[b] = 1.0;
                let forces = &mut forces[..link.speeds.len()];
                link.joint
                    .reduce_efforts(q, &unit[..link.freedoms.len()], forces);
                let forces = link.speeds.clone().zip(&*forces);
                for (weight, (speed, force)) in weights.iter_mut().zip(forces) {
                    *weight = (speed, *force);
                }
                dense.answer(false, slot, weights, out);
            }
        }
    }

    /// v̄ in ϕ and p̄, once the derivatives at fixed v̄ are there.
    pub(super) fn answer_momenta_densely(&self, dense: &Dense, out: &mut HamiltonianDerivatives) {
        if let Some(needed) = &out.needed {
            negative_product(&dense.inverse, needed, &mut out.speeds_by_local);
        }
        for link in self.links.iter().filter(|link| link.leads) {
            for speed in link.speeds.clone() {
                dense.answer(
                    link.driven,
                    speed,
                    &[(speed, 1.0)],
                    &mut out.speeds_by_momenta,
                );
            }
        }
    }
}
