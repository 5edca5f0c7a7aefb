//! Slender bodies: those with a moment of inertia that is tiny beside the others.
//!
//! Turned into world axes, their inertia keeps the tiny moment only to a rounding of the largest: at a ratio of 1e-10, six digits are
//! left. So whatever such a body and its joint alone decide is computed in the child frame's own axes, where the moments stay
//! apart; what other bodies hand over is turned into them, and back.

use super::Recursive;
use super::link::{Link, Node};
use super::sweeps::combine;
use crate::dynamics::DynamicsError;
use crate::mechanism::Mechanism;
use crate::spatial::fused::{add_cross, apply_transposed, cross};
use crate::spatial::{
    ArticulatedInertia, SpatialInertia, bracket_product, join, shift_twist, split, turn_back,
    turn_out,
};
use crate::steps::{Motion, Pivot};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{SymmetricEigen, Vector3, Vector6};

/// The ratio of moments from which on a body counts as slender: in world axes it costs as many digits as it has zeros.
const RATIO: f64 = 1e4;

/// What a slender body keeps in its child frame's axes.
#[derive(Clone, Debug)]
pub(super) struct Slender {
    /// X̄, one column per speed.
    pub(super) columns: Vec<Vector6<f64>>,
    /// V.
    pub(super) twist: Vector6<f64>,
    /// The body's own share of what a sweep carries rootward: a wrench or a momentum.
    wrench: Vector6<f64>,
    /// The same as its node has it, in world axes: what the node has beyond it comes from elsewhere.
    seen_wrench: Vector6<f64>,
    /// The body's weight, in both axes.
    weight: Vector6<f64>,
    seen_weight: Vector6<f64>,
    /// The joint's, one per speed; the others of the mechanism are in world axes.
    pivots: Vec<Pivot<f64>>,
}

/// Whether `inertia` has a moment that is tiny beside the others.
pub(super) fn is_slender(inertia: &SpatialInertia<f64>) -> bool {
    let moments = SymmetricEigen::new(inertia.inertia.matrix()).eigenvalues;
    moments.max() > RATIO * moments.min() && moments.max() > 0.0
}

/// Whether any body of `mechanism` is treated as slender; those of joints that carry several bodies are not.
pub(super) fn has_slender(mechanism: &Mechanism) -> bool {
    Link::all(mechanism)
        .iter()
        .any(|link| link.slender.is_some())
}

impl Slender {
    /// Room for each slender body of `links`.
    pub(super) fn all(links: &[Link]) -> Vec<Self> {
        let slender = links.iter().filter(|link| link.slender.is_some());
        let new = |link: &Link| Self {
            columns: vec![Vector6::zeros(); link.speeds.len()],
            twist: Vector6::zeros(),
            wrench: Vector6::zeros(),
            seen_wrench: Vector6::zeros(),
            weight: Vector6::zeros(),
            seen_weight: Vector6::zeros(),
            pivots: vec![Pivot::zero(); link.speeds.len()],
        };
        slender.map(new).collect()
    }

    /// X̄ at the joint's `q`; no wrench.
    pub(super) fn stand(&mut self, link: &Link, q: &[f64]) {
        link.joint.speed_map(q, &mut self.columns);
        (self.wrench, self.seen_wrench) = (Vector6::zeros(), Vector6::zeros());
    }

    /// X̄, V and the wrench that the body takes, at `(q, v̄, v̄̇)` of the joint.
    pub(super) fn advance(
        &mut self,
        link: &Link,
        (q, speeds, accelerations): (&[f64], &[f64], &[f64]),
        parent: &Motion<f64>,
        node: &Node,
    ) {
        self.stand(link, q);
        let (rotation, offset) = (
            &node.motion.placement.rotation,
            &node.motion.placement.offset,
        );
        let carried = turn_back(rotation, &shift_twist(&parent.twist, offset));
        let relative = combine(Vector6::zeros(), &self.columns, speeds);
        let mut rate = turn_back(rotation, &shift_twist(&parent.rate, offset));
        rate += bracket_product(&carried, &relative)
            + combine(Vector6::zeros(), &self.columns, accelerations);
        if !link.joint.structures().bias_acceleration.is_zero() {
            rate += link.joint.bias_acceleration(q, speeds);
        }
        self.twist = carried + relative;
        let momentum = link.inertia.apply(&self.twist);
        self.wrench = link.inertia.apply(&rate) - self.turned(link, &momentum);
        self.seen_wrench = node.wrench;
    }

    /// V of the joint's speeds, on top of what the parent carries along.
    pub(super) fn set_twist(&mut self, speeds: &[f64], carried: &Vector6<f64>, node: &Node) {
        let rotation = &node.motion.placement.rotation;
        self.twist =
            turn_back(rotation, carried) + combine(Vector6::zeros(), &self.columns, speeds);
    }

    /// The momentum of the body alone.
    pub(super) fn set_momentum(&mut self, link: &Link, node: &Node) {
        self.wrench = link.inertia.apply(&self.twist);
        self.seen_wrench = node.wrench;
    }

    /// The weight of the body, which is `seen` in world axes.
    pub(super) fn set_weight(
        &mut self,
        link: &Link,
        gravity: &Vector3<f64>,
        node: &Node,
        seen: &Vector6<f64>,
    ) {
        let gravity = apply_transposed(&node.motion.placement.rotation, gravity);
        self.weight = link.inertia.weight(&gravity);
        self.seen_weight = *seen;
    }

    /// `ad_Vᵀ h` of a momentum h, most of which is the body's own.
    ///
    /// `ω × I ω` is a difference of products that cancel where two moments are nearly equal, as the large ones of a slender body must
    /// be. `ω × (I − s 1) ω` is the same and does not, with the largest moment for s.
    pub(super) fn turned(&self, link: &Link, momentum: &Vector6<f64>) -> Vector6<f64> {
        let (moment, force) = split(momentum);
        let (angular, linear) = split(&self.twist);
        let whole = &link.inertia.inertia;
        let most = whole.xx.max(whole.yy).max(whole.zz);
        let mut rest = *whole;
        rest.xx -= most;
        rest.yy -= most;
        rest.zz -= most;
        // The rest of `moment` is exact where it is what I ω and the first moment make of it.
        let spun = rest.apply(&angular) + (moment - whole.apply(&angular));
        join(
            &add_cross(&cross(&spun, &angular), &force, &linear),
            &cross(&force, &angular),
        )
    }

    /// What the joint carries: the body's own inertia and what its children have handed over.
    pub(super) fn whole(
        link: &Link,
        node: &Node,
        handed: &ArticulatedInertia<f64>,
    ) -> ArticulatedInertia<f64> {
        match link.carries {
            true => handed
                .rotated(&node.motion.placement.rotation.transpose())
                .with_rigid(&link.inertia),
            false => ArticulatedInertia::from(&link.inertia),
        }
    }

    /// What the joint carries of a sweep's wrenches: the body's own, and in `node` those of its children.
    pub(super) fn carried(&self, node: &Node) -> Vector6<f64> {
        let others = node.wrench - self.seen_wrench;
        self.wrench + turn_back(&node.motion.placement.rotation, &others)
    }
}

impl Recursive {
    /// [`Recursive::articulate`] of a slender body: what its parent feels, in world axes.
    pub(super) fn articulate_slender(
        &mut self,
        index: usize,
        number: usize,
    ) -> Result<ArticulatedInertia<f64>, DynamicsError> {
        let (link, own) = (&self.links[index], &mut self.slender[number]);
        let node = &self.nodes[index];
        let rotation = &node.motion.placement.rotation;
        let mut inertia = Slender::whole(link, node, &self.inertias[index]);
        if !link.driven {
            let Slender {
                columns, pivots, ..
            } = own;
            link.joint
                .articulate(&mut inertia, columns, &link.armature, pivots)
                .map_err(|failure| self.mechanism.singular(index, &failure))?;
            for (seen, pivot) in self.pivots[link.speeds.clone()].iter_mut().zip(pivots) {
                seen.momentum = turn_out(rotation, &pivot.momentum);
                seen.inverse = pivot.inverse;
            }
        }
        Ok(inertia.rotated(rotation))
    }

    /// [`Recursive::eliminate`] of a slender body: what its parent feels, the wrench in the node.
    pub(super) fn eliminate_slender(
        &mut self,
        index: usize,
        number: usize,
        forces: &[f64],
    ) -> Result<ArticulatedInertia<f64>, DynamicsError> {
        let inertia = self.articulate_slender(index, number)?;
        let mut wrench = self.slender[number].carried(&self.nodes[index]);
        let link = &self.links[index];
        if !link.driven {
            let forces = &forces[link.speeds.clone()];
            self.reduce_in_child(index, number, &mut wrench, forces);
        }
        let node = &mut self.nodes[index];
        node.wrench = turn_out(&node.motion.placement.rotation, &wrench);
        Ok(inertia)
    }

    /// [`Recursive::resolve`] of a slender body that its parent carries along with `carried`.
    pub(super) fn resolve_slender(
        &mut self,
        index: usize,
        number: usize,
        carried: &Vector6<f64>,
        rates: &mut [f64],
    ) {
        let (link, own) = (&self.links[index], &mut self.slender[number]);
        let motion = &mut self.nodes[index].motion;
        let rotation = &motion.placement.rotation;
        own.twist = turn_back(rotation, carried);
        let loads = &self.loads[link.speeds.clone()];
        link.joint
            .resolve(&mut own.twist, &own.columns, &own.pivots, loads, rates);
        motion.twist = turn_out(rotation, &own.twist);
    }

    /// [`AnyJoint::reduce`](crate::erased::AnyJoint::reduce) of a slender body's joint, for a `wrench` in world axes.
    pub(super) fn reduce_slender(
        &mut self,
        index: usize,
        number: usize,
        wrench: &Vector6<f64>,
        forces: &[f64],
    ) -> Vector6<f64> {
        let rotation = self.nodes[index].motion.placement.rotation;
        let mut turned = turn_back(&rotation, wrench);
        self.reduce_in_child(index, number, &mut turned, forces);
        turn_out(&rotation, &turned)
    }

    /// [`AnyJoint::reduce`](crate::erased::AnyJoint::reduce) of a slender body's joint, for a `wrench` in child axes.
    fn reduce_in_child(
        &mut self,
        index: usize,
        number: usize,
        wrench: &mut Vector6<f64>,
        forces: &[f64],
    ) {
        let (link, own) = (&self.links[index], &self.slender[number]);
        let loads = &mut self.loads[link.speeds.clone()];
        link.joint
            .reduce(wrench, &own.columns, &own.pivots, forces, loads);
    }

    /// `X̄ᵀF` of a slender body's joint into `out`, with all of F into the node.
    pub(super) fn gather_slender(&mut self, index: usize, number: usize, out: &mut [f64]) {
        let (link, own) = (&self.links[index], &self.slender[number]);
        let node = &mut self.nodes[index];
        let wrench = own.carried(node);
        link.joint.gather(&wrench, &own.columns, out);
        node.wrench = turn_out(&node.motion.placement.rotation, &wrench);
    }

    /// [`Recursive::turned_momenta`] of a slender body.
    pub(super) fn turned_momenta_slender(
        &mut self,
        index: usize,
        number: usize,
        out: &mut [f64],
    ) -> Vector6<f64> {
        let (link, own) = (&self.links[index], &self.slender[number]);
        let node = &mut self.nodes[index];
        let rotation = &node.motion.placement.rotation;
        let momentum = own.carried(node);
        let others = node.motion.rate - own.seen_weight;
        let acting = own.weight + turn_back(rotation, &others);
        let turned = acting + own.turned(link, &momentum);
        link.joint.gather(&turned, &own.columns, out);
        node.motion.rate = turn_out(rotation, &acting);
        node.wrench = turn_out(rotation, &momentum);
        momentum
    }
}
