//! Derivatives of the port-Hamiltonian form.
//!
//! At fixed v̄, with composite momenta h and weights f, and `X° = ad_V X̄ + Ẋ̄` the rate of X̄ in the world: one unit of ϕ_k changes, for the joint
//! itself and those above it, `δh = N U − ad_Zᵀ h` and `δf = −N ad_Z g − ad_Zᵀ f`, and p̄̇_j by `X̄_jᵀ δf + X°_jᵀ δh`; for j below k it changes
//! p̄̇_j by `Uᵀ (N_j X°_j − ad_Xᵀ h_j) − (ad_Z g)ᵀ N_j X̄_j`. The speed does the same with U = X and Z = 0. With `∂v̄/∂ϕ = −M̄⁻¹ ∂(M̄ v̄)/∂ϕ` by
//! sweeps that of fixed p̄ follow.
//!
//! Where constraints couple joints, [`coupled_momenta`](super::coupled_momenta) has what is to be added: m there is 0 elsewhere.
//!
//! Momenta of a driven joint are its speeds. It does not give way in the sweeps, and its speed enters the others as a rate that is pushed; its own
//! rates are its inputs.

use super::acting::Acting;
use super::coupled_momenta::CoupledMomenta;
use super::dense::Dense;
use super::fold;
use super::forward::Responses;
use super::product::add_product;
use super::sweep::{Push, Tree};
use super::{Sensitivity, in_child};
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::dynamics::{Dynamics, DynamicsError};
use crate::mechanism::Mechanism;
use crate::spatial::bracket_dual_product;
use crate::steps::{RotorTerm, Variation};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector6;

/// The derivatives of v̄ and p̄̇ in ϕ, p̄ and τ, and v̄ itself.
#[derive(Clone, Debug)]
pub struct HamiltonianDerivatives {
    pub(super) speeds: Vec<f64>,
    pub(super) speeds_by_local: Sensitivity,
    pub(super) speeds_by_momenta: Sensitivity,
    pub(super) rates_by_local: Sensitivity,
    pub(super) rates_by_momenta: Sensitivity,
    pub(super) rates_by_efforts: Sensitivity,
    /// `∂p̄̇/∂v̄` at fixed ϕ.
    pub(super) rates_by_speeds: Sensitivity,
    responses: Responses,
    by_momenta: Vec<Push>,
    /// One for each body and each degree of freedom of its joint.
    pub(super) variations: Vec<Variation<f64>>,
    /// One for each body and each speed of its joint: X°, and `N X° − ad_Xᵀ (h + m)`.
    pub(super) moving: Vec<[Vector6<f64>; 2]>,
    /// One a body: m.
    pub(super) carried: Vec<Vector6<f64>>,
    pub(super) acting: Acting,
    /// `∂(M̄ v̄)/∂ϕ` at fixed v̄ of the tree, less what constraints that couple joints exert, where sweeps do not find what it makes of v̄.
    pub(super) needed: Option<Sensitivity>,
    /// For joints that carry several bodies.
    dense: Option<Dense>,
    /// Derivatives at fixed v̄ before they are summed over the bodies of each joint, where joints carry several: p̄̇ in ϕ and in v̄, and what is needed.
    unfolded: Option<([Sensitivity; 2], Sensitivity)>,
    /// For constraints that couple joints.
    pub(super) coupled: Option<CoupledMomenta>,
}

impl HamiltonianDerivatives {
    /// Room for the derivatives of `mechanism`.
    pub fn new(mechanism: &Mechanism) -> Self {
        let (speeds, freedoms) = (mechanism.layout().speeds, mechanism.layout().freedoms);
        let needs = fold::is_folded(mechanism) || !mechanism.constraints().is_empty();
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
            variations: vec![Variation::zero(); mechanism.variations()],
            moving: vec![[Vector6::zeros(); 2]; mechanism.columns()],
            carried: vec![Vector6::zeros(); mechanism.bodies().len()],
            acting: Acting::new(mechanism),
            needed: needs.then(|| Sensitivity::new(speeds, freedoms)),
            dense: Dense::new(mechanism),
            unfolded: fold::room(mechanism).map(|both| {
                let needed = Sensitivity::new(mechanism.columns(), mechanism.variations());
                (both, needed)
            }),
            coupled: CoupledMomenta::new(mechanism),
        }
    }

    /// One entry of the derivatives of the tree's momenta, where they are asked for.
    #[inline(always)]
    pub(super) fn set_needed(&mut self, speed: usize, slot: usize, value: f64) {
        if let Some(needed) = &mut self.needed {
            needed.set(speed, slot, value);
        }
    }

    /// Puts these in the place of derivatives at fixed v̄, which it gives back.
    fn exchange(
        &mut self,
        (both, needed): ([Sensitivity; 2], Sensitivity),
    ) -> ([Sensitivity; 2], Sensitivity) {
        let [by_local, by_speeds] = both;
        let by_local = core::mem::replace(&mut self.rates_by_local, by_local);
        let by_speeds = core::mem::replace(&mut self.rates_by_speeds, by_speeds);
        let own = self.needed.as_mut();
        let needed = own.map_or(Sensitivity::new(0, 0), |own| {
            core::mem::replace(own, needed)
        });
        ([by_local, by_speeds], needed)
    }

    /// v̄.
    pub fn speeds(&self) -> &[f64] {
        &self.speeds
    }

    /// `∂v̄/∂ϕ` at fixed p̄: a row a speed, a column a degree of freedom.
    pub const fn speeds_by_local(&self) -> &Sensitivity {
        &self.speeds_by_local
    }

    /// `∂v̄/∂p̄ = M̄⁻¹`.
    pub const fn speeds_by_momenta(&self) -> &Sensitivity {
        &self.speeds_by_momenta
    }

    /// `∂p̄̇/∂ϕ` at fixed p̄ and τ: a row a speed, a column a degree of freedom.
    pub const fn rates_by_local(&self) -> &Sensitivity {
        &self.rates_by_local
    }

    /// `∂p̄̇/∂p̄`.
    pub const fn rates_by_momenta(&self) -> &Sensitivity {
        &self.rates_by_momenta
    }

    /// `∂p̄̇/∂τ = S̄ᵀ`: a row a speed, a column a degree of freedom.
    pub const fn rates_by_efforts(&self) -> &Sensitivity {
        &self.rates_by_efforts
    }
}

impl Recursive {
    /// v̄ at (q, p̄) and the derivatives of v̄ and p̄̇ in ϕ, p̄ and τ into `out`. Momenta of a driven joint are its speeds and its first efforts its
    /// accelerations, here as in [`Dynamics::momentum_rates`]. Where constraints couple joints, rows and columns of the momenta that depend on the others are 0.
    ///
    /// # Errors
    /// A singular mass matrix; constraints that no longer determine their speeds; a wrong size; results that were made for another mechanism; an
    /// element that does not say how what it exerts changes.
    pub fn hamiltonian_derivatives(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        efforts: &[f64],
        out: &mut HamiltonianDerivatives,
    ) -> Result<(), DynamicsError> {
        self.check_differentiable(&out.responses.branches)?;
        self.check_coupled(out.coupled.as_ref().map_or(0, CoupledMomenta::room))?;
        self.check(q, &[("momenta", momenta)])?;
        self.check_efforts(q, &[], efforts)?;
        self.speeds(q, momenta, &mut out.speeds)?;
        if !self.mechanism.constraints().is_empty() {
            return self.differentiate_coupled_momenta(q, efforts, out);
        }
        if let Some(dense) = &mut out.dense {
            self.invert_mass(dense);
        }
        self.advance(q, &out.speeds, None);
        if self.acted_on {
            self.act_and_vary((q, &out.speeds), None, &mut out.acting);
        }
        self.sum_momenta(self.acted_on);
        self.vary_momenta(q, out);
        match out.dense.take() {
            Some(dense) => {
                self.differentiate_tree_rates(q, efforts, out);
                self.answer_momenta_densely(&dense, out);
                out.dense = Some(dense);
            }
            None => {
                for index in 0..self.links.len() {
                    self.push_momenta(index, q, out);
                }
                self.respond_to_momenta(out);
                self.differentiate_tree_rates(q, efforts, out);
            }
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
        let found = [
            &out.speeds_by_local,
            &out.speeds_by_momenta,
            &out.rates_by_local,
            &out.rates_by_momenta,
            &out.rates_by_efforts,
        ];
        self.check_found((q, &out.speeds), &found)
    }

    /// The variations of all joints at (q, v̄).
    pub(super) fn vary_momenta(&self, q: &[f64], out: &mut HamiltonianDerivatives) {
        for index in 0..self.links.len() {
            let own = &mut out.variations[self.links[index].variations.clone()];
            self.vary(index, (q, &out.speeds, &[]), own);
        }
    }

    /// p̄̇ at fixed v̄, once momenta and what acts are summed over subtrees.
    pub(super) fn differentiate_tree_rates(
        &mut self,
        q: &[f64],
        efforts: &[f64],
        out: &mut HamiltonianDerivatives,
    ) {
        self.compose();
        // Joints on different branches meet in the products alone, and in elements between bodies.
        out.rates_by_local.clear();
        out.rates_by_speeds.clear();
        let unfolded = out.unfolded.take();
        let unfolded = unfolded.map(|unfolded| out.exchange(unfolded));
        for index in 0..self.links.len() {
            self.differentiate_rates(index, q, efforts, out);
        }
        if let Some(folded) = unfolded {
            let (both, needed) = out.exchange(folded);
            self.fold_locals(&both[0], &mut out.rates_by_local);
            self.fold_speeds(&both[1], &mut out.rates_by_speeds);
            if let Some(own) = &mut out.needed {
                self.fold_locals(&needed, own);
            }
            out.unfolded = Some((both, needed));
        }
        if let Some(needed) = &mut out.needed {
            let state = (q, &*out.speeds, &*out.speeds);
            self.add_rotor_term(state, (RotorTerm::Momentum, 1.0), needed, None);
        }
        if self.acted_on {
            out.rates_by_local.add_all(&out.acting.by_local);
            out.rates_by_speeds.add_all(&out.acting.by_speeds);
        }
    }

    /// The rates of driven joints are their first efforts, whatever else.
    pub(super) fn obey_drives(&self, out: &mut HamiltonianDerivatives) {
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
        if !link.joint.structures().speed_map.is_constant() {
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
        sweep.respond::<false>(&tree, &responses.pushes, &mut out.speeds_by_local);
        if self.mechanism.drives().is_empty() {
            return sweep.respond_symmetrically(&tree, &out.by_momenta, &mut out.speeds_by_momenta);
        }
        sweep.respond::<false>(&tree, &out.by_momenta, &mut out.speeds_by_momenta);
        let driven = self.links.iter().filter(|link| link.driven);
        for speed in driven.flat_map(|link| link.speeds.clone()) {
            out.speeds_by_momenta.set(speed, speed, 1.0);
        }
    }
}
