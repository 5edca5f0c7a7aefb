//! The sweeps that all of the recursive form is made of: outward for motion, inward for inertia and wrenches.

use super::Recursive;
use super::link::{Link, Node};
use crate::dynamics::DynamicsError;
use crate::mechanism::Space;
use crate::spatial::{ArticulatedInertia, add_weighted, shift_twist, shift_wrench};
use crate::steps::{Motion, PivotFailure};
use nalgebra::Vector6;

/// The node of a parent, or the world, beside the node of its child.
fn with_parent<'a>(
    nodes: &'a mut [Node],
    world: &'a Node,
    parent: Option<usize>,
    index: usize,
) -> (&'a Node, &'a mut Node) {
    let (before, rest) = nodes.split_at_mut(index);
    (parent.map_or(world, |parent| &before[parent]), &mut rest[0])
}

impl Recursive {
    /// Outward: where every joint puts its child.
    pub(super) fn place(&mut self, q: &[f64]) {
        for (index, link) in self.links.iter().enumerate() {
            let (parent, own) = with_parent(&mut self.nodes, &self.world, link.parent, index);
            let (from, to) = (&parent.motion.placement, &mut own.motion.placement);
            let q = &q[link.configuration.clone()];
            link.joint.place(q, &link.frame, from, to);
        }
    }

    /// Outward: placements and X̄.
    pub(super) fn stand(&mut self, q: &[f64]) {
        for (index, link) in self.links.iter().enumerate() {
            let (parent, own) = with_parent(&mut self.nodes, &self.world, link.parent, index);
            let (from, to) = (&parent.motion.placement, &mut own.motion.placement);
            let q = &q[link.configuration.clone()];
            let columns = &mut self.columns[link.columns.clone()];
            link.joint.stand(q, &link.frame, from, to, columns);
        }
        self.stand_rotors(q);
    }

    /// [`Recursive::stand`], and each body's own inertia; no wrench.
    pub(super) fn weigh(&mut self, q: &[f64]) {
        self.stand(q);
        // In a sweep of its own: to load what a joint has just stored is to wait for it.
        for (link, node) in self.links.iter().zip(&mut self.nodes) {
            link.turn(node);
        }
        if !self.slender.is_empty() {
            self.stand_slender(q);
        }
    }

    /// [`Recursive::weigh`] of the slender bodies. Apart from the others, here and in [`Recursive::advance`]: what they need would
    /// slow down the sweep over all.
    fn stand_slender(&mut self, q: &[f64]) {
        for link in &self.links {
            if let Some(number) = link.slender {
                self.slender[number].stand(link, &q[link.configuration.clone()]);
            }
        }
    }

    /// Outward: placements, X̄, V, and V̇ under `accelerations` = v̄̇ (zero when absent); each body's own inertia and the wrench
    /// that it takes.
    pub(super) fn advance(&mut self, q: &[f64], speeds: &[f64], accelerations: Option<&[f64]>) {
        for (index, link) in self.links.iter().enumerate() {
            let (parent, own) = with_parent(&mut self.nodes, &self.world, link.parent, index);
            let columns = &mut self.columns[link.columns.clone()];
            let accelerations = accelerations.map_or(&[][..], |all| &all[link.speeds.clone()]);
            let state = (
                &q[link.configuration.clone()],
                &speeds[link.speeds.clone()],
                accelerations,
            );
            let motion = &mut own.motion;
            link.joint
                .advance(state, &link.frame, &parent.motion, motion, columns);
            // The body before: to load what a joint has just stored is to wait for it.
            if let Some(last) = index.checked_sub(1) {
                self.links[last].load(&mut self.nodes[last]);
            }
        }
        if let (Some(link), Some(node)) = (self.links.last(), self.nodes.last_mut()) {
            link.load(node);
        }
        self.stand_rotors(q);
        if !self.slender.is_empty() {
            self.advance_slender(q, speeds, accelerations);
        }
    }

    /// [`Recursive::advance`] of the slender bodies, once all bodies move.
    fn advance_slender(&mut self, q: &[f64], speeds: &[f64], accelerations: Option<&[f64]>) {
        for (index, link) in self.links.iter().enumerate() {
            let Some(number) = link.slender else { continue };
            let (parent, own) = with_parent(&mut self.nodes, &self.world, link.parent, index);
            let accelerations = accelerations.map_or(&[][..], |all| &all[link.speeds.clone()]);
            let state = (
                &q[link.configuration.clone()],
                &speeds[link.speeds.clone()],
                accelerations,
            );
            self.slender[number].advance(link, state, &parent.motion, own);
        }
    }

    /// Outward, after [`Recursive::weigh`]: V.
    pub(super) fn set_twists(&mut self, speeds: &[f64]) {
        for (index, link) in self.links.iter().enumerate() {
            let (parent, own) = with_parent(&mut self.nodes, &self.world, link.parent, index);
            let carried = shift_twist(&parent.motion.twist, &own.motion.placement.offset);
            let (columns, speeds) = (
                &self.columns[link.columns.clone()],
                &speeds[link.speeds.clone()],
            );
            own.motion.twist = combine(carried, columns, speeds);
            if let Some(number) = link.slender {
                self.slender[number].set_twist(speeds, &carried, own);
            }
        }
    }

    /// Inward: the articulated inertias, and the pivots of every joint.
    pub(super) fn articulate(&mut self) -> Result<(), DynamicsError> {
        for index in (0..self.links.len()).rev() {
            if let Some(group) = self.links[index].group {
                self.articulate_member(index, group)?;
                continue;
            }
            let inertia = match self.links[index].slender {
                None => self.articulate_body(index)?,
                Some(number) => self.articulate_slender(index, number)?,
            };
            self.hand_over(index, &inertia);
        }
        Ok(())
    }

    #[inline(always)]
    fn articulate_body(&mut self, index: usize) -> Result<ArticulatedInertia<f64>, DynamicsError> {
        let link = &self.links[index];
        let speeds = link.speeds.clone();
        let (columns, pivots) = (
            &self.columns[link.columns.clone()],
            &mut self.pivots[speeds],
        );
        let mut inertia = whole(link, &self.nodes[index], &self.inertias[index]);
        if !link.driven {
            link.joint
                .articulate(&mut inertia, columns, &link.armature, pivots)
                .map_err(|failure| self.mechanism.singular(index, &failure))?;
        }
        Ok(inertia)
    }

    /// Adds what the parent of a body feels of it; the first of an inward sweep overwrites what the last sweep left.
    #[inline(always)]
    fn hand_over(&mut self, index: usize, inertia: &ArticulatedInertia<f64>) {
        let link = &self.links[index];
        if let Some(parent) = link.parent {
            let carried = inertia.shifted(&self.nodes[index].motion.placement.offset);
            match link.last {
                true => self.inertias[parent] = carried,
                false => self.inertias[parent].add(&carried),
            }
        }
    }

    /// Inward: [`Recursive::articulate`], and the loads of generalised `forces` (one entry per speed) against the wrenches of the nodes.
    pub(super) fn eliminate(&mut self, forces: &[f64]) -> Result<(), DynamicsError> {
        for index in (0..self.links.len()).rev() {
            if let Some(group) = self.links[index].group {
                self.articulate_member(index, group)?;
                self.load_node(index, group, forces);
                continue;
            }
            let inertia = match self.links[index].slender {
                None => self.eliminate_body(index, forces)?,
                Some(number) => self.eliminate_slender(index, number, forces)?,
            };
            self.hand_over(index, &inertia);
            self.add_to_parent(index);
        }
        Ok(())
    }

    #[inline(always)]
    fn eliminate_body(
        &mut self,
        index: usize,
        forces: &[f64],
    ) -> Result<ArticulatedInertia<f64>, DynamicsError> {
        let (link, node) = (&self.links[index], &mut self.nodes[index]);
        let speeds = link.speeds.clone();
        let mut inertia = whole(link, node, &self.inertias[index]);
        if !link.driven {
            link.joint
                .eliminate(
                    (&mut inertia, &mut node.wrench),
                    &self.columns[link.columns.clone()],
                    (&link.armature, &forces[speeds.clone()]),
                    &mut self.pivots[speeds.clone()],
                    &mut self.loads[speeds],
                )
                .map_err(|failure| self.mechanism.singular(index, &failure))?;
        }
        Ok(inertia)
    }

    /// Adds the wrench of a body's node to its parent's.
    #[inline(always)]
    pub(super) fn add_to_parent(&mut self, index: usize) {
        if let Some(parent) = self.links[index].parent {
            let own = &self.nodes[index];
            let carried = shift_wrench(&own.wrench, &own.motion.placement.offset);
            self.nodes[parent].wrench += carried;
        }
    }

    /// Takes the wrench of one body of a group, and hands over what the parent feels of all of them.
    pub(super) fn load_node(&mut self, index: usize, group: usize, forces: &[f64]) {
        let wrench = self.nodes[index].wrench;
        let felt = self.load_member(index, group, &wrench, forces);
        if let (Some(felt), Some(parent)) = (felt, self.links[index].parent) {
            self.nodes[parent].wrench += felt;
        }
    }

    /// Outward, after [`Recursive::eliminate`]: the rates that the loads amount to. The twists become those of the rates.
    pub(super) fn resolve(&mut self, rates: &mut [f64]) {
        if let Some(last) = self.links.len().checked_sub(1) {
            self.resolve_up_to(last, rates);
        }
    }

    /// [`Recursive::resolve`] for the bodies up to `last`.
    pub(super) fn resolve_up_to(&mut self, last: usize, rates: &mut [f64]) {
        for index in 0..=last {
            let link = &self.links[index];
            if let Some(group) = link.group {
                self.resolve_member(index, group, rates);
                continue;
            }
            let (parent, own) = with_parent(&mut self.nodes, &self.world, link.parent, index);
            let speeds = link.speeds.clone();
            let (columns, pivots) = (
                &self.columns[link.columns.clone()],
                &self.pivots[speeds.clone()],
            );
            let loads = &self.loads[speeds.clone()];
            let carried = shift_twist(&parent.motion.twist, &own.motion.placement.offset);
            let rates = &mut rates[speeds];
            if let Some(number) = link.slender {
                self.resolve_slender(index, number, &carried, rates);
                continue;
            }
            own.motion.twist = carried;
            link.joint
                .resolve(&mut own.motion.twist, columns, pivots, loads, rates);
        }
    }

    /// What [`Recursive::advance`] gives at the `rates` that [`Recursive::resolve`] has just found: V, V̇ and the wrench that each body takes.
    ///
    /// Placements, X̄ and inertias stand, and V̇ is what it was at v̄̇ = 0 with what the rates add.
    pub(super) fn set_accelerations(&mut self, q: &[f64], speeds: &[f64], rates: &[f64]) {
        if !self.plain || !self.slender.is_empty() {
            return self.advance(q, speeds, Some(rates));
        }
        for (index, link) in self.links.iter().enumerate() {
            let (parent, own) = with_parent(&mut self.nodes, &self.world, link.parent, index);
            let Motion {
                placement,
                twist,
                rate,
            } = &mut own.motion;
            *rate += *twist;
            let carried = shift_twist(&parent.motion.twist, &placement.offset);
            let speeds = &speeds[link.speeds.clone()];
            *twist = combine(carried, &self.columns[link.columns.clone()], speeds);
            own.wrench = own.rigid.wrench(twist, rate);
        }
    }

    /// Inward: the wrench of each node and of all that hangs on it; `X̄ᵀ` of it into `out`, one entry per speed.
    pub(super) fn gather(&mut self, out: &mut [f64]) {
        self.folded(out, Self::gather_columns);
    }

    /// `task` into `out`, one entry per speed, where it gives one for each body and each speed of its joint.
    pub(super) fn folded(&mut self, out: &mut [f64], task: impl FnOnce(&mut Self, &mut [f64])) {
        if self.groups.is_empty() {
            return task(self, out);
        }
        let mut columns = core::mem::take(&mut self.unfolded);
        task(self, &mut columns);
        self.fold(&columns, out);
        self.unfolded = columns;
    }

    /// [`Recursive::gather`] with one entry for each body and each speed of its joint.
    fn gather_columns(&mut self, out: &mut [f64]) {
        for index in (0..self.links.len()).rev() {
            let link = &self.links[index];
            let (own, columns) = (&self.nodes[index], &self.columns[link.columns.clone()]);
            let out = &mut out[link.columns.clone()];
            match link.slender {
                None => link.joint.gather(&own.wrench, columns, out),
                Some(number) => self.gather_slender(index, number, out),
            }
            self.add_to_parent(index);
        }
    }
}

/// What a joint carries: the body itself and what its children have handed over.
#[inline(always)]
pub(super) fn whole(
    link: &Link,
    node: &Node,
    handed: &ArticulatedInertia<f64>,
) -> ArticulatedInertia<f64> {
    match link.carries {
        true => handed.with_rigid(&node.rigid),
        false => ArticulatedInertia::from(&node.rigid),
    }
}

/// `start + Σ_j X_j weights_j`.
pub(super) fn combine(
    start: Vector6<f64>,
    columns: &[Vector6<f64>],
    weights: &[f64],
) -> Vector6<f64> {
    columns
        .iter()
        .zip(weights)
        .fold(start, |sum, (column, &weight)| {
            add_weighted(&sum, column, weight)
        })
}

impl crate::mechanism::Mechanism {
    /// The joint and speed behind a pivot that failed in the sweep.
    pub(super) fn singular(&self, body: usize, failure: &PivotFailure) -> DynamicsError {
        let speed = self.bodies()[body].ranges().speeds.start + failure.speed;
        self.singular_mass(Space::Speeds, speed, failure.pivot, failure.limit)
    }
}
