//! How p̄̇ and the momenta of the tree change at fixed v̄, joint by joint: the page of [`super::hamiltonian`] says with what.

use super::hamiltonian::HamiltonianDerivatives;
use super::in_child;
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::spatial::fused::{apply, cross};
use crate::spatial::{bracket_dual_product, bracket_product, join, shift_wrench, split};
use nalgebra::{Vector3, Vector6};

/// What a joint raises above itself, at some frame: δf and δh of its ϕ; δf and δh = N X̄ of its speed, and `N X° − ad_Xᵀ (h + m)`.
struct Raised {
    weight: Vector6<f64>,
    momentum: Vector6<f64>,
    dragged: Vector6<f64>,
    of_speed: Vector6<f64>,
    moving: Vector6<f64>,
}

impl Recursive {
    /// X° of one joint, and `N X° − ad_Xᵀ (h + m)`.
    fn move_columns(&self, index: usize, q: &[f64], out: &mut HamiltonianDerivatives) {
        let (link, node) = (&self.links[index], &self.nodes[index]);
        let mut rates = [0.0; 6 * MOST_FREEDOMS];
        let rates = &mut rates[..6 * link.speeds.len()];
        if !link.joint.structures().bias_momentum.is_zero() {
            let q = &q[link.configuration.clone()];
            let speeds = &out.speeds[link.speeds.clone()];
            link.joint.twist_map_rate(q, speeds, rates);
        }
        let rotation = &node.motion.placement.rotation;
        for (speed, own) in link.columns.clone().zip(rates.chunks_exact(6)) {
            let column = &self.columns[speed];
            let turned = join(
                &apply(rotation, &Vector3::new(own[0], own[1], own[2])),
                &apply(rotation, &Vector3::new(own[3], own[4], own[5])),
            );
            let moving = turned + bracket_product(&node.motion.twist, column);
            let whole = node.wrench + out.carried[index];
            let other = node.rigid.apply(&moving) - bracket_dual_product(column, &whole);
            out.moving[speed] = [moving, other];
        }
    }

    /// Rows and columns of one joint at fixed v̄, against itself and those above it.
    pub(super) fn differentiate_rates(
        &self,
        index: usize,
        q: &[f64],
        efforts: &[f64],
        out: &mut HamiltonianDerivatives,
    ) {
        self.move_columns(index, q, out);
        let (link, node) = (&self.links[index], &self.nodes[index]);
        let gravity = self.mechanism.gravity();
        let carried = out.carried[index];
        let whole = node.wrench + carried;
        for slot in link.variations.clone() {
            let variation = out.variations[slot];
            let momentum = node.rigid.apply(&variation.drift);
            let fall = cross(&split(&variation.local).0, gravity);
            let weight = -node.rigid.apply(&join(&Vector3::zeros(), &fall));
            let own = weight + bracket_dual_product(&variation.drift, &whole);
            for speed in link.columns.clone() {
                let column = &self.columns[speed];
                let entry = column.dot(&own) + out.moving[speed][0].dot(&momentum);
                out.rates_by_local.set(speed, slot, entry);
                out.set_needed(speed, slot, column.dot(&momentum));
            }
            let turned = |of: &Vector6<f64>| bracket_dual_product(&variation.local, of);
            let mut raised = Raised {
                weight: weight - turned(&node.motion.rate)
                    + bracket_dual_product(&variation.drift, &carried),
                momentum: momentum - turned(&node.wrench),
                dragged: Vector6::zeros(),
                of_speed: Vector6::zeros(),
                moving: Vector6::zeros(),
            };
            let a = slot - link.variations.start;
            let own_speed = (a < link.columns.len()).then(|| link.columns.start + a);
            if let Some(own) = own_speed {
                let column = &self.columns[own];
                raised.of_speed = node.rigid.apply(column);
                raised.moving = out.moving[own][1];
                raised.dragged = bracket_dual_product(column, &carried);
                let turned = bracket_dual_product(column, &whole);
                for speed in link.columns.clone() {
                    let entry = self.columns[speed].dot(&turned)
                        + out.moving[speed][0].dot(&raised.of_speed);
                    out.rates_by_speeds.set(speed, own, entry);
                }
            }
            self.climb_rates(index, (slot, own_speed), raised, out);
        }
        self.add_own_rates(index, q, efforts, out);
    }

    /// One degree of freedom and speed against all above its joint.
    fn climb_rates(
        &self,
        index: usize,
        (slot, own_speed): (usize, Option<usize>),
        mut raised: Raised,
        out: &mut HamiltonianDerivatives,
    ) {
        let gravity = self.mechanism.gravity();
        let mut body = index;
        while let Some(parent) = self.links[body].parent {
            let offset = &self.nodes[body].motion.placement.offset;
            raised.weight = shift_wrench(&raised.weight, offset);
            raised.momentum = shift_wrench(&raised.momentum, offset);
            raised.dragged = shift_wrench(&raised.dragged, offset);
            raised.of_speed = shift_wrench(&raised.of_speed, offset);
            raised.moving = shift_wrench(&raised.moving, offset);
            body = parent;
            let link = &self.links[body];
            for speed in link.columns.clone() {
                let (column, [moving, _]) = (&self.columns[speed], &out.moving[speed]);
                let entry = column.dot(&raised.weight) + moving.dot(&raised.momentum);
                let needed = column.dot(&raised.momentum);
                out.rates_by_local.set(speed, slot, entry);
                if let Some(own) = own_speed {
                    let above = moving.dot(&raised.of_speed) + column.dot(&raised.dragged);
                    let below = column.dot(&raised.moving);
                    out.rates_by_speeds.set(speed, own, above);
                    out.rates_by_speeds.set(own, speed, below);
                }
                out.set_needed(speed, slot, needed);
            }
            let Some(own) = own_speed else {
                continue;
            };
            for other in link.variations.clone() {
                let variation = &out.variations[other];
                let fall = cross(&split(&variation.local).0, gravity);
                let (_, force) = split(&raised.of_speed);
                let entry = variation.drift.dot(&raised.moving) - fall.dot(&force);
                let needed = variation.drift.dot(&raised.of_speed);
                out.rates_by_local.set(own, other, entry);
                out.set_needed(own, other, needed);
            }
        }
    }

    /// What a joint's own kernels and inputs add: `∂X̄ᵀ (f + ad_Vᵀ h)`, `∂(Ẋ̄ᵀ h)` and `∂S̄ᵀ τ`; and S̄ᵀ.
    fn add_own_rates(
        &self,
        index: usize,
        q: &[f64],
        efforts: &[f64],
        out: &mut HamiltonianDerivatives,
    ) {
        let (link, node) = (&self.links[index], &self.nodes[index]);
        let structures = link.joint.structures();
        let q = &q[link.configuration.clone()];
        let speeds = &out.speeds[link.speeds.clone()];
        let (rows, freedoms) = (link.speeds.len(), link.freedoms.len());
        let momentum = in_child(node, &node.wrench);
        let mut sum = [0.0; MOST_FREEDOMS * MOST_FREEDOMS];
        let mut more = [0.0; MOST_FREEDOMS * MOST_FREEDOMS];
        if !structures.speed_map.is_constant() {
            if let Some(needed) = &mut out.needed {
                let more = &mut more[..rows * freedoms];
                link.joint.effort_gradient(q, &momentum, more);
                for (n, entry) in more.iter().enumerate() {
                    let (row, column) = (
                        link.columns.start + n % rows,
                        link.variations.start + n / rows,
                    );
                    needed.add(row, column, *entry);
                }
            }
            let turned = bracket_dual_product(&node.motion.twist, &node.wrench);
            let wrench = in_child(node, &(node.motion.rate + turned));
            let sum = &mut sum[..rows * freedoms];
            link.joint.effort_gradient(q, &wrench, sum);
        }
        if !structures.bias_momentum.is_constant() {
            let more = &mut more[..rows * freedoms];
            link.joint
                .bias_momentum_gradient(q, speeds, &momentum, more);
            for (sum, more) in sum.iter_mut().zip(more) {
                *sum += *more;
            }
        }
        self.add_input_slopes(index, q, efforts, &mut sum[..rows * freedoms]);
        for (n, entry) in sum[..rows * freedoms].iter().enumerate() {
            let (row, column) = (
                link.columns.start + n % rows,
                link.variations.start + n / rows,
            );
            out.rates_by_local.entries[row * out.rates_by_local.columns + column] += entry;
        }
        if !structures.bias_momentum.is_zero() {
            let more = &mut more[..rows * rows];
            link.joint.bias_momentum_slope(q, &momentum, more);
            for (n, entry) in more.iter().enumerate() {
                let (row, column) = (link.columns.start + n % rows, link.columns.start + n / rows);
                out.rates_by_speeds.entries[row * out.rates_by_speeds.columns + column] += entry;
            }
        }
        for slot in link.freedoms.clone() {
            let mut unit = [0.0; MOST_FREEDOMS];
            unit[slot - link.freedoms.start] = 1.0;
            let mut reduced = [0.0; MOST_FREEDOMS];
            let reduced = &mut reduced[..rows];
            link.joint.reduce_efforts(q, &unit[..freedoms], reduced);
            for (speed, entry) in link.speeds.clone().zip(reduced) {
                out.rates_by_efforts.set(speed, slot, *entry);
            }
        }
    }
}
