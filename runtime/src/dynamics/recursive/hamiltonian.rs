//! The port-Hamiltonian right-hand side by recursion, THEORY of (27) and (35) without ∂M/∂ϕ, accelerations or J22:
//!
//! `p̄̇ᵢ = τ̄ᵢ + X̄ᵢᵀ(fᵢ + ad_{Vᵢ}ᵀ hᵢ) + Ẋ̄ᵢᵀ hᵢ` with composite momenta h and composite external wrenches f.

use super::Recursive;
use super::inverse::MOST_FREEDOMS;
use crate::spatial::fused::{apply_transposed, cross, dot};
use crate::spatial::{bracket_dual_product, join, shift_wrench, split};
use nalgebra::{Vector3, Vector6};

impl Recursive {
    /// The momentum of each body alone into its node, from twists and inertias.
    pub(super) fn set_momenta(&mut self) {
        for node in &mut self.nodes {
            node.wrench = node.rigid.apply(&node.motion.twist);
        }
    }

    /// p̄̇ from twists that belong to `speeds`, own inertias, and what acts, in the workspace.
    pub(super) fn momentum_rates_at(&mut self, q: &[f64], speeds: &[f64], rates: &mut [f64]) {
        self.prepare_rates();
        self.gather_rates(q, speeds, rates);
    }

    /// The momentum of each body alone into its wrench, the external wrench on it into its rate, which is not needed here.
    pub(super) fn prepare_rates(&mut self) {
        let gravity = *self.mechanism.gravity();
        self.set_momenta();
        for (node, external) in self.nodes.iter_mut().zip(&self.external) {
            let weight = weight(&gravity, node.rigid.mass, &node.rigid.first_moment);
            node.motion.rate = weight + external;
        }
    }

    /// Inward, after [`Recursive::prepare_rates`]: the composites, and p̄̇ from them.
    pub(super) fn gather_rates(&mut self, q: &[f64], speeds: &[f64], rates: &mut [f64]) {
        for (index, link) in self.links.iter().enumerate().rev() {
            let (before, rest) = self.nodes.split_at_mut(index);
            let own = &rest[0];
            let speed_range = link.speeds.clone();
            let out = &mut rates[speed_range.clone()];
            let turned = own.motion.rate + bracket_dual_product(&own.motion.twist, &own.wrench);
            link.joint
                .gather(&turned, &self.columns[speed_range.clone()], out);
            let forces = &self.forces[speed_range.clone()];
            for (rate, force) in out.iter_mut().zip(forces) {
                *rate += force;
            }
            if !link.joint.structures().bias_momentum.is_zero() {
                let (moment, momentum) = split(&own.wrench);
                let rotation = &own.motion.placement.rotation;
                let in_child = join(
                    &apply_transposed(rotation, &moment),
                    &apply_transposed(rotation, &momentum),
                );
                let q = &q[link.configuration.clone()];
                let mut moved = [0.0; MOST_FREEDOMS];
                let moved = &mut moved[..out.len()];
                link.joint
                    .bias_momentum(q, &speeds[speed_range], &in_child, moved);
                for (rate, moved) in out.iter_mut().zip(moved) {
                    *rate += *moved;
                }
            }
            if let Some(parent) = link.parent {
                let offset = &own.motion.placement.offset;
                before[parent].wrench += shift_wrench(&own.wrench, offset);
                before[parent].motion.rate += shift_wrench(&own.motion.rate, offset);
            }
        }
    }

    /// Kinetic and potential energy at the placements, twists and inertias of the workspace, J.
    pub(super) fn energy_here(&self, q: &[f64], speeds: &[f64]) -> f64 {
        let bodies: f64 = self
            .nodes
            .iter()
            .map(|node| {
                let momentum = node.rigid.apply(&node.motion.twist);
                0.5 * node.motion.twist.dot(&momentum)
            })
            .sum();
        let rotors: f64 = self
            .links
            .iter()
            .map(|link| {
                let own = link.armature.iter().zip(&speeds[link.speeds.clone()]);
                own.map(|(a, v)| 0.5 * a * v * v).sum::<f64>()
            })
            .sum();
        bodies + rotors + self.potential_energy_here() + self.element_energy_here(q, speeds)
    }

    /// Potential energy in gravity at the placements of the workspace, zero at the world's origin, J.
    pub(super) fn potential_energy_here(&self) -> f64 {
        let gravity = self.mechanism.gravity();
        let work = self.nodes.iter().map(|node| {
            let moment = node.rigid.first_moment + node.motion.placement.origin * node.rigid.mass;
            dot(gravity, &moment)
        });
        -work.sum::<f64>()
    }
}

/// Gravity's wrench on a body.
pub(super) fn weight(
    gravity: &Vector3<f64>,
    mass: f64,
    first_moment: &Vector3<f64>,
) -> Vector6<f64> {
    join(&cross(first_moment, gravity), &(gravity * mass))
}
