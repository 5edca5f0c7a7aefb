//! Derivatives of forward dynamics.

use super::acting::{Acting, Yielding, add_response};
use super::coriolis::{ArticulatedCoriolis, Coriolis};
use super::coupled::Coupled;
use super::dense::Dense;
use super::factor::{FEW, Factors};
use super::fold::is_folded;
use super::inverse::InverseDerivatives;
use super::product::negative_product;
use super::sweep::{Push, Sweep, Tree};
use super::{Branch, Sensitivity, branches, in_child};
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::dynamics::recursive::sweeps::whole;
use crate::dynamics::{Dynamics, DynamicsError};
use crate::mechanism::Mechanism;
use crate::spatial::{ArticulatedInertia, bracket_dual_product, shift_wrench, split};
use crate::steps::Variation;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Vector3, Vector6};

/// `∂v̄̇/∂ϕ`, `∂v̄̇/∂v̄` and `∂v̄̇/∂τ` of forward dynamics, and v̄̇ itself.
#[derive(Clone, Debug)]
pub struct ForwardDerivatives {
    pub(super) rates: Vec<f64>,
    pub(super) by_local: Sensitivity,
    pub(super) by_speeds: Sensitivity,
    pub(super) by_efforts: Sensitivity,
    /// For mechanisms of few speeds.
    few: Option<(InverseDerivatives, Factors)>,
    /// For joints that carry several bodies.
    dense: Option<Dense>,
    /// For constraints that couple joints.
    pub(super) coupled: Option<Coupled>,
    pub(super) responses: Responses,
    acting: Acting,
    yielding: Yielding,
}

/// What turns pushes into rates.
#[derive(Clone, Debug)]
pub(super) struct Responses {
    pub(super) branches: Vec<Branch>,
    pub(super) sweep: Sweep,
    /// One a body: B of it and all that hangs on it, giving way.
    dragging: Vec<ArticulatedCoriolis>,
    /// One a speed: `Bᵀ X / d`.
    pub(super) drags: Vec<Vector3<f64>>,
    /// At most one per degree of freedom.
    pub(super) pushes: Vec<Push>,
    /// At most one per speed.
    faster: Vec<Push>,
    /// One a degree of freedom.
    forced: Vec<Push>,
}

impl Responses {
    pub(super) fn new(mechanism: &Mechanism) -> Self {
        let layout = mechanism.layout();
        let bodies = mechanism.bodies().len();
        Self {
            branches: branches(mechanism),
            sweep: Sweep::new(bodies, layout.speeds),
            dragging: vec![ArticulatedCoriolis::zero(); bodies],
            drags: vec![Vector3::zeros(); layout.speeds],
            pushes: vec![Push::none(); layout.freedoms],
            faster: vec![Push::none(); layout.speeds],
            forced: vec![Push::none(); layout.freedoms],
        }
    }
}

impl ForwardDerivatives {
    /// Room for the derivatives of `mechanism`.
    pub fn new(mechanism: &Mechanism) -> Self {
        let (speeds, freedoms) = (mechanism.layout().speeds, mechanism.layout().freedoms);
        let responses = Responses::new(mechanism);
        Self {
            rates: vec![0.0; speeds],
            by_local: Sensitivity::new(speeds, freedoms),
            by_speeds: Sensitivity::new(speeds, speeds),
            by_efforts: Sensitivity::new(speeds, freedoms),
            few: (speeds <= FEW && speeds == freedoms && !is_folded(mechanism)).then(|| {
                (
                    InverseDerivatives::new(mechanism),
                    Factors::new(&responses.branches, speeds),
                )
            }),
            dense: Dense::new(mechanism),
            coupled: Coupled::new(mechanism),
            responses,
            acting: Acting::new(mechanism),
            yielding: Yielding::new(mechanism),
        }
    }

    /// How many numbers a compiled module writes for the derivatives of `mechanism` (`Equations::forward_dynamics_derivatives` of `hamel-compiled`): for each speed
    /// the rows of all matrices, and its rate.
    pub fn entries(mechanism: &Mechanism) -> usize {
        let layout = mechanism.layout();
        let state = layout.freedoms + layout.speeds;
        let completed = match mechanism.constraints() {
            [] => 0,
            _ => state,
        };
        layout.speeds * (state + layout.freedoms + 1 + completed)
    }

    /// v̄̇.
    pub fn rates(&self) -> &[f64] {
        &self.rates
    }

    /// `∂v̄̇/∂ϕ`: a row a speed, a column a degree of freedom.
    pub const fn by_local(&self) -> &Sensitivity {
        &self.by_local
    }

    /// `∂v̄̇/∂v̄`: a row and a column a speed.
    pub const fn by_speeds(&self) -> &Sensitivity {
        &self.by_speeds
    }

    /// `∂v̄̇/∂τ = M̄⁻¹ S̄ᵀ`: a row a speed, a column a degree of freedom.
    pub const fn by_efforts(&self) -> &Sensitivity {
        &self.by_efforts
    }

    /// `∂v̄/∂ϕ` and `∂v̄/∂v̄ᵢ = S̄` of the speeds that [`Dynamics::complete_speeds`] completes where constraints couple joints: a row a speed, columns of
    /// degrees of freedom and of speeds, 0 for the dependent ones. `None` where no constraint does, so that every speed stands for itself.
    pub fn completed_speeds(&self) -> Option<[&Sensitivity; 2]> {
        let coupled = self.coupled.as_ref()?;
        Some(coupled.completed.each_ref())
    }

    /// Takes all of them over from rows that hold them side by side, one per speed: `∂v̄̇/∂ϕ`, `∂v̄̇/∂v̄`, `∂v̄̇/∂τ`, v̄̇, and then those of
    /// [`ForwardDerivatives::completed_speeds`], where there are any.
    ///
    /// # Errors
    /// Rows for another mechanism.
    pub fn read(&mut self, rows: &[f64]) -> Result<(), DynamicsError> {
        let own = [&self.by_local, &self.by_speeds, &self.by_efforts];
        let completed = self.completed_speeds().into_iter().flatten();
        let widths = own.into_iter().chain(completed).map(Sensitivity::columns);
        let width = 1 + widths.sum::<usize>();
        if rows.len() != self.rates.len() * width {
            return Err(DynamicsError::ForeignResults);
        }
        for (i, row) in rows.chunks_exact(width).enumerate() {
            let mut rest = row;
            for part in [
                &mut self.by_local,
                &mut self.by_speeds,
                &mut self.by_efforts,
            ] {
                rest = part.read_row(i, rest);
            }
            self.rates[i] = rest[0];
            rest = &rest[1..];
            for part in self.coupled.iter_mut().flat_map(|own| &mut own.completed) {
                rest = part.read_row(i, rest);
            }
        }
        Ok(())
    }
}

impl Recursive {
    /// v̄̇ at (q, v̄, τ) and its derivatives in ϕ, v̄ and τ into `out`. The first efforts of a driven joint are its accelerations, here as in
    /// [`Dynamics::forward_dynamics`]. Where constraints couple joints, the speeds that depend on the others follow them, as
    /// [`Dynamics::complete_speeds`] has it, in ϕ and in the others: their own rows and columns are 0. `speeds` are to obey the constraints.
    ///
    /// # Errors
    /// A singular mass matrix; constraints that no longer determine their speeds; a wrong size; results that were made for another mechanism; an
    /// element that does not say how what it exerts changes.
    pub fn forward_dynamics_derivatives(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        out: &mut ForwardDerivatives,
    ) -> Result<(), DynamicsError> {
        self.check_differentiable(&out.responses.branches)?;
        self.check_coupled(out.coupled.as_ref().map_or(0, Coupled::room))?;
        self.forward_dynamics(q, speeds, efforts, &mut out.rates)?;
        match self.mechanism.constraints().is_empty() {
            true => self.differentiate_tree((q, speeds, efforts), out),
            false => self.differentiate_coupled((q, speeds, efforts), out)?,
        }
        let found = [&out.by_local, &out.by_speeds, &out.by_efforts];
        self.check_found((q, speeds), &found)
    }

    /// The derivatives where no constraint couples joints, after [`Recursive::forward_dynamics`].
    fn differentiate_tree(
        &mut self,
        (q, speeds, efforts): (&[f64], &[f64], &[f64]),
        out: &mut ForwardDerivatives,
    ) {
        if let Some(mut dense) = out.dense.take() {
            self.differentiate_dense((q, speeds, efforts), &mut dense, out);
            out.dense = Some(dense);
            return;
        }
        self.set_accelerations(q, speeds, &out.rates);
        let yields = self.holonomic && self.mechanism.drives().is_empty();
        if let (true, Some((inverse, factors))) = (yields, &mut out.few) {
            self.differentiate_needed(q, speeds, &out.rates, inverse);
            self.invert_few(factors, &mut out.by_efforts);
            negative_product(&out.by_efforts, &inverse.by_local, &mut out.by_local);
            negative_product(&out.by_efforts, &inverse.by_speeds, &mut out.by_speeds);
            return;
        }
        if self.acted_on {
            self.act_and_vary((q, speeds), Some(&out.rates), &mut out.acting);
        }
        self.drag(&mut out.responses);
        for index in 0..self.links.len() {
            self.push(index, (q, speeds, &out.rates), efforts, &mut out.responses);
        }
        let responses = &mut out.responses;
        let tree = Tree {
            branches: &responses.branches,
            nodes: &self.nodes,
            columns: &self.columns,
            pivots: &self.pivots,
            drags: &responses.drags,
        };
        let sweep = &mut responses.sweep;
        sweep.respond::<true>(&tree, &responses.pushes, &mut out.by_local);
        sweep.respond::<true>(&tree, &responses.faster, &mut out.by_speeds);
        match yields {
            true => sweep.respond_symmetrically(&tree, &responses.forced, &mut out.by_efforts),
            false => sweep.respond::<false>(&tree, &responses.forced, &mut out.by_efforts),
        }
        for link in self.links.iter().filter(|link| link.driven) {
            for (speed, effort) in link.speeds.clone().zip(link.freedoms.clone()) {
                out.by_efforts.set(speed, effort, 1.0);
            }
        }
        if self.acted_on {
            let Yielding { units, inverse } = &mut out.yielding;
            self.push_units(units);
            sweep.respond_symmetrically(&tree, units, inverse);
            add_response(inverse, &out.acting.by_local, &mut out.by_local);
            add_response(inverse, &out.acting.by_speeds, &mut out.by_speeds);
        }
    }

    /// Inward: F of each body and all that hangs on it; B of the same, giving way.
    fn drag(&mut self, responses: &mut Responses) {
        responses.dragging.fill(ArticulatedCoriolis::zero());
        for (index, link) in self.links.iter().enumerate().rev() {
            let (before, rest) = self.nodes.split_at_mut(index);
            let own = &rest[0];
            let dragging = &mut responses.dragging[index];
            dragging.add_rigid(&Coriolis::of(&own.rigid, &own.motion.twist));
            let mut left = *dragging;
            for (speed, own) in link.speeds.clone().zip(link.columns.clone()) {
                let pivot = &self.pivots[speed];
                let column = &self.columns[own];
                responses.drags[speed] = left.eliminate(column, &pivot.momentum, pivot.inverse);
            }
            if let Some(parent) = link.parent {
                let offset = &own.motion.placement.offset;
                responses.dragging[parent].add_shifted(&left, offset);
                before[parent].wrench += shift_wrench(&own.wrench, offset);
            }
        }
    }

    /// The articulated inertia of a body before its joint gives way, after [`Recursive::forward_dynamics`].
    pub(super) fn articulated(&self, index: usize) -> ArticulatedInertia<f64> {
        whole(
            &self.links[index],
            &self.nodes[index],
            &self.inertias[index],
        )
    }

    /// What one unit of each ϕ, speed and effort of a joint pushes.
    fn push(
        &self,
        index: usize,
        state: (&[f64], &[f64], &[f64]),
        efforts: &[f64],
        responses: &mut Responses,
    ) {
        let (link, node) = (&self.links[index], &self.nodes[index]);
        let mut variations = [Variation::zero(); MOST_FREEDOMS];
        let variations = &mut variations[..link.freedoms.len()];
        self.vary(index, state, variations);
        let (inertia, dragging) = (self.articulated(index), responses.dragging[index]);
        let count = link.speeds.len();
        let mut forces = [0.0; MOST_FREEDOMS * MOST_FREEDOMS];
        let forces = &mut forces[..count * variations.len()];
        self.own_forces(index, state.0, efforts, forces);
        for (b, (slot, variation)) in link.freedoms.clone().zip(variations.iter()).enumerate() {
            let (turn, _) = split(&variation.drift);
            let wrench = inertia.apply(&variation.rate) + dragging.apply(&turn);
            let own = &forces[b * count..(b + 1) * count];
            let mut push = self.pushed(index, wrench, own);
            push.wrench -= bracket_dual_product(&variation.local, &node.wrench);
            (push.rate, push.turn) = (variation.rate, turn);
            responses.pushes[slot] = push;
        }
        for (variation, speed) in variations.iter().zip(link.speeds.clone()) {
            let (turn, _) = split(&self.columns[speed]);
            let wrench = inertia.apply(&variation.speed_rate) + dragging.apply(&turn);
            let mut push = self.pushed(index, wrench, &[0.0; MOST_FREEDOMS][..count]);
            (push.rate, push.turn) = (variation.speed_rate, turn);
            responses.faster[speed] = push;
        }
        self.push_efforts(index, state.0, &mut responses.forced);
    }

    /// What one unit of each effort of a joint pushes.
    fn push_efforts(&self, index: usize, q: &[f64], forced: &mut [Push]) {
        let link = &self.links[index];
        let (count, q) = (link.speeds.len(), &q[link.configuration.clone()]);
        if link.driven {
            return self.push_driven(index, &mut forced[link.freedoms.clone()]);
        }
        for slot in link.freedoms.clone() {
            if self.holonomic {
                forced[slot] = self.pushed_unit(index, slot - link.freedoms.start);
                continue;
            }
            let mut unit = [0.0; MOST_FREEDOMS];
            unit[slot - link.freedoms.start] = 1.0;
            let mut forces = [0.0; MOST_FREEDOMS];
            let (unit, forces) = (&unit[..link.freedoms.len()], &mut forces[..count]);
            link.joint.reduce_efforts(q, unit, forces);
            forced[slot] = self.pushed(index, Vector6::zeros(), forces);
        }
    }

    /// What is left of a unit force on one of a joint's speeds: [`Recursive::pushed`] without a wrench.
    pub(super) fn pushed_unit(&self, index: usize, first: usize) -> Push {
        let speeds = self.links[index].speeds.clone();
        let columns = &self.columns[self.links[index].columns.clone()];
        let pivots = &self.pivots[speeds];
        let load = pivots[first].inverse;
        let mut push = Push {
            body: index,
            wrench: pivots[first].momentum * load,
            ..Push::none()
        };
        push.loads[first] = load;
        for (j, (column, pivot)) in columns.iter().zip(pivots).enumerate().skip(first + 1) {
            let load = -column.dot(&push.wrench) * pivot.inverse;
            push.loads[j] = load;
            push.wrench += pivot.momentum * load;
        }
        push
    }

    /// What one unit of each acceleration of a driven joint pushes, which are the first of its efforts, or of each speed where that is
    /// prescribed; a driven joint does not yield.
    pub(super) fn push_driven(&self, index: usize, pushes: &mut [Push]) {
        let link = &self.links[index];
        let inertia = self.articulated(index);
        pushes.fill(Push {
            body: index,
            ..Push::none()
        });
        let columns = &self.columns[link.columns.clone()];
        for (push, column) in pushes.iter_mut().zip(columns) {
            (push.wrench, push.rate) = (inertia.apply(column), *column);
        }
    }

    /// What is left of a wrench once the joint under it has given way to it under its own forces.
    pub(super) fn pushed(&self, index: usize, mut wrench: Vector6<f64>, forces: &[f64]) -> Push {
        let link = &self.links[index];
        let speeds = link.speeds.clone();
        let mut push = Push {
            body: index,
            ..Push::none()
        };
        link.joint.reduce(
            &mut wrench,
            &self.columns[link.columns.clone()],
            &self.pivots[speeds.clone()],
            forces,
            &mut push.loads[..speeds.len()],
        );
        push.wrench = wrench;
        push
    }

    /// `∂S̄ᵀ τ − ∂X̄ᵀ F` of one joint, column by column.
    fn own_forces(&self, index: usize, q: &[f64], efforts: &[f64], forces: &mut [f64]) {
        let link = &self.links[index];
        let structures = link.joint.structures();
        let q = &q[link.configuration.clone()];
        if !structures.speed_map.is_constant() {
            let node = &self.nodes[index];
            let wrench = in_child(node, &node.wrench);
            link.joint.effort_gradient(q, &wrench, forces);
            for force in forces.iter_mut() {
                *force = -*force;
            }
        }
        self.add_input_slopes(index, q, efforts, forces);
    }

    /// Adds `∂S̄ᵀ τ` of one joint at its own q, column by column; nothing for its further bodies.
    pub(super) fn add_input_slopes(
        &self,
        index: usize,
        q: &[f64],
        efforts: &[f64],
        forces: &mut [f64],
    ) {
        let link = &self.links[index];
        if !link.leads || link.joint.structures().speed_basis_gradient.is_zero() {
            return;
        }
        let (rows, columns) = (link.freedoms.len(), link.speeds.len());
        let mut slices = [0.0; MOST_FREEDOMS * MOST_FREEDOMS * MOST_FREEDOMS];
        let slices = &mut slices[..rows * rows * columns];
        link.joint.speed_basis_gradient(q, slices);
        let efforts = &efforts[link.freedoms.clone()];
        for (force, column) in forces.iter_mut().zip(slices.chunks_exact(rows)) {
            *force += column.iter().zip(efforts).map(|(s, t)| s * t).sum::<f64>();
        }
    }
}
