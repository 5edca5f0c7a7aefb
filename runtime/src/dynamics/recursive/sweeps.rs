//! The sweeps that all of the recursive form is made of: outward for motion, inward for inertia and wrenches.

use super::Recursive;
use super::link::Node;
use crate::dynamics::DynamicsError;
use crate::spatial::{ArticulatedInertia, add_weighted, shift_twist, shift_wrench};
use crate::steps::PivotFailure;
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
    /// Outward: where every joint puts its child, and X̄.
    pub(super) fn place(&mut self, q: &[f64]) {
        for (index, link) in self.links.iter().enumerate() {
            let (parent, own) = with_parent(&mut self.nodes, &self.world, link.parent, index);
            let columns = &mut self.columns[link.speeds.clone()];
            let q = &q[link.configuration.clone()];
            let (from, to) = (&parent.placement, &mut own.placement);
            link.joint.place(q, &link.frame, from, to, columns);
        }
    }

    /// Outward: placements, V, and V̇ under `accelerations` = v̄̇ (zero when absent); each body's own inertia and the wrench that it takes.
    pub(super) fn advance(&mut self, q: &[f64], speeds: &[f64], accelerations: Option<&[f64]>) {
        for (index, link) in self.links.iter().enumerate() {
            let (parent, own) = with_parent(&mut self.nodes, &self.world, link.parent, index);
            let columns = &mut self.columns[link.speeds.clone()];
            let q = &q[link.configuration.clone()];
            let v = &speeds[link.speeds.clone()];
            let (from, to) = (&parent.placement, &mut own.placement);
            link.joint.place(q, &link.frame, from, to, columns);

            let carried = shift_twist(&parent.twist, &own.placement.offset);
            let rotation = &own.placement.rotation;
            let (relative, product) =
                link.joint.velocity_product(q, v, rotation, &carried, columns);
            own.twist = carried + relative;
            own.rate = shift_twist(&parent.rate, &own.placement.offset) + product;
            if let Some(accelerations) = accelerations {
                let own_accelerations = &accelerations[link.speeds.clone()];
                own.rate = combine(own.rate, columns, own_accelerations);
            }
            own.rigid = link.inertia.rotated(rotation);
            own.wrench = own.rigid.wrench(&own.twist, &own.rate);
        }
    }

    /// Outward, after [`Recursive::place`]: each body's own inertia, and no wrench.
    pub(super) fn weigh(&mut self) {
        for (link, node) in self.links.iter().zip(&mut self.nodes) {
            node.rigid = link.inertia.rotated(&node.placement.rotation);
            node.wrench = Vector6::zeros();
        }
    }

    /// Outward, after [`Recursive::place`]: V.
    pub(super) fn set_twists(&mut self, speeds: &[f64]) {
        for (index, link) in self.links.iter().enumerate() {
            let (parent, own) = with_parent(&mut self.nodes, &self.world, link.parent, index);
            let carried = shift_twist(&parent.twist, &own.placement.offset);
            let columns = &self.columns[link.speeds.clone()];
            own.twist = combine(carried, columns, &speeds[link.speeds.clone()]);
        }
    }

    /// Inward: the articulated inertias, and the pivots of every joint.
    pub(super) fn articulate(&mut self) -> Result<(), DynamicsError> {
        for (inertia, node) in self.inertias.iter_mut().zip(&self.nodes) {
            *inertia = ArticulatedInertia::from(&node.rigid);
        }
        for (index, link) in self.links.iter().enumerate().rev() {
            let (before, rest) = self.inertias.split_at_mut(index);
            let (columns, pivots) = (
                &self.columns[link.speeds.clone()],
                &mut self.pivots[link.speeds.clone()],
            );
            link.joint
                .articulate(&mut rest[0], columns, &[], pivots)
                .map_err(|failure| self.mechanism.singular(index, &failure))?;
            if let Some(parent) = link.parent {
                let offset = &self.nodes[index].placement.offset;
                before[parent].add(&rest[0].shifted(offset));
            }
        }
        Ok(())
    }

    /// Inward, after [`Recursive::articulate`]: the loads of generalised `forces` (one entry a speed) against the wrenches of the nodes.
    pub(super) fn load(&mut self, forces: &[f64]) {
        for (index, link) in self.links.iter().enumerate().rev() {
            let (before, rest) = self.nodes.split_at_mut(index);
            let own = &mut rest[0];
            let speeds = link.speeds.clone();
            let (columns, pivots) = (&self.columns[speeds.clone()], &self.pivots[speeds.clone()]);
            let loads = &mut self.loads[speeds.clone()];
            link.joint
                .reduce(&mut own.wrench, columns, pivots, &forces[speeds], loads);
            if let Some(parent) = link.parent {
                before[parent].wrench += shift_wrench(&own.wrench, &own.placement.offset);
            }
        }
    }

    /// Outward, after [`Recursive::load`]: the rates that the loads amount to. The twists become those of the rates.
    pub(super) fn resolve(&mut self, rates: &mut [f64]) {
        for (index, link) in self.links.iter().enumerate() {
            let (parent, own) = with_parent(&mut self.nodes, &self.world, link.parent, index);
            let speeds = link.speeds.clone();
            let (columns, pivots) = (&self.columns[speeds.clone()], &self.pivots[speeds.clone()]);
            let loads = &self.loads[speeds.clone()];
            own.twist = shift_twist(&parent.twist, &own.placement.offset);
            link.joint
                .resolve(&mut own.twist, columns, pivots, loads, &mut rates[speeds]);
        }
    }

    /// Inward: the wrench of each node and of all that hangs on it; `X̄ᵀ` of it into `out`, one entry a speed.
    pub(super) fn gather(&mut self, out: &mut [f64]) {
        for (index, link) in self.links.iter().enumerate().rev() {
            let (before, rest) = self.nodes.split_at_mut(index);
            let own = &rest[0];
            let columns = &self.columns[link.speeds.clone()];
            link.joint
                .gather(&own.wrench, columns, &mut out[link.speeds.clone()]);
            if let Some(parent) = link.parent {
                before[parent].wrench += shift_wrench(&own.wrench, &own.placement.offset);
            }
        }
    }
}

/// `start + Σ_j X_j weights_j`.
fn combine(start: Vector6<f64>, columns: &[Vector6<f64>], weights: &[f64]) -> Vector6<f64> {
    columns
        .iter()
        .zip(weights)
        .fold(start, |sum, (column, &weight)| {
            add_weighted(&sum, column, weight)
        })
}

impl crate::mechanism::Mechanism {
    /// The joint and speed behind a pivot that failed.
    pub(super) fn singular(&self, body: usize, failure: &PivotFailure) -> DynamicsError {
        let body = &self.bodies()[body];
        DynamicsError::SingularMass {
            joint: body.joint_name().into(),
            speed: body.joint().speeds().get(failure.speed).unwrap_or(&""),
            pivot: failure.pivot,
            limit: failure.limit,
        }
    }
}
