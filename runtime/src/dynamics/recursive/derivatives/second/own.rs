//! Pairs of directions of one joint.

use super::contraction::{Contraction, turn};
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::spatial::{shift_twist, turn_back};
use crate::steps::Carrying;
use nalgebra::Vector6;

impl Recursive {
    /// All pairs of directions of the joint under one body; and its part of the gradient by ϕ.
    pub(super) fn add_own_pairs(
        &self,
        index: usize,
        (q, speeds, accelerations): (&[f64], &[f64], &[f64]),
        out: &mut Contraction,
    ) {
        let (link, node) = (&self.links[index], &self.nodes[index]);
        let rotation = &node.motion.placement.rotation;
        let gradient = out.gradients[index].map(|wrench| turn_back(rotation, wrench));
        let (size, count) = (link.freedoms.len(), link.speeds.len());
        let q = &q[link.configuration.clone()];
        let mut room = [[0.0; MOST_FREEDOMS * MOST_FREEDOMS]; 4];
        let [by_local, mixed, by_speeds, by_rates] = &mut room;
        link.joint.second_variations(
            (
                q,
                &speeds[link.speeds.clone()],
                &accelerations[link.speeds.clone()],
            ),
            &out.virtual_speeds[link.speeds.clone()],
            &self.carrying(index, out),
            &gradient,
            [
                &mut by_local[..size * size],
                &mut mixed[..size * count],
                &mut by_speeds[..count * count],
            ],
        );
        // ∂X̄ᵀh, how the virtual momentum on a speed changes with ϕ.
        let by_rates = &mut by_rates[..size * count];
        if !link.joint.structures().speed_map.is_constant() {
            link.joint.effort_gradient(q, &gradient.rate, by_rates);
        }
        let [by_local, mixed, by_speeds, by_rates] = &room;
        self.add_products(index, out);
        let (rows, columns) = (out.by_local.len(), out.virtual_speeds.len());
        let hessian = &mut out.hessian;
        for (k, freedom) in link.freedoms.clone().enumerate() {
            for (l, other) in link.freedoms.clone().enumerate() {
                hessian.add(other, freedom, by_local[k * size + l]);
            }
            for (l, speed) in link.speeds.clone().enumerate() {
                let (speed, rate) = (rows + speed, rows + columns + speed);
                hessian.add(freedom, speed, mixed[l * size + k]);
                hessian.add(speed, freedom, mixed[l * size + k]);
                hessian.add(freedom, rate, by_rates[k * count + l]);
                hessian.add(rate, freedom, by_rates[k * count + l]);
            }
        }
        for (k, speed) in link.speeds.clone().enumerate() {
            for (l, other) in link.speeds.clone().enumerate() {
                hessian.add(rows + other, rows + speed, by_speeds[k * count + l]);
            }
        }
    }

    /// What the parent does, in the axes of the child.
    fn carrying(&self, index: usize, out: &Contraction) -> Carrying<f64> {
        let (link, node) = (&self.links[index], &self.nodes[index]);
        let placement = &node.motion.placement;
        let (parent, virtual_twist) = match link.parent {
            Some(parent) => (&self.nodes[parent], out.virtual_twists[parent]),
            None => (&self.world, Vector6::zeros()),
        };
        let carrying = Carrying {
            twist: parent.motion.twist,
            rate: parent.motion.rate,
            virtual_twist,
        };
        carrying.map(|twist| turn_back(&placement.rotation, &shift_twist(twist, &placement.offset)))
    }

    /// Products of the variations of a joint with each other, and with the gradient.
    fn add_products(&self, index: usize, out: &mut Contraction) {
        let (link, node) = (&self.links[index], &self.nodes[index]);
        let (coriolis, virtual_coriolis) = (out.coriolis[index], out.virtual_coriolis[index]);
        let gradient = out.gradients[index];
        let (rows, count) = (out.by_local.len(), out.virtual_speeds.len());
        let raised = |rate: &Vector6<f64>, drift: &Vector6<f64>| {
            node.rigid.apply(rate) + coriolis.apply(&turn(drift))
        };
        for (k, slot) in link.freedoms.clone().zip(link.variations.clone()) {
            let (inner, drift) = (&out.variations[slot], &out.virtual_drifts[slot]);
            out.by_local[k] += drift.dot(&gradient.virtual_twist)
                + inner.rate.dot(&gradient.rate)
                + inner.drift.dot(&gradient.twist)
                + inner.local.dot(&gradient.placement);
            let own = raised(&inner.rate, &inner.drift);
            let turned = virtual_coriolis.apply(&turn(&inner.drift));
            for (l, other) in link.freedoms.clone().zip(link.variations.clone()) {
                let (outer, other) = (&out.variations[other], &out.virtual_drifts[other]);
                let entry = drift.dot(&raised(&outer.rate, &outer.drift)) + other.dot(&own)
                    - outer.drift.dot(&turned);
                out.hessian.add(l, k, entry);
            }
            for (j, (speed, column)) in link.speeds.clone().zip(link.columns.clone()).enumerate() {
                let column = &self.columns[column];
                let outer = &out.variations[link.variations.start + j];
                let entry = drift.dot(&raised(&outer.speed_rate, column)) - column.dot(&turned);
                out.hessian.add(k, rows + speed, entry);
                out.hessian.add(rows + speed, k, entry);
                let entry = drift.dot(&node.rigid.apply(column));
                out.hessian.add(k, rows + count + speed, entry);
                out.hessian.add(rows + count + speed, k, entry);
            }
        }
        for (k, inner) in link.speeds.clone().zip(link.columns.clone()) {
            let turned = virtual_coriolis.apply(&turn(&self.columns[inner]));
            for (l, outer) in link.speeds.clone().zip(link.columns.clone()) {
                let entry = -self.columns[outer].dot(&turned);
                out.hessian.add(rows + l, rows + k, entry);
            }
        }
    }
}
