//! Derivatives of forward dynamics where constraints couple joints, Theorem 3 in full.
//!
//! The speeds v̄_d that depend on the others follow them, `v̄_d = B v̄_i`, so that they are no variables. Under λ, which pushes each constrained point
//! along a direction of its body, the tree obeys `M a + b = S̄ᵀτ + Aλ` with `e = Aᵀ a + Ȧᵀ v̄ = 0`. F being the wrench of a row of Aᵀ on its body, which
//! is constant in the body, `Aᵀ v̄ = Fᵀ V` and `e = Fᵀ V̇`; as the body is moved along, one unit of ϕ changes them by
//!
//! ```text
//! δ(Aᵀ v̄) = Fᵀ U      δe = Fᵀ (W + ad_U V)
//! ```
//!
//! and what the tree needs at fixed a and λ by the derivatives r of inverse dynamics, λ being carried along as a wrench on the bodies. With
//! `A_dᵀ δv̄_d = −δ(Aᵀ v̄)` as part of r and δe, the accelerations change by `δa = p + S̄ x`, where p is the change of the dependent accelerations that cancels δe and
//! `S̄ᵀMS̄ x = −S̄ᵀ (r + M p)`. Prescribed entries of x stand still, or are the inputs.

use super::inverse::InverseDerivatives;
use super::{ForwardDerivatives, Sensitivity};
use crate::dynamics::DynamicsError;
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::coupling::Coupling;
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::mechanism::Mechanism;
use crate::spatial::fused::cross;
use crate::spatial::{bracket_dual_product, shift_wrench, split};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector6;

/// Workspace, and what changes on the way.
#[derive(Clone, Debug)]
pub(super) struct Coupled {
    /// Of the tree, at the accelerations and the λ that are.
    inverse: InverseDerivatives,
    /// `∂e/∂ϕ` and `∂e/∂v̄`: a row a constraint, a column a degree of freedom or a speed.
    asked_by_local: Sensitivity,
    asked_by_speeds: Sensitivity,
    /// `∂(Aᵀ v̄)/∂ϕ`.
    slipping: Sensitivity,
    /// λ.
    forces: Vec<f64>,
    /// v̄̇ of the tree.
    accelerations: Vec<f64>,
    column: Column,
    /// ∂v̄/∂ϕ and ∂v̄/∂v̄_i, the dependent speeds completed.
    pub(super) completed: [Sensitivity; 2],
}

/// One column on its way to an answer.
#[derive(Clone, Debug)]
struct Column {
    /// r, one entry per speed.
    needed: Vec<f64>,
    /// δv̄_d, then δe, then the dependent entries of p; one entry a constraint.
    dependent: Vec<f64>,
    /// δe, one entry a constraint.
    asked: Vec<f64>,
    /// x.
    reduced: Vec<f64>,
}

impl Coupled {
    /// `None` for a mechanism without constraints.
    pub(super) fn new(mechanism: &Mechanism) -> Option<Self> {
        let count = mechanism.constraints().len();
        let layout = mechanism.layout();
        (count > 0).then(|| Self {
            inverse: InverseDerivatives::new(mechanism),
            asked_by_local: Sensitivity::new(count, layout.freedoms),
            asked_by_speeds: Sensitivity::new(count, layout.speeds),
            slipping: Sensitivity::new(count, layout.freedoms),
            forces: vec![0.0; count],
            accelerations: vec![0.0; layout.speeds],
            column: Column {
                needed: vec![0.0; layout.speeds],
                dependent: vec![0.0; count],
                asked: vec![0.0; count],
                reduced: vec![0.0; layout.speeds - count],
            },
            completed: [
                Sensitivity::new(layout.speeds, layout.freedoms),
                Sensitivity::new(layout.speeds, layout.speeds),
            ],
        })
    }

    /// The number of constraints that it has room for.
    pub(super) const fn room(&self) -> usize {
        self.slipping.rows()
    }

    /// Adds to r and δe what `weight` units of a speed change.
    fn add_speed(&mut self, speed: usize, weight: f64, asked: &mut [f64]) {
        for (row, needed) in self.column.needed.iter_mut().enumerate() {
            *needed += weight * self.inverse.by_speeds.entry(row, speed);
        }
        for (row, asked) in asked.iter_mut().enumerate() {
            *asked += weight * self.asked_by_speeds.entry(row, speed);
        }
    }
}

impl Recursive {
    /// The derivatives at (q, v̄, τ) after v̄̇ has been found.
    pub(super) fn differentiate_coupled(
        &mut self,
        state: (&[f64], &[f64], &[f64]),
        out: &mut ForwardDerivatives,
    ) -> Result<(), DynamicsError> {
        let mut work = out.coupled.take().ok_or(DynamicsError::ForeignResults)?;
        let done = self.with_coupling(|dynamics, coupling| {
            dynamics.prepare_coupled(state, &out.rates, coupling, &mut work)?;
            dynamics.answer_locals(state, coupling, &mut work, &mut out.by_local);
            answer_speeds(coupling, &mut work, &mut out.by_speeds);
            dynamics.answer_efforts(state.0, coupling, &mut work, &mut out.by_efforts);
            Ok(())
        });
        out.coupled = Some(work);
        done.unwrap_or(Ok(()))
    }

    /// λ, the derivatives of the tree under it, and what they ask of the constraints.
    fn prepare_coupled(
        &mut self,
        (q, speeds, efforts): (&[f64], &[f64], &[f64]),
        rates: &[f64],
        coupling: &mut Coupling,
        work: &mut Coupled,
    ) -> Result<(), DynamicsError> {
        self.coupling_force_with(q, speeds, rates, efforts, &mut work.forces, coupling)?;
        work.accelerations.copy_from_slice(coupling.accelerations());
        self.advance(q, speeds, Some(&work.accelerations));
        for ((body, wrench), force) in coupling.wrenches().zip(&work.forces) {
            self.nodes[body].wrench -= wrench * *force;
        }
        self.differentiate_needed(q, speeds, &work.accelerations, &mut work.inverse);
        for sensitivity in [
            &mut work.asked_by_local,
            &mut work.asked_by_speeds,
            &mut work.slipping,
        ] {
            sensitivity.clear();
        }
        for (row, (body, wrench)) in coupling.wrenches().enumerate() {
            self.ask(row, body, wrench, work);
        }
        Ok(())
    }

    /// One constraint, with the wrench F on its body, against all joints between that and the root.
    fn ask(&self, row: usize, body: usize, wrench: Vector6<f64>, work: &mut Coupled) {
        // Fᵀ ad_U V = −(ad_Vᵀ F)ᵀ U.
        let twist = &self.nodes[body].motion.twist;
        let (mut wrench, mut turned) = (wrench, -bracket_dual_product(twist, &wrench));
        let gravity = self.mechanism.gravity();
        let mut next = Some(body);
        while let Some(body) = next {
            let link = &self.links[body];
            let (_, force) = split(&wrench);
            let variations = &work.inverse.variations[link.variations.clone()];
            for (slot, variation) in link.freedoms.clone().zip(variations) {
                // W holds that the base accelerates with −g, which e does not see.
                let fall = cross(gravity, &split(&variation.local).0);
                let asked = wrench.dot(&variation.rate) + force.dot(&fall);
                let asked = asked + turned.dot(&variation.drift);
                work.asked_by_local.set(row, slot, asked);
                work.slipping.set(row, slot, wrench.dot(&variation.drift));
            }
            let columns = &self.columns[link.columns.clone()];
            let own = link.speeds.clone().zip(columns).zip(variations);
            for ((speed, column), variation) in own {
                let asked = wrench.dot(&variation.speed_rate) + turned.dot(column);
                work.asked_by_speeds.set(row, speed, asked);
            }
            let offset = &self.nodes[body].motion.placement.offset;
            wrench = shift_wrench(&wrench, offset);
            turned = shift_wrench(&turned, offset);
            next = link.parent;
        }
    }

    /// One unit of each ϕ.
    fn answer_locals(
        &mut self,
        (q, _, efforts): (&[f64], &[f64], &[f64]),
        coupling: &mut Coupling,
        work: &mut Coupled,
        out: &mut Sensitivity,
    ) {
        for index in 0..self.links.len() {
            let link = &self.links[index];
            if !link.leads {
                continue;
            }
            let count = link.speeds.len();
            let mut inputs = [0.0; MOST_FREEDOMS * MOST_FREEDOMS];
            let inputs = &mut inputs[..count * link.freedoms.len()];
            let own = &q[link.configuration.clone()];
            self.add_input_slopes(index, own, efforts, inputs);
            for (b, slot) in link.freedoms.clone().enumerate() {
                let mut asked = core::mem::take(&mut work.column.dependent);
                for (row, asked) in asked.iter_mut().enumerate() {
                    *asked = -work.slipping.entry(row, slot);
                }
                coupling.solve_dependent(&mut asked);
                for (&speed, value) in coupling.dependent.iter().zip(&asked) {
                    work.completed[0].set(speed, slot, *value);
                }
                for (row, needed) in work.column.needed.iter_mut().enumerate() {
                    *needed = work.inverse.by_local.entry(row, slot);
                }
                for (speed, input) in link.speeds.clone().zip(&inputs[b * count..]) {
                    work.column.needed[speed] -= input;
                }
                work.follow(coupling, &mut asked, |row, work| {
                    work.asked_by_local.entry(row, slot)
                });
                work.column.dependent = asked;
                answer(coupling, &mut work.column, None, (out, slot));
            }
        }
    }

    /// One unit of each effort: `S̄ᵀ` of it, or the acceleration that it prescribes.
    fn answer_efforts(
        &mut self,
        q: &[f64],
        coupling: &mut Coupling,
        work: &mut Coupled,
        out: &mut Sensitivity,
    ) {
        out.clear();
        for link in self.links.iter().filter(|link| link.leads) {
            let (count, q) = (link.speeds.len(), &q[link.configuration.clone()]);
            for (b, slot) in link.freedoms.clone().enumerate() {
                work.column.needed.fill(0.0);
                work.column.dependent.fill(0.0);
                if link.driven {
                    if let Some(speed) = link.speeds.clone().nth(b) {
                        answer(coupling, &mut work.column, Some(speed), (out, slot));
                    }
                    continue;
                }
                let (mut unit, mut forces) = ([0.0; MOST_FREEDOMS], [0.0; MOST_FREEDOMS]);
                unit[b] = 1.0;
                let (unit, forces) = (&unit[..link.freedoms.len()], &mut forces[..count]);
                link.joint.reduce_efforts(q, unit, forces);
                for (speed, force) in link.speeds.clone().zip(forces) {
                    work.column.needed[speed] = -*force;
                }
                answer(coupling, &mut work.column, None, (out, slot));
            }
        }
    }
}

impl Coupled {
    /// With δv̄_d in `dependent`: adds what it changes to r; −δe, `own` and what it changes of it, takes its place.
    fn follow(
        &mut self,
        coupling: &Coupling,
        dependent: &mut [f64],
        own: impl Fn(usize, &Self) -> f64,
    ) {
        let mut asked = core::mem::take(&mut self.column.asked);
        for (row, asked) in asked.iter_mut().enumerate() {
            *asked = own(row, self);
        }
        for (&speed, weight) in coupling.dependent.iter().zip(dependent.iter()) {
            self.add_speed(speed, *weight, &mut asked);
        }
        for (entry, asked) in dependent.iter_mut().zip(&asked) {
            *entry = -asked;
        }
        self.column.asked = asked;
    }
}

/// One unit of each independent speed; the dependent ones follow, and are no variables.
fn answer_speeds(coupling: &mut Coupling, work: &mut Coupled, out: &mut Sensitivity) {
    out.clear();
    for j in 0..coupling.independent.len() {
        let speed = coupling.independent[j];
        let mut dependent = core::mem::take(&mut work.column.dependent);
        coupling.copy_basis(j, &mut dependent);
        work.completed[1].set(speed, speed, 1.0);
        for (&follower, value) in coupling.dependent.iter().zip(&dependent) {
            work.completed[1].set(follower, speed, *value);
        }
        for (row, needed) in work.column.needed.iter_mut().enumerate() {
            *needed = work.inverse.by_speeds.entry(row, speed);
        }
        work.follow(coupling, &mut dependent, |row, work| {
            work.asked_by_speeds.entry(row, speed)
        });
        work.column.dependent = dependent;
        answer(coupling, &mut work.column, None, (out, speed));
    }
}

/// x for r and −δe, which stands in `dependent`, into column `place` of `out`, whose other rows are 0; `prescribed` is a driven speed whose entry is 1.
fn answer(
    coupling: &mut Coupling,
    column: &mut Column,
    prescribed: Option<usize>,
    (out, place): (&mut Sensitivity, usize),
) {
    coupling.solve_dependent(&mut column.dependent);
    coupling.answer(
        &column.needed,
        &column.dependent,
        prescribed,
        &mut column.reduced,
    );
    for &speed in &coupling.dependent {
        out.set(speed, place, 0.0);
    }
    for (&speed, &value) in coupling.independent.iter().zip(&column.reduced) {
        out.set(speed, place, value);
    }
}
