//! Accelerations under constraints that couple joints, and the forces of these constraints.

use super::{Coupling, Recursive, Row};
use crate::dynamics::DynamicsError;
use crate::mechanism::{WHOLE, check_size};
use crate::spatial::fused::{add_cross, apply, cross, dot};
use crate::spatial::{shift_wrench, split};
use nalgebra::Vector3;

impl Recursive {
    /// v̄̇ under τ; see [`Recursive::coupled_rates`] for the way.
    pub(in crate::dynamics::recursive) fn coupled_accelerations(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        rates: &mut [f64],
        coupling: &mut Coupling,
    ) -> Result<(), DynamicsError> {
        self.couple(q, coupling)?;
        self.known_accelerations(q, speeds, efforts, coupling);
        let known = core::mem::take(&mut coupling.whole);
        let mut needed = core::mem::take(&mut coupling.other);
        self.balance((q, speeds, &known), efforts, &mut needed);
        for needed in &mut needed {
            *needed = -*needed;
        }
        let mut reduced = core::mem::take(&mut coupling.reduced);
        coupling.reduce(&needed, &mut reduced);
        let solved = self.solve_reduced(coupling, &mut reduced);
        for (value, &speed) in reduced.iter_mut().zip(&coupling.independent) {
            *value += known[speed];
        }
        coupling.scatter(&reduced, rates);
        coupling.reduced = reduced;
        (coupling.whole, coupling.other) = (known, needed);
        solved
    }

    /// What is known of v̄̇ into `coupling.whole`: prescribed rates, and what the constraints ask of the dependent ones.
    fn known_accelerations(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        coupling: &mut Coupling,
    ) {
        self.set_driven_rates(efforts);
        self.advance(q, speeds, None);
        let gravity = *self.mechanism.gravity();
        for (row, value) in coupling.rows.iter().zip(&mut coupling.multipliers) {
            *value = -self.velocity_product_of(row, &gravity);
        }
        coupling.lu.solve(&mut coupling.multipliers);
        let mut whole = core::mem::take(&mut coupling.whole);
        let prescribed = |j: usize| match coupling.driven[j] {
            true => self.driven[coupling.independent[j]],
            false => 0.0,
        };
        coupling.expand(prescribed, &mut whole);
        for (&speed, &value) in coupling.dependent.iter().zip(&coupling.multipliers) {
            whole[speed] += value;
        }
        coupling.whole = whole;
    }

    /// What the bodies need at the motion (q, v̄, v̄̇) beyond τ, elements and gravity: on the tree, for the constraints to exert.
    fn balance(&mut self, motion: (&[f64], &[f64], &[f64]), efforts: &[f64], needed: &mut [f64]) {
        let (q, speeds, accelerations) = motion;
        self.advance(q, speeds, Some(accelerations));
        self.act(q, speeds, Some(efforts));
        self.relieve();
        self.gather(needed);
        self.add_armature(accelerations, needed);
        for (needed, force) in needed.iter_mut().zip(&self.forces) {
            *needed -= force;
        }
    }

    /// `Ȧᵀ v̄` of one constraint: `d · a_P + (ω × d) · v_P` at v̄̇ = 0.
    fn velocity_product_of(&self, row: &Row, gravity: &Vector3<f64>) -> f64 {
        let motion = &self.nodes[row.body].motion;
        let (_, direction) = split(&row.wrench);
        let arm = apply(&motion.placement.rotation, &row.point);
        let ((omega, velocity), (alpha, rate)) = (split(&motion.twist), split(&motion.rate));
        // The base accelerates with −g in the sweep; a point's acceleration is the rate of the frame's velocity plus ω × v.
        let origin = add_cross(&(rate + gravity), &omega, &velocity);
        let turned = add_cross(&origin, &alpha, &arm);
        let acceleration = add_cross(&turned, &omega, &cross(&omega, &arm));
        let at_point = add_cross(&velocity, &omega, &arm);
        dot(&direction, &acceleration) + dot(&cross(&omega, &direction), &at_point)
    }

    /// λ of the constraints that couple joints into `forces`, one entry a constraint: they act on the tree with efforts `S̄ᵀ`-wise `Aλ`.
    ///
    /// `rates` are the accelerations that [`Dynamics::forward_dynamics`](crate::dynamics::Dynamics::forward_dynamics) found for `efforts`. The
    /// joints' wrenches can be read afterwards, as after [`Recursive::inverse_dynamics`]: what the constraints exert is not the joints' to carry.
    ///
    /// # Errors
    /// A wrong size; constraints that no longer determine their speeds.
    pub fn coupling_force(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        rates: &[f64],
        efforts: &[f64],
        forces: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let count = self.mechanism.constraints().len();
        check_size(WHOLE, "constraint forces", count, forces.len())?;
        self.check(q, &[("speeds", speeds), ("rates", rates)])?;
        self.check_efforts(q, speeds, efforts)?;
        self.with_coupling(|dynamics, coupling| {
            dynamics.coupling_force_with(q, speeds, rates, efforts, forces, coupling)
        })
        .unwrap_or(Ok(()))
    }

    pub(in crate::dynamics::recursive) fn coupling_force_with(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        rates: &[f64],
        efforts: &[f64],
        forces: &mut [f64],
        coupling: &mut Coupling,
    ) -> Result<(), DynamicsError> {
        self.weigh(q);
        self.find_basis(coupling)?;
        self.known_accelerations(q, speeds, efforts, coupling);
        let known = core::mem::take(&mut coupling.whole);
        let mut all = core::mem::take(&mut coupling.other);
        // Known rates hold what the constraints ask at v̄̇ᵢ = prescribed; the rest follows S̄.
        let rest = |j: usize| {
            let speed = coupling.independent[j];
            rates[speed] - known[speed]
        };
        coupling.expand(rest, &mut all);
        for (all, known) in all.iter_mut().zip(&known) {
            *all += known;
        }
        let mut needed = known;
        self.balance((q, speeds, &all), efforts, &mut needed);
        for (force, &speed) in forces.iter_mut().zip(&coupling.dependent) {
            *force = needed[speed];
        }
        coupling.lu.solve_transposed(forces);
        self.take_over(&coupling.rows, forces);
        (coupling.whole, coupling.other) = (needed, all);
        Ok(())
    }

    /// Takes what the constraints exert on their bodies off the wrenches of all joints between them and the root.
    fn take_over(&mut self, rows: &[Row], forces: &[f64]) {
        for (row, force) in rows.iter().zip(forces) {
            let (mut next, mut wrench) = (Some(row.body), row.wrench * *force);
            while let Some(body) = next {
                let node = &mut self.nodes[body];
                node.wrench -= wrench;
                wrench = shift_wrench(&wrench, &node.motion.placement.offset);
                next = self.links[body].parent;
            }
        }
    }
}
