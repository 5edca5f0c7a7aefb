//! The port-Hamiltonian right-hand side of (27) and (35) by recursion, without ∂M/∂ϕ, accelerations or J22:
//!
//! `p̄̇ᵢ = τ̄ᵢ + X̄ᵢᵀ(fᵢ + ad_{Vᵢ}ᵀ hᵢ) + Ẋ̄ᵢᵀ hᵢ` with composite momenta h and composite external wrenches f.

use super::Recursive;
use super::inverse::MOST_FREEDOMS;
use crate::spatial::fused::dot;
use crate::spatial::{bracket_dual_product, shift_wrench, turn_back};
use nalgebra::Vector6;

impl Recursive {
    /// The momentum of each body alone into its node, from twists and inertias.
    pub(super) fn set_momenta(&mut self) {
        for (link, node) in self.links.iter().zip(&mut self.nodes) {
            node.wrench = node.rigid.apply(&node.motion.twist);
            if let Some(number) = link.slender {
                self.slender[number].set_momentum(link, node);
            }
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
        let bodies = self.links.iter().zip(&mut self.nodes).zip(&self.external);
        for ((link, node), external) in bodies {
            let weight = node.rigid.weight(&gravity);
            node.motion.rate = weight + external;
            if let Some(number) = link.slender {
                self.slender[number].set_weight(link, &gravity, node, &weight);
            }
        }
    }

    /// Inward, after [`Recursive::prepare_rates`]: the composites, and p̄̇ from them.
    pub(super) fn gather_rates(&mut self, q: &[f64], speeds: &[f64], rates: &mut [f64]) {
        self.folded(rates, |dynamics, rates| {
            dynamics.gather_rate_columns(q, speeds, rates);
        });
        for (rate, force) in rates.iter_mut().zip(&self.forces) {
            *rate += force;
        }
        self.add_port_rotor_rates(speeds, rates);
    }

    /// [`Recursive::gather_rates`] without inputs, with one entry for each body and each speed of its joint.
    fn gather_rate_columns(&mut self, q: &[f64], speeds: &[f64], rates: &mut [f64]) {
        for index in (0..self.links.len()).rev() {
            let link = &self.links[index];
            let out = &mut rates[link.columns.clone()];
            let momentum = match link.slender {
                None => self.turned_momenta(index, out),
                Some(number) => self.turned_momenta_slender(index, number, out),
            };
            let link = &self.links[index];
            if !link.joint.structures().bias_momentum.is_zero() {
                let q = &q[link.configuration.clone()];
                let mut moved = [0.0; MOST_FREEDOMS];
                let moved = &mut moved[..out.len()];
                link.joint
                    .bias_momentum(q, &speeds[link.speeds.clone()], &momentum, moved);
                for (rate, moved) in out.iter_mut().zip(moved) {
                    *rate += *moved;
                }
            }
            if let Some(parent) = link.parent {
                let (before, rest) = self.nodes.split_at_mut(index);
                let own = &rest[0];
                let offset = &own.motion.placement.offset;
                before[parent].wrench += shift_wrench(&own.wrench, offset);
                before[parent].motion.rate += shift_wrench(&own.motion.rate, offset);
            }
        }
    }

    /// `X̄ᵀ(f + ad_Vᵀ h)` of one joint into `out`; returns h in child axes.
    #[inline(always)]
    fn turned_momenta(&self, index: usize, out: &mut [f64]) -> Vector6<f64> {
        let (link, own) = (&self.links[index], &self.nodes[index]);
        let turned = own.motion.rate + bracket_dual_product(&own.motion.twist, &own.wrench);
        link.joint
            .gather(&turned, &self.columns[link.columns.clone()], out);
        turn_back(&own.motion.placement.rotation, &own.wrench)
    }

    /// The momentum of all that hangs on each joint, at its child frame and in child axes, at `q` and v̄ = `speeds`.
    pub fn composite_momenta(&mut self, q: &[f64], speeds: &[f64], momenta: &mut [Vector6<f64>]) {
        self.weigh(q);
        self.set_twists(speeds);
        self.set_momenta();
        for index in (0..self.links.len()).rev() {
            let own = &self.nodes[index];
            let placement = &own.motion.placement;
            momenta[index] = turn_back(&placement.rotation, &own.wrench);
            if let Some(parent) = self.links[index].parent {
                let shifted = shift_wrench(&own.wrench, &placement.offset);
                self.nodes[parent].wrench += shifted;
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
        let rotors = self.rotor_energy(speeds);
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
