//! `(M̄ + W)⁻¹` in O(n), with W a block for each joint: what stiff springs and dampers at joints make of the mass matrix in an implicit step.
//!
//! The articulated recursion, joint by joint instead of degree of freedom by freedom: with Y = I X̄ and `D = X̄ᵀY + W`, `I ← I − Y D⁻¹ Yᵀ`. What is stiff stands in D, and
//! is never a difference.

use super::Recursive;
use super::block::{factorize, reduce_inertia, solve};
use super::inverse::MOST_FREEDOMS;
use super::link::Link;
use super::several::Group;
use super::sweeps::{combine, whole};
use crate::dynamics::DynamicsError;
use crate::elements::{JointSlopes, Target};
use crate::mechanism::Mechanism;
use crate::spatial::{ArticulatedInertia, shift_twist, shift_wrench};
use crate::steps::{PivotFailure, Variation};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector6;

/// The factors of M̄ + W, and room for solving with them.
#[derive(Clone, Debug)]
pub struct LoadedMass {
    /// Y, one column per speed; of joints that carry several bodies, `groups` have it.
    yields: Vec<Vector6<f64>>,
    /// LDLᵀ of each joint's block, S×S row by row: D on the diagonal, L below.
    blocks: Vec<Vec<f64>>,
    inertias: Vec<ArticulatedInertia<f64>>,
    wrenches: Vec<Vector6<f64>>,
    motions: Vec<Vector6<f64>>,
    /// Joints that carry several bodies.
    groups: Vec<Group>,
    loads: Vec<f64>,
}

impl LoadedMass {
    /// Room for the factors of a mechanism.
    pub fn new(mechanism: &Mechanism) -> Self {
        let count = mechanism.bodies().len();
        let size = |body: &crate::mechanism::Body| body.ranges().speeds.len();
        let bodies = mechanism.bodies().iter();
        Self {
            yields: vec![Vector6::zeros(); mechanism.layout().speeds],
            blocks: bodies
                .map(|body| vec![0.0; size(body) * size(body)])
                .collect(),
            inertias: vec![ArticulatedInertia::zero(); count],
            wrenches: vec![Vector6::zeros(); count],
            motions: vec![Vector6::zeros(); count],
            groups: Group::all(&Link::all(mechanism)),
            loads: vec![0.0; mechanism.layout().speeds],
        }
    }
}

impl Recursive {
    /// Places the mechanism at (q, v̄), for all that follows here; how each joint's forces change with its own motion into `slopes`.
    pub fn stand_loaded(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        variations: &mut [Variation<f64>],
        slopes: &mut JointSlopes,
    ) {
        self.advance(q, speeds, None);
        for index in 0..self.links.len() {
            let own = self.links[index].variations.clone();
            self.vary(index, (q, speeds, &[]), &mut variations[own]);
        }
        slopes.clear();
        self.add_slopes(q, speeds, variations, Target::Joints(slopes));
    }

    /// Factorises M̄ + W where the mechanism stands; `load` gives entry (i, j) of W of a joint, of which the symmetric part is taken.
    ///
    /// # Errors
    /// The first pivot that is not positive.
    pub fn factorize_loaded(
        &self,
        load: impl Fn(usize, usize, usize) -> f64,
        out: &mut LoadedMass,
    ) -> Result<(), DynamicsError> {
        for index in (0..self.links.len()).rev() {
            let (link, node) = (&self.links[index], &self.nodes[index]);
            let mut inertia = whole(link, node, &out.inertias[index]);
            if let Some(group) = link.group {
                let own = &mut out.groups[group];
                let joint = own.bodies.start;
                let symmetric = |i, j| 0.5 * (load(joint, i, j) + load(joint, j, i));
                self.take_inertia(index, &inertia, (own, &mut out.inertias), symmetric, false)?;
                continue;
            }
            if !link.driven {
                let symmetric = |i, j| 0.5 * (load(index, i, j) + load(index, j, i));
                self.yield_joint(index, symmetric, &mut inertia, out)
                    .map_err(|failure| self.mechanism.singular(index, &failure))?;
            }
            if let Some(parent) = link.parent {
                let carried = inertia.shifted(&node.motion.placement.offset);
                match link.last {
                    true => out.inertias[parent] = carried,
                    false => out.inertias[parent].add(&carried),
                }
            }
        }
        Ok(())
    }

    /// One joint's Y and D, and what its parent feels.
    fn yield_joint(
        &self,
        index: usize,
        load: impl Fn(usize, usize) -> f64,
        inertia: &mut ArticulatedInertia<f64>,
        out: &mut LoadedMass,
    ) -> Result<(), PivotFailure> {
        let link = &self.links[index];
        let columns = &self.columns[link.columns.clone()];
        let yields = &mut out.yields[link.speeds.clone()];
        for (column, own) in columns.iter().zip(&mut *yields) {
            *own = inertia.apply(column);
        }
        let (block, size) = (&mut out.blocks[index], columns.len());
        for i in 0..size {
            for j in 0..=i {
                block[i * size + j] = columns[i].dot(&yields[j]) + load(i, j);
            }
            block[i * size + i] += link.armature.get(i).copied().unwrap_or(0.0);
        }
        factorize(block, size, |_| 0.0)?;
        reduce_inertia(inertia, yields, block);
        Ok(())
    }

    /// `(M̄ + W)⁻¹ x` in place; 0 for the speeds of driven joints.
    pub fn solve_loaded(&self, factors: &mut LoadedMass, x: &mut [f64]) {
        factors.wrenches.fill(Vector6::zeros());
        for index in (0..self.links.len()).rev() {
            let link = &self.links[index];
            if let Some(group) = link.group {
                let own = &mut factors.groups[group];
                let wrench = factors.wrenches[index];
                let taken = (&*x, &mut factors.loads[..]);
                let felt = self.take_wrench(index, &wrench, own, taken);
                if let (Some(felt), Some(parent)) = (felt, link.parent) {
                    factors.wrenches[parent] += felt;
                }
                continue;
            }
            let own = &mut x[link.speeds.clone()];
            if link.driven {
                own.fill(0.0);
            } else {
                let wrench = &mut factors.wrenches[index];
                for (entry, column) in own.iter_mut().zip(&self.columns[link.columns.clone()]) {
                    *entry -= column.dot(wrench);
                }
                solve(&factors.blocks[index], own);
                for (entry, column) in own.iter().zip(&factors.yields[link.speeds.clone()]) {
                    *wrench += column * *entry;
                }
            }
            if let Some(parent) = link.parent {
                let offset = &self.nodes[index].motion.placement.offset;
                let carried = shift_wrench(&factors.wrenches[index], offset);
                factors.wrenches[parent] += carried;
            }
        }
        self.carry_outward(factors, x);
    }

    /// Takes off what the motion of the parents does to each joint.
    fn carry_outward(&self, factors: &mut LoadedMass, x: &mut [f64]) {
        for (index, link) in self.links.iter().enumerate() {
            let offset = &self.nodes[index].motion.placement.offset;
            let above = link.parent.map(|parent| factors.motions[parent]);
            let above = above.unwrap_or_default();
            let mut motion = shift_twist(&above, offset);
            if let Some(group) = link.group {
                let (own, x) = (&factors.groups[group], &mut x[link.speeds.clone()]);
                if link.leads {
                    own.resolve(&above, &factors.loads[link.speeds.clone()], x);
                }
                factors.motions[index] = combine(motion, &self.columns[link.columns.clone()], x);
                continue;
            }
            if !link.driven {
                let (own, mut carried) = (&mut x[link.speeds.clone()], [0.0; MOST_FREEDOMS]);
                let carried = &mut carried[..own.len()];
                for (entry, column) in carried.iter_mut().zip(&factors.yields[link.speeds.clone()])
                {
                    *entry = column.dot(&motion);
                }
                solve(&factors.blocks[index], carried);
                for ((entry, carried), column) in own
                    .iter_mut()
                    .zip(carried)
                    .zip(&self.columns[link.columns.clone()])
                {
                    *entry -= *carried;
                    motion += column * *entry;
                }
            }
            factors.motions[index] = motion;
        }
    }
}
