//! Derivatives of the port-Hamiltonian form.
//!
//! At fixed v̄, with composite momenta h and weights f, and `X° = ad_V X̄ + Ẋ̄` the rate of X̄ in the world: one unit of ϕ_k changes, for the joint
//! itself and those above it, `δh = N U − ad_Zᵀ h` and `δf = −N ad_Z g − ad_Zᵀ f`, and p̄̇_j by `X̄_jᵀ δf + X°_jᵀ δh`; for j below k it changes
//! p̄̇_j by `Uᵀ (N_j X°_j − ad_Xᵀ h_j) − (ad_Z g)ᵀ N_j X̄_j`. The speed does the same with U = X and Z = 0. With `∂v̄/∂ϕ = −M̄⁻¹ ∂(M̄ v̄)/∂ϕ` by
//! sweeps that of fixed p̄ follow.
//!
//! Momenta of a driven joint are its speeds. It does not give way in the sweeps, and its speed enters the others as a rate that is pushed; its own
//! rates are its inputs.

use super::acting::Acting;
use super::forward::{Responses, invert, respond};
use super::product::add_product;
use super::sweep::{Push, Tree};
use super::{Equations, Sensitivity, in_child};
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::dynamics::{Dynamics, DynamicsError};
use crate::mechanism::Mechanism;
use crate::spatial::fused::{apply, cross};
use crate::spatial::{bracket_dual_product, bracket_product, join, shift_wrench, split};
use crate::steps::Variation;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Vector3, Vector6};

/// The derivatives of v̄ and p̄̇ in ϕ, p̄ and τ, and v̄ itself.
#[derive(Clone, Debug)]
pub struct HamiltonianDerivatives {
    speeds: Vec<f64>,
    speeds_by_local: Sensitivity,
    speeds_by_momenta: Sensitivity,
    rates_by_local: Sensitivity,
    rates_by_momenta: Sensitivity,
    rates_by_efforts: Sensitivity,
    /// `∂p̄̇/∂v̄` at fixed ϕ.
    rates_by_speeds: Sensitivity,
    responses: Responses,
    by_momenta: Vec<Push>,
    /// One a freedom.
    variations: Vec<Variation<f64>>,
    /// One a speed: X°, and `N X° − ad_Xᵀ h`.
    moving: Vec<[Vector6<f64>; 2]>,
    acting: Acting,
}

/// What a joint raises above itself, at some frame: δf and δh of its ϕ, `N X̄` and `N X° − ad_Xᵀ h` of its speed.
struct Raised {
    weight: Vector6<f64>,
    momentum: Vector6<f64>,
    of_speed: Vector6<f64>,
    moving: Vector6<f64>,
}

impl HamiltonianDerivatives {
    /// Room for the derivatives of `mechanism`.
    pub fn new(mechanism: &Mechanism) -> Self {
        let (speeds, freedoms) = (mechanism.layout().speeds, mechanism.layout().freedoms);
        Self {
            speeds: vec![0.0; speeds],
            speeds_by_local: Sensitivity::new(speeds, freedoms),
            speeds_by_momenta: Sensitivity::new(speeds, speeds),
            rates_by_local: Sensitivity::new(speeds, freedoms),
            rates_by_momenta: Sensitivity::new(speeds, speeds),
            rates_by_efforts: Sensitivity::new(speeds, freedoms),
            rates_by_speeds: Sensitivity::new(speeds, speeds),
            responses: Responses::new(mechanism),
            by_momenta: vec![Push::none(); speeds],
            variations: vec![Variation::zero(); freedoms],
            moving: vec![[Vector6::zeros(); 2]; speeds],
            acting: Acting::new(mechanism),
        }
    }

    /// v̄.
    pub fn speeds(&self) -> &[f64] {
        &self.speeds
    }

    /// `∂v̄/∂ϕ` at fixed p̄: a row a speed, a column a freedom.
    pub const fn speeds_by_local(&self) -> &Sensitivity {
        &self.speeds_by_local
    }

    /// `∂v̄/∂p̄ = M̄⁻¹`.
    pub const fn speeds_by_momenta(&self) -> &Sensitivity {
        &self.speeds_by_momenta
    }

    /// `∂p̄̇/∂ϕ` at fixed p̄ and τ: a row a speed, a column a freedom.
    pub const fn rates_by_local(&self) -> &Sensitivity {
        &self.rates_by_local
    }

    /// `∂p̄̇/∂p̄`.
    pub const fn rates_by_momenta(&self) -> &Sensitivity {
        &self.rates_by_momenta
    }

    /// `∂p̄̇/∂τ = S̄ᵀ`: a row a speed, a column a freedom.
    pub const fn rates_by_efforts(&self) -> &Sensitivity {
        &self.rates_by_efforts
    }
}

impl Recursive {
    /// v̄ at (q, p̄) and the derivatives of v̄ and p̄̇ in ϕ, p̄ and τ into `out`. Momenta of a driven joint are its speeds and its first efforts its
    /// accelerations, here as in [`Dynamics::momentum_rates`].
    ///
    /// # Errors
    /// A singular mass matrix; a wrong size; something that acts on the mechanism and that derivatives do not cover.
    pub fn hamiltonian_derivatives(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        efforts: &[f64],
        out: &mut HamiltonianDerivatives,
    ) -> Result<(), DynamicsError> {
        self.check_differentiable(
            Equations::Hamiltonian,
            &[&out.rates_by_local, &out.rates_by_speeds],
        )?;
        self.check_efforts(efforts)?;
        self.speeds(q, momenta, &mut out.speeds)?;
        self.advance(q, &out.speeds, None);
        if self.acted_on {
            self.act_and_vary(q, &out.speeds, &mut out.acting);
        }
        self.sum_momenta(self.acted_on);
        for index in 0..self.links.len() {
            let own = &mut out.variations[self.links[index].freedoms.clone()];
            self.vary(index, (q, &out.speeds, &[]), own);
            self.push_momenta(index, q, out);
        }
        self.respond_to_momenta(out);
        self.compose();
        // Joints on different branches meet in the products alone, and in elements between bodies.
        out.rates_by_local.clear();
        out.rates_by_speeds.clear();
        for index in 0..self.links.len() {
            self.differentiate_rates(index, q, efforts, out);
        }
        if self.acted_on {
            out.rates_by_local.add_all(&out.acting.by_local);
            out.rates_by_speeds.add_all(&out.acting.by_speeds);
        }
        let rates_by_speeds = &out.rates_by_speeds;
        out.rates_by_momenta.clear();
        add_product(
            rates_by_speeds,
            &out.speeds_by_momenta,
            &mut out.rates_by_momenta,
        );
        add_product(
            rates_by_speeds,
            &out.speeds_by_local,
            &mut out.rates_by_local,
        );
        self.obey_drives(out);
        Ok(())
    }

    /// The rates of driven joints are their first efforts, whatever else.
    fn obey_drives(&self, out: &mut HamiltonianDerivatives) {
        for link in self.links.iter().filter(|link| link.driven) {
            for (speed, effort) in link.speeds.clone().zip(link.freedoms.clone()) {
                out.rates_by_local.row_mut(speed).fill(0.0);
                out.rates_by_momenta.row_mut(speed).fill(0.0);
                out.rates_by_efforts.row_mut(speed).fill(0.0);
                out.rates_by_efforts.set(speed, effort, 1.0);
            }
        }
    }

    /// What one unit of each ϕ at fixed p̄, and of each momentum, of a joint pushes.
    fn push_momenta(&self, index: usize, q: &[f64], out: &mut HamiltonianDerivatives) {
        let (link, node) = (&self.links[index], &self.nodes[index]);
        let inertia = self.articulated(index);
        let count = link.speeds.len();
        let mut forces = [0.0; MOST_FREEDOMS * MOST_FREEDOMS];
        let forces = &mut forces[..count * link.freedoms.len()];
        if !link.joint.structures().twist_gradient.is_zero() {
            let momentum = in_child(node, &node.wrench);
            let q = &q[link.configuration.clone()];
            link.joint.effort_gradient(q, &momentum, forces);
        }
        for (b, slot) in link.freedoms.clone().enumerate() {
            let variation = &out.variations[slot];
            let mut own = [0.0; MOST_FREEDOMS];
            for (own, force) in own.iter_mut().zip(&forces[b * count..(b + 1) * count]) {
                *own = -force;
            }
            let mut push = self.pushed(index, inertia.apply(&variation.drift), &own[..count]);
            push.wrench -= bracket_dual_product(&variation.local, &node.wrench);
            push.rate = variation.drift;
            out.responses.pushes[slot] = push;
        }
        if link.driven {
            self.push_driven(index, &mut out.by_momenta[link.speeds.clone()]);
            return;
        }
        for (a, speed) in link.speeds.clone().enumerate() {
            out.by_momenta[speed] = self.pushed_unit(index, a);
        }
    }

    fn respond_to_momenta(&self, out: &mut HamiltonianDerivatives) {
        let responses = &mut out.responses;
        let tree = Tree {
            branches: &responses.branches,
            nodes: &self.nodes,
            columns: &self.columns,
            pivots: &self.pivots,
            drags: &responses.drags,
        };
        let sweep = &mut responses.sweep;
        respond::<false>(&tree, sweep, &responses.pushes, &mut out.speeds_by_local);
        if self.mechanism.drives().is_empty() {
            return invert(&tree, sweep, &out.by_momenta, &mut out.speeds_by_momenta);
        }
        respond::<false>(&tree, sweep, &out.by_momenta, &mut out.speeds_by_momenta);
        let driven = self.links.iter().filter(|link| link.driven);
        for speed in driven.flat_map(|link| link.speeds.clone()) {
            out.speeds_by_momenta.set(speed, speed, 1.0);
        }
    }

    /// X° of one joint, and `N X° − ad_Xᵀ h`.
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
        for (speed, own) in link.speeds.clone().zip(rates.chunks_exact(6)) {
            let column = &self.columns[speed];
            let turned = join(
                &apply(rotation, &Vector3::new(own[0], own[1], own[2])),
                &apply(rotation, &Vector3::new(own[3], own[4], own[5])),
            );
            let moving = turned + bracket_product(&node.motion.twist, column);
            let other = node.rigid.apply(&moving) - bracket_dual_product(column, &node.wrench);
            out.moving[speed] = [moving, other];
        }
    }

    /// Rows and columns of one joint at fixed v̄, against itself and those above it.
    fn differentiate_rates(
        &self,
        index: usize,
        q: &[f64],
        efforts: &[f64],
        out: &mut HamiltonianDerivatives,
    ) {
        self.move_columns(index, q, out);
        let (link, node) = (&self.links[index], &self.nodes[index]);
        let gravity = self.mechanism.gravity();
        for slot in link.freedoms.clone() {
            let variation = out.variations[slot];
            let momentum = node.rigid.apply(&variation.drift);
            let fall = cross(&split(&variation.local).0, gravity);
            let weight = -node.rigid.apply(&join(&Vector3::zeros(), &fall));
            let own = weight + bracket_dual_product(&variation.drift, &node.wrench);
            for speed in link.speeds.clone() {
                let entry = self.columns[speed].dot(&own) + out.moving[speed][0].dot(&momentum);
                out.rates_by_local.set(speed, slot, entry);
            }
            let turned = |of: &Vector6<f64>| bracket_dual_product(&variation.local, of);
            let mut raised = Raised {
                weight: weight - turned(&node.motion.rate),
                momentum: momentum - turned(&node.wrench),
                of_speed: Vector6::zeros(),
                moving: Vector6::zeros(),
            };
            let a = slot - link.freedoms.start;
            let own_speed = (a < link.speeds.len()).then(|| link.speeds.start + a);
            if let Some(own) = own_speed {
                let column = &self.columns[own];
                raised.of_speed = node.rigid.apply(column);
                raised.moving = out.moving[own][1];
                let turned = bracket_dual_product(column, &node.wrench);
                for speed in link.speeds.clone() {
                    let entry = self.columns[speed].dot(&turned)
                        + out.moving[speed][0].dot(&raised.of_speed);
                    out.rates_by_speeds.set(speed, own, entry);
                }
            }
            self.climb_rates(index, (slot, own_speed), raised, out);
        }
        self.add_own_rates(index, q, efforts, out);
    }

    /// One freedom and speed against all above its joint.
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
            raised.of_speed = shift_wrench(&raised.of_speed, offset);
            raised.moving = shift_wrench(&raised.moving, offset);
            body = parent;
            let link = &self.links[body];
            for speed in link.speeds.clone() {
                let (column, [moving, _]) = (&self.columns[speed], &out.moving[speed]);
                let entry = column.dot(&raised.weight) + moving.dot(&raised.momentum);
                out.rates_by_local.set(speed, slot, entry);
                if let Some(own) = own_speed {
                    let (above, below) = (moving.dot(&raised.of_speed), column.dot(&raised.moving));
                    out.rates_by_speeds.set(speed, own, above);
                    out.rates_by_speeds.set(own, speed, below);
                }
            }
            let Some(own) = own_speed else {
                continue;
            };
            for other in link.freedoms.clone() {
                let variation = &out.variations[other];
                let fall = cross(&split(&variation.local).0, gravity);
                let (_, force) = split(&raised.of_speed);
                let entry = variation.drift.dot(&raised.moving) - fall.dot(&force);
                out.rates_by_local.set(own, other, entry);
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
        if !structures.twist_gradient.is_zero() {
            let turned = bracket_dual_product(&node.motion.twist, &node.wrench);
            let wrench = in_child(node, &(node.motion.rate + turned));
            let sum = &mut sum[..rows * freedoms];
            link.joint.effort_gradient(q, &wrench, sum);
        }
        if !structures.bias_momentum_gradient.is_zero() {
            let more = &mut more[..rows * freedoms];
            link.joint
                .bias_momentum_gradient(q, speeds, &momentum, more);
            for (sum, more) in sum.iter_mut().zip(more) {
                *sum += *more;
            }
        }
        self.add_input_slopes(index, q, efforts, &mut sum[..rows * freedoms]);
        for (n, entry) in sum[..rows * freedoms].iter().enumerate() {
            let (row, column) = (link.speeds.start + n % rows, link.freedoms.start + n / rows);
            out.rates_by_local.entries[row * out.rates_by_local.columns + column] += entry;
        }
        if !structures.bias_momentum.is_zero() {
            let more = &mut more[..rows * rows];
            link.joint.bias_momentum_slope(q, speeds, &momentum, more);
            for (n, entry) in more.iter().enumerate() {
                let (row, column) = (link.speeds.start + n % rows, link.speeds.start + n / rows);
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
