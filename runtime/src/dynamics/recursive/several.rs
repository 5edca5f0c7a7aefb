//! Joints that carry several bodies, and those with rotors at ports, in the recursion over articulated inertias.
//!
//! All at the origin of the parent's frame: with `U_i = A_i X̄_i` of body i, whose articulated inertia is A_i, the degrees of freedom of the
//! joint are eliminated together,
//!
//! ```text
//! U = Σ U_i    D = Σ X̄_iᵀ U_i    A = Σ A_i − U D⁻¹ Uᵀ
//! t = D⁻¹ (τ̄ − Σ X̄_iᵀ p_i)      p = Σ p_i + U t      v̄̇ = t − D⁻¹ Uᵀ a
//! ```
//!
//! with p_i the wrench that body i takes at v̄̇ = 0, and a the acceleration of the parent. In an inward sweep the bodies come one after the
//! other, the last one first; what hangs on them has come before. Recursions of this kind are known for clusters of
//! bodies whose maps are written by hand: Chignoli et al., arXiv 2311.13732.

use super::Recursive;
use super::block::{factorize, reduce_inertia, solve};
use super::inverse::MOST_FREEDOMS;
use super::sweeps::{combine, whole};
use crate::dynamics::DynamicsError;
use crate::mechanism::Mechanism;
use crate::spatial::{ArticulatedInertia, shift_twist, shift_wrench};
use crate::steps::{PivotFailure, rounding};
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::{Matrix6, Vector3, Vector6};

/// The bodies of each joint that carries several, or has rotors at ports: all whose rows of M̄ are found together.
pub(super) fn groups(mechanism: &Mechanism) -> impl Iterator<Item = Range<usize>> {
    let bodies = mechanism
        .joints()
        .map(|(index, _)| mechanism.carried(index));
    bodies.filter(|bodies| bodies.len() > 1 || !mechanism.port_armature(bodies.start).is_empty())
}

/// A joint that carries several bodies or has rotors at ports, and the factors of its elimination.
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub(super) bodies: Range<usize>,
    pub(super) speeds: Range<usize>,
    parent: Option<usize>,
    driven: bool,
    /// Whether it is the first in an inward sweep of all that hangs on its parent.
    last: bool,
    /// A at the parent's frame: of all bodies, then what the parent feels of it.
    inertia: ArticulatedInertia<f64>,
    /// U, one column per speed.
    yields: Vec<Vector6<f64>>,
    /// D, then its factors, S×S row by row.
    block: Vec<f64>,
    /// What rounding can make of the diagonal of D.
    roundings: Vec<f64>,
    /// p at the parent's frame.
    wrench: Vector6<f64>,
    /// `−Σ X̄_iᵀ p_i`.
    loads: Vec<f64>,
}

impl Group {
    /// Those of a mechanism, in the order of [`groups`].
    pub(super) fn all(mechanism: &Mechanism) -> Vec<Self> {
        let new = |bodies| Self::new(mechanism, bodies);
        groups(mechanism).map(new).collect()
    }

    fn new(mechanism: &Mechanism, bodies: Range<usize>) -> Self {
        let first = &mechanism.bodies()[bodies.start];
        let (parent, size) = (first.parent(), first.ranges().speeds.len());
        let mut later = mechanism.bodies()[bodies.end..].iter();
        Self {
            speeds: first.ranges().speeds.clone(),
            parent,
            driven: mechanism.is_driven(bodies.start),
            last: later.all(|body| body.parent() != parent),
            bodies,
            inertia: ArticulatedInertia::zero(),
            yields: vec![Vector6::zeros(); size],
            block: vec![0.0; size * size],
            roundings: vec![0.0; size],
            wrench: Vector6::zeros(),
            loads: vec![0.0; size],
        }
    }

    /// Of no body.
    fn clear_inertia(&mut self) {
        self.inertia = ArticulatedInertia::zero();
        self.yields.fill(Vector6::zeros());
        self.block.fill(0.0);
        self.roundings.fill(0.0);
    }

    /// Adds one body, with its articulated inertia at its own frame, `offset` from the parent's.
    fn add_inertia(
        &mut self,
        inertia: &ArticulatedInertia<f64>,
        columns: &[Vector6<f64>],
        offset: &Vector3<f64>,
    ) {
        let size = columns.len();
        for (j, column) in columns.iter().enumerate() {
            let momentum = inertia.apply(column);
            for (i, other) in columns.iter().enumerate().skip(j) {
                self.block[i * size + j] += other.dot(&momentum);
            }
            self.roundings[j] += rounding(inertia, column);
            self.yields[j] += shift_wrench(&momentum, offset);
        }
        self.inertia.add(&inertia.shifted(offset));
    }

    /// Eliminates the degrees of freedom; `load` is what is added to D.
    fn factorize(
        &mut self,
        load: impl Fn(usize, usize) -> f64,
        limits: bool,
    ) -> Result<(), PivotFailure> {
        let size = self.yields.len();
        for i in 0..size {
            for j in 0..=i {
                self.block[i * size + j] += load(i, j);
            }
        }
        let roundings = &self.roundings;
        let limit = |i: usize| if limits { roundings[i] } else { 0.0 };
        factorize(&mut self.block, size, limit)?;
        reduce_inertia(&mut self.inertia, &self.yields, &self.block);
        Ok(())
    }

    /// Of no body.
    fn clear_wrench(&mut self) {
        self.wrench = Vector6::zeros();
        self.loads.fill(0.0);
    }

    /// Adds the wrench on one body at its own frame, `offset` from the parent's.
    fn add_wrench(
        &mut self,
        wrench: &Vector6<f64>,
        columns: &[Vector6<f64>],
        offset: &Vector3<f64>,
    ) {
        for (load, column) in self.loads.iter_mut().zip(columns) {
            *load -= column.dot(wrench);
        }
        self.wrench += shift_wrench(wrench, offset);
    }

    /// t into `loads` under generalised `forces`, and p; of a driven joint there is no t.
    fn yield_to(&mut self, forces: &[f64], loads: &mut [f64]) {
        if self.driven {
            return loads.fill(0.0);
        }
        for (own, force) in self.loads.iter_mut().zip(forces) {
            *own += force;
        }
        solve(&self.block, &mut self.loads);
        loads.copy_from_slice(&self.loads);
        for (load, momentum) in self.loads.iter().zip(&self.yields) {
            self.wrench += momentum * *load;
        }
    }

    /// `v̄̇ = t − D⁻¹ Uᵀ a` under the acceleration a of the parent.
    pub(super) fn resolve(&self, motion: &Vector6<f64>, loads: &[f64], rates: &mut [f64]) {
        if self.driven {
            return rates.fill(0.0);
        }
        let mut carried = [0.0; MOST_FREEDOMS];
        let carried = &mut carried[..rates.len()];
        for (entry, momentum) in carried.iter_mut().zip(&self.yields) {
            *entry = momentum.dot(motion);
        }
        solve(&self.block, carried);
        for ((rate, load), carried) in rates.iter_mut().zip(loads).zip(carried) {
            *rate = load - *carried;
        }
    }
}

impl Group {
    /// What the rates of the speeds under unit wrenches on one body, at its frame, do to one another: `l D⁻¹ lᵀ`, with a row `l_i = w_iᵀ X̄` for each of the
    /// wrenches w. These become what the parent feels, at the body's frame.
    pub(super) fn yield_wrenches(
        &self,
        columns: &[Vector6<f64>],
        offset: &Vector3<f64>,
        wrenches: &mut [Vector6<f64>; 6],
    ) -> Matrix6<f64> {
        let size = columns.len();
        let (mut loads, mut rates) = ([[0.0; MOST_FREEDOMS]; 6], [[0.0; MOST_FREEDOMS]; 6]);
        for (row, wrench) in wrenches.iter_mut().enumerate() {
            for (load, column) in loads[row].iter_mut().zip(columns) {
                *load = column.dot(wrench);
            }
            rates[row] = loads[row];
            solve(&self.block, &mut rates[row][..size]);
            for (rate, momentum) in rates[row].iter().zip(&self.yields) {
                *wrench -= shift_wrench(momentum, &-offset) * *rate;
            }
        }
        Matrix6::from_fn(|i, j| {
            let terms = loads[i][..size].iter().zip(&rates[j]);
            terms.map(|(load, rate)| load * rate).sum()
        })
    }
}

impl Recursive {
    /// Takes one body of a group in an inward sweep over inertias; the first body of the joint completes it, and hands over what the parent feels.
    pub(super) fn articulate_member(
        &mut self,
        index: usize,
        group: usize,
    ) -> Result<(), DynamicsError> {
        let mut groups = core::mem::take(&mut self.groups);
        let mut inertias = core::mem::take(&mut self.inertias);
        let inertia = whole(&self.links[index], &self.nodes[index], &inertias[index]);
        let into = (&mut groups[group], &mut inertias);
        let done = self.take_inertia(index, &inertia, into, |_, _| 0.0, true);
        (self.groups, self.inertias) = (groups, inertias);
        done
    }

    /// Takes the articulated `inertia` of one body of a group; with the first body of the joint, what its parent feels of all of them goes to that
    /// one's entry. `load` is what is added to D beside rotors; `limits` says whether pivots must stand above what rounding can make of them, or
    /// above 0.
    pub(super) fn take_inertia(
        &self,
        index: usize,
        inertia: &ArticulatedInertia<f64>,
        (own, inertias): (&mut Group, &mut Vec<ArticulatedInertia<f64>>),
        load: impl Fn(usize, usize) -> f64,
        limits: bool,
    ) -> Result<(), DynamicsError> {
        let link = &self.links[index];
        if index + 1 == own.bodies.end {
            own.clear_inertia();
        }
        let offset = &self.nodes[index].motion.placement.offset;
        own.add_inertia(inertia, &self.columns[link.columns.clone()], offset);
        if index > own.bodies.start {
            return Ok(());
        }
        if !own.driven {
            let added = |i: usize, j: usize| {
                let rotors = self.rotors.iter().filter(|rotor| rotor.body == index);
                let rotors = load(i, j) + rotors.map(|rotor| rotor.load(i, j)).sum::<f64>();
                match i == j {
                    true => rotors + link.armature.get(i).copied().unwrap_or(0.0),
                    false => rotors,
                }
            };
            own.factorize(added, limits)
                .map_err(|failure| self.mechanism.singular(index, &failure))?;
        }
        if let Some(parent) = own.parent {
            match own.last {
                true => inertias[parent] = own.inertia,
                false => inertias[parent].add(&own.inertia),
            }
        }
        Ok(())
    }

    /// Takes the `wrench` on one body of a group, at its own frame, in an inward sweep, after [`Recursive::articulate_member`]; the first body of the
    /// joint completes it, and gives what its parent feels, at the parent's frame.
    pub(super) fn load_member(
        &mut self,
        index: usize,
        group: usize,
        wrench: &Vector6<f64>,
        forces: &[f64],
    ) -> Option<Vector6<f64>> {
        let mut groups = core::mem::take(&mut self.groups);
        let mut loads = core::mem::take(&mut self.loads);
        let felt = self.take_wrench(index, wrench, &mut groups[group], (forces, &mut loads));
        (self.groups, self.loads) = (groups, loads);
        felt
    }

    /// [`Recursive::load_member`] of a group that stands elsewhere, t into `loads`; both have one entry per speed of the mechanism.
    pub(super) fn take_wrench(
        &self,
        index: usize,
        wrench: &Vector6<f64>,
        own: &mut Group,
        (forces, loads): (&[f64], &mut [f64]),
    ) -> Option<Vector6<f64>> {
        let link = &self.links[index];
        if index + 1 == own.bodies.end {
            own.clear_wrench();
        }
        let offset = &self.nodes[index].motion.placement.offset;
        own.add_wrench(wrench, &self.columns[link.columns.clone()], offset);
        if index > own.bodies.start {
            return None;
        }
        let speeds = own.speeds.clone();
        own.yield_to(&forces[speeds.clone()], &mut loads[speeds]);
        Some(own.wrench)
    }

    /// What the parent of a group feels, at its own frame, of a `wrench` on one of its bodies alone and of `forces` on its speeds, which are one
    /// entry per speed of the joint.
    pub(super) fn yield_member(
        &mut self,
        index: usize,
        group: usize,
        wrench: &Vector6<f64>,
        forces: &[f64],
    ) -> Vector6<f64> {
        let (link, own) = (&self.links[index], &mut self.groups[group]);
        own.clear_wrench();
        let offset = &self.nodes[index].motion.placement.offset;
        own.add_wrench(wrench, &self.columns[link.columns.clone()], offset);
        own.yield_to(forces, &mut self.loads[own.speeds.clone()]);
        own.wrench
    }

    /// Takes one body of a group in an outward sweep: its twist, and with the first body of the joint the rates of its speeds.
    pub(super) fn resolve_member(&mut self, index: usize, group: usize, rates: &mut [f64]) {
        let (link, own) = (&self.links[index], &self.groups[group]);
        let parent = link.parent.map_or(&self.world, |p| &self.nodes[p]);
        let motion = parent.motion.twist;
        let rates = &mut rates[link.speeds.clone()];
        if index == own.bodies.start {
            own.resolve(&motion, &self.loads[link.speeds.clone()], rates);
        }
        let node = &mut self.nodes[index];
        let carried = shift_twist(&motion, &node.motion.placement.offset);
        node.motion.twist = combine(carried, &self.columns[link.columns.clone()], rates);
    }

    /// Sums over the bodies of each joint: entries with one for each body and each speed, into one per speed.
    pub(super) fn fold(&self, columns: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for link in &self.links {
            let own = out[link.speeds.clone()].iter_mut();
            for (sum, entry) in own.zip(&columns[link.columns.clone()]) {
                *sum += entry;
            }
        }
    }
}
