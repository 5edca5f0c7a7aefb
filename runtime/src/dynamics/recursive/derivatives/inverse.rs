//! Derivatives of inverse dynamics.

use super::acting::Acting;
use super::coriolis::Coriolis;
use super::{Branch, Sensitivity, WORLD, branches, fold, in_child};
use crate::dynamics::DynamicsError;
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::mechanism::Mechanism;
use crate::scalar::Scalar;
use crate::spatial::{bracket_dual_product, shift_wrench, split};
use crate::steps::Variation;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Vector3, Vector6};

/// Four numbers side by side, for vector instructions: where one of them crosses a line of the cache, reading it takes twice as long.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Four([f64; 4]);

impl Four {
    const ZERO: Self = Self([0.0; 4]);
}

/// What a degree of freedom and a speed of a joint meet the [`Below`] of a joint under it with: two of X̄, W and W_v, and the angular parts of U and X̄.
type Above = [Four; 9];

/// What a degree of freedom and a speed of a joint meet the [`Above`] of a joint over it with: the two wrenches that they raise, two of `N X̄`, two of
/// `Bᵀ X̄`. Each product of both is one entry of each derivative on either side of the diagonal.
type Below = [Four; 9];

/// `∂τ̄/∂ϕ` and `∂τ̄/∂v̄` of inverse dynamics; `∂τ̄/∂v̄̇` is the mass matrix.
#[derive(Clone, Debug)]
pub struct InverseDerivatives {
    pub(super) by_local: Sensitivity,
    pub(super) by_speeds: Sensitivity,
    branches: Vec<Branch>,
    /// One for each body and each degree of freedom of its joint, as the next two.
    pub(super) variations: Vec<Variation<f64>>,
    above: Vec<Above>,
    /// Products with one below.
    met: Vec<Four>,
    /// One a body.
    coriolis: Vec<Coriolis>,
    /// One a body: from its parent's frame to its own, in world axes.
    offsets: Vec<Vector3<f64>>,
    /// Whether each degree of freedom is a speed, at the same place.
    square: bool,
    /// Both derivatives before they are summed over the bodies of each joint, where joints carry several.
    unfolded: Option<[Sensitivity; 2]>,
    acting: Acting,
}

impl InverseDerivatives {
    /// Room for the derivatives of `mechanism`.
    pub fn new(mechanism: &Mechanism) -> Self {
        let (speeds, freedoms) = (mechanism.layout().speeds, mechanism.layout().freedoms);
        let (branches, variations) = (branches(mechanism), mechanism.variations());
        Self {
            by_local: Sensitivity::new(speeds, freedoms),
            by_speeds: Sensitivity::new(speeds, speeds),
            square: branches
                .iter()
                .all(|branch| branch.freedoms == branch.speeds),
            offsets: vec![Vector3::zeros(); branches.len()],
            branches,
            unfolded: fold::room(mechanism),
            variations: vec![Variation::zero(); variations],
            above: vec![[Four::ZERO; 9]; variations],
            met: vec![Four::ZERO; variations],
            coriolis: vec![Coriolis::zero(); mechanism.bodies().len()],
            acting: Acting::new(mechanism),
        }
    }

    /// `∂τ̄/∂ϕ`: a row a speed, a column a degree of freedom.
    pub const fn by_local(&self) -> &Sensitivity {
        &self.by_local
    }

    /// `∂τ̄/∂v̄`: a row and a column a speed.
    pub const fn by_speeds(&self) -> &Sensitivity {
        &self.by_speeds
    }

    /// Swaps both derivatives.
    fn swap(&mut self, other: &mut [Sensitivity; 2]) {
        core::mem::swap(&mut self.by_local, &mut other[0]);
        core::mem::swap(&mut self.by_speeds, &mut other[1]);
    }

    /// How one effort changes as all of ϕ and v̄ grow alike.
    pub fn sum_of_row(&self, row: usize) -> f64 {
        let of = |part: &Sensitivity| -> f64 {
            let columns = 0..part.columns();
            columns.map(|column| part.entry(row, column)).sum()
        };
        of(&self.by_local) + of(&self.by_speeds)
    }

    /// Takes both over from rows that hold them side by side, one per speed.
    ///
    /// # Errors
    /// Rows for another mechanism.
    pub fn read(&mut self, rows: &[f64]) -> Result<(), DynamicsError> {
        let width = self.by_local.columns() + self.by_speeds.columns();
        if rows.len() != self.by_local.rows() * width {
            return Err(DynamicsError::ForeignResults);
        }
        for (i, row) in rows.chunks_exact(width.max(1)).enumerate() {
            let rest = self.by_local.read_row(i, row);
            self.by_speeds.read_row(i, rest);
        }
        Ok(())
    }
}

impl Recursive {
    /// The derivatives of [`Recursive::inverse_dynamics`] in ϕ and v̄ at (q, v̄, v̄̇) into `out`.
    ///
    /// # Errors
    /// When a vector has the wrong size; when something acts on the mechanism that derivatives do not cover.
    pub fn inverse_dynamics_derivatives(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        accelerations: &[f64],
        out: &mut InverseDerivatives,
    ) -> Result<(), DynamicsError> {
        self.check(q, &[("speeds", speeds), ("accelerations", accelerations)])?;
        self.check_differentiable(&out.branches)?;
        self.advance(q, speeds, Some(accelerations));
        self.differentiate_needed(q, speeds, accelerations, out);
        self.check_found((q, speeds), &[&out.by_local, &out.by_speeds])
    }

    /// What is left of [`Recursive::inverse_dynamics_derivatives`] once the bodies move.
    pub(super) fn differentiate_needed(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        accelerations: &[f64],
        out: &mut InverseDerivatives,
    ) {
        if self.acted_on {
            self.act_and_vary((q, speeds), Some(accelerations), &mut out.acting);
            // Elements between bodies reach from branch to branch, where no joint meets another.
            out.by_local.clear();
            out.by_speeds.clear();
        }
        match out.unfolded.take() {
            None => self.differentiate_pairs(q, speeds, accelerations, out),
            Some(mut unfolded) => {
                out.swap(&mut unfolded);
                self.differentiate_pairs(q, speeds, accelerations, out);
                out.swap(&mut unfolded);
                self.fold_locals(&unfolded[0], &mut out.by_local);
                self.fold_speeds(&unfolded[1], &mut out.by_speeds);
                out.unfolded = Some(unfolded);
            }
        }
        if self.acted_on {
            out.by_local.subtract(&out.acting.by_local);
            out.by_speeds.subtract(&out.acting.by_speeds);
        }
    }

    /// The derivatives of what the wrenches of the nodes amount to.
    fn differentiate_pairs(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        accelerations: &[f64],
        out: &mut InverseDerivatives,
    ) {
        for (index, node) in self.nodes.iter().enumerate() {
            out.coriolis[index] = Coriolis::of(&node.rigid, &node.motion.twist);
            out.offsets[index] = node.motion.placement.offset;
        }
        self.sum_subtrees(&mut out.coriolis);
        for index in 0..self.links.len() {
            let own = &mut out.variations[self.links[index].variations.clone()];
            self.vary(index, (q, speeds, accelerations), own);
            self.differentiate_joint(index, q, out);
        }
    }

    /// Inward: F, N and B of each body and all that hangs on it.
    pub(super) fn sum_subtrees(&mut self, coriolis: &mut [Coriolis]) {
        for index in (0..self.links.len()).rev() {
            let Some(parent) = self.links[index].parent else {
                continue;
            };
            let (before, rest) = self.nodes.split_at_mut(index);
            let (parent_node, own) = (&mut before[parent], &rest[0]);
            let offset = &own.motion.placement.offset;
            parent_node.rigid = parent_node.rigid.combine(&own.rigid.shifted(offset));
            parent_node.wrench += shift_wrench(&own.wrench, offset);
            let carried = coriolis[index].shifted(offset);
            coriolis[parent].add(&carried);
        }
    }

    /// Rows and columns of one joint against itself and those above it.
    fn differentiate_joint(&self, index: usize, q: &[f64], out: &mut InverseDerivatives) {
        let (link, node, coriolis) = (&self.links[index], &self.nodes[index], out.coriolis[index]);
        let branch = out.branches[index];
        let columns = &self.columns[link.columns.clone()];
        for slot in branch.freedoms.0..branch.freedoms.1 {
            let variation = &out.variations[slot];
            let b = slot - branch.freedoms.0;
            let (drift, _) = split(&variation.drift);
            let raised = node.rigid.apply(&variation.rate) + coriolis.apply(&drift);
            for (speed, column) in link.columns.clone().zip(columns) {
                out.by_local.set(speed, slot, column.dot(&raised));
            }
            let turned = raised - bracket_dual_product(&variation.local, &node.wrench);
            let below = match columns.get(b) {
                // More degrees of freedom than speeds.
                None => {
                    let zero = Vector6::zeros();
                    out.above[slot] = above(&zero, variation);
                    below(&[turned, zero], &zero, &Vector3::zeros())
                }
                Some(column) => {
                    let (turn, _) = split(column);
                    let faster = node.rigid.apply(&variation.speed_rate) + coriolis.apply(&turn);
                    for (speed, column) in link.columns.clone().zip(columns) {
                        out.by_speeds
                            .set(speed, branch.speeds.0 + b, column.dot(&faster));
                    }
                    out.above[slot] = above(column, variation);
                    let momentum = node.rigid.apply(column);
                    let transposed = coriolis.apply_transposed(column);
                    below(&[turned, faster], &momentum, &transposed)
                }
            };
            meet_above(index, &below, out);
            match out.square {
                true => climb_square(index, slot, out),
                false => climb_pairs(index, slot, out),
            }
        }
        if !link.joint.structures().speed_map.is_constant() {
            self.add_own_gradient(index, q, out);
        }
    }

    /// `∂X̄ᵀF` of one joint.
    fn add_own_gradient(&self, index: usize, q: &[f64], out: &mut InverseDerivatives) {
        let (link, node) = (&self.links[index], &self.nodes[index]);
        let mut gradient = [0.0; MOST_FREEDOMS * MOST_FREEDOMS];
        let rows = link.speeds.len();
        let gradient = &mut gradient[..rows * link.freedoms.len()];
        let wrench = in_child(node, &node.wrench);
        let q = &q[link.configuration.clone()];
        link.joint.effort_gradient(q, &wrench, gradient);
        for (slot, column) in link
            .variations
            .clone()
            .zip(gradient.chunks_exact(rows.max(1)))
        {
            for (speed, entry) in link.columns.clone().zip(column) {
                let entry = out.by_local.entry(speed, slot) + entry;
                out.by_local.set(speed, slot, entry);
            }
        }
    }
}

/// The products of one degree of freedom and speed with those of all joints above into their rows and columns.
fn climb_pairs(index: usize, slot: usize, out: &mut InverseDerivatives) {
    let own_speed = speed_of(&out.branches[index], slot);
    let (locals, speeds) = (out.by_local.columns, out.by_speeds.columns);
    let (by_local, by_speeds) = (&mut out.by_local.entries, &mut out.by_speeds.entries);
    let mut body = out.branches[index].parent;
    while body != WORLD {
        let branch = &out.branches[body];
        for other in branch.freedoms.0..branch.freedoms.1 {
            let Four([raised, faster, local, speed]) = out.met[other];
            let other_speed = speed_of(branch, other);
            if let Some(row) = other_speed {
                by_local[row * locals + slot] = raised;
            }
            if let Some(row) = own_speed {
                by_local[row * locals + other] = local;
            }
            if let (Some(above), Some(own)) = (other_speed, own_speed) {
                by_speeds[above * speeds + own] = faster;
                by_speeds[own * speeds + above] = speed;
            }
        }
        body = branch.parent;
    }
}

/// The same where each degree of freedom is a speed.
fn climb_square(index: usize, slot: usize, out: &mut InverseDerivatives) {
    let size = out.by_local.columns;
    let (local_above, local_own) = out.by_local.entries.split_at_mut(slot * size);
    let (speed_above, speed_own) = out.by_speeds.entries.split_at_mut(slot * size);
    let (local_own, speed_own) = (&mut local_own[..size], &mut speed_own[..size]);
    let mut body = out.branches[index].parent;
    while body != WORLD {
        let branch = &out.branches[body];
        let others = branch.freedoms.0..branch.freedoms.1;
        for (other, met) in others.clone().zip(&out.met[others]) {
            let Four([raised, faster, local, speed]) = *met;
            local_above[other * size + slot] = raised;
            speed_above[other * size + slot] = faster;
            local_own[other] = local;
            speed_own[other] = speed;
        }
        body = branch.parent;
    }
}

/// The products of one degree of freedom and speed with those of all joints above, by their degrees of freedom.
// On its own and through memory, so that the four products stay side by side in vector registers.
#[inline(never)]
fn meet_above(index: usize, below: &Below, out: &mut InverseDerivatives) {
    let mut below = *below;
    let mut branch = &out.branches[index];
    let mut body = index;
    while branch.parent != WORLD {
        shift(&mut below, &out.offsets[body]);
        body = branch.parent;
        branch = &out.branches[body];
        let (first, end) = branch.freedoms;
        match end - first {
            1 => out.met[first] = products(&out.above[first], &below),
            _ => meet_joint(&out.above[first..end], &below, &mut out.met[first..end]),
        }
    }
}

/// The same for the degrees of freedom of one joint.
// On its own, so that they are not done side by side, for which all numbers would have to be laid out anew.
#[inline(never)]
fn meet_joint(above: &[Above], below: &Below, met: &mut [Four]) {
    for (met, above) in met.iter_mut().zip(above) {
        *met = products(above, below);
    }
}

/// The speed that stands at the same place in its joint as a degree of freedom.
#[inline(always)]
fn speed_of(branch: &Branch, slot: usize) -> Option<usize> {
    let speed = branch.speeds.0 + (slot - branch.freedoms.0);
    (speed < branch.speeds.1).then_some(speed)
}

#[inline(always)]
fn above(column: &Vector6<f64>, variation: &Variation<f64>) -> Above {
    let mut above = [Four::ZERO; 9];
    for i in 0..6 {
        let (rate, speed_rate) = (variation.rate[i], variation.speed_rate[i]);
        above[i] = Four([column[i], column[i], rate, speed_rate]);
    }
    for i in 0..3 {
        above[6 + i] = Four([0.0, 0.0, variation.drift[i], column[i]]);
    }
    above
}

#[inline(always)]
fn below(raised: &[Vector6<f64>; 2], momentum: &Vector6<f64>, transposed: &Vector3<f64>) -> Below {
    let mut below = [Four::ZERO; 9];
    for i in 0..6 {
        below[i] = Four([raised[0][i], raised[1][i], momentum[i], momentum[i]]);
    }
    for i in 0..3 {
        below[6 + i] = Four([0.0, 0.0, transposed[i], transposed[i]]);
    }
    below
}

/// All four wrenches at a frame `−offset` away.
#[inline(always)]
fn shift(below: &mut Below, offset: &Vector3<f64>) {
    let [x, y, z] = (*offset).into();
    let [
        Four(mx),
        Four(my),
        Four(mz),
        Four(fx),
        Four(fy),
        Four(fz),
        ..,
    ] = below;
    for lane in 0..4 {
        let force = (fx[lane], fy[lane], fz[lane]);
        mx[lane] = Scalar::mul_add(y, force.2, Scalar::mul_add(-z, force.1, mx[lane]));
        my[lane] = Scalar::mul_add(z, force.0, Scalar::mul_add(-x, force.2, my[lane]));
        mz[lane] = Scalar::mul_add(x, force.1, Scalar::mul_add(-y, force.0, mz[lane]));
    }
}

#[inline(always)]
fn products(above: &Above, below: &Below) -> Four {
    let mut sum = [0.0; 4];
    let mut other = [0.0; 4];
    let add = |sum: &mut [f64; 4], i: usize| {
        let (Four(above), Four(below)) = (&above[i], &below[i]);
        for lane in 0..4 {
            sum[lane] = Scalar::mul_add(above[lane], below[lane], sum[lane]);
        }
    };
    (0..5).for_each(|i| add(&mut sum, i));
    (5..9).for_each(|i| add(&mut other, i));
    for lane in 0..4 {
        sum[lane] += other[lane];
    }
    Four(sum)
}
