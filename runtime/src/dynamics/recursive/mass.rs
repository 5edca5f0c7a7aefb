//! M̄ by composite rigid bodies, and its factorisation along the branches of the tree.

use super::Recursive;
use super::link::{Kind, Node, parents};
use crate::dynamics::DynamicsError;
use crate::mechanism::{Mechanism, Space, StateError, WHOLE, check_size};
use crate::spatial::{SpatialInertia, shift_wrench, split};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{DMatrix, Vector6};

/// How many roundings of its own diagonal entry a pivot must stand above, for each row: those of one update and a margin of four.
const ROUNDINGS: f64 = 8.0;

/// M̄ of one mechanism, and its factors: `M̄ = Lᵀ D L` with the zeros of the tree's branches.
///
/// Row i of the lower triangle has entries for speed i itself and for the speeds between it and the root alone; so has row i of L. Filling
/// and factorising allocate nothing.
#[derive(Clone, Debug)]
pub struct MassMatrix {
    size: usize,
    /// The lower triangle, row after row, each of full length.
    rows: Vec<f64>,
    /// The same, factorised: D on the diagonal.
    factors: Vec<f64>,
    /// The next speed towards the root.
    parents: Vec<Option<usize>>,
}

impl MassMatrix {
    /// Room for the mass matrix of `mechanism`.
    pub fn new(mechanism: &Mechanism) -> Self {
        let size = mechanism.layout().speeds;
        Self {
            size,
            rows: vec![0.0; size * size],
            factors: Vec::new(),
            parents: parents(mechanism, |ranges| &ranges.speeds),
        }
        .with_factors()
    }

    fn with_factors(mut self) -> Self {
        self.factors = vec![0.0; self.rows.len()];
        self
    }

    /// Number of rows: of speeds.
    pub const fn size(&self) -> usize {
        self.size
    }

    /// Entry (i, j); zero for an index out of range.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        let (row, column) = (i.max(j), i.min(j));
        let index = row * self.size + column;
        self.rows.get(index).copied().unwrap_or(0.0)
    }

    /// All entries.
    pub fn matrix(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.size, self.size, |i, j| self.entry(i, j))
    }

    /// The factors L (unit diagonal left out) and D (on the diagonal) of `M̄ = Lᵀ D L`, of the last [`MassMatrix::factorize`].
    pub fn factors(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.size, self.size, |i, j| match j <= i {
            true => self.factors[i * self.size + j],
            false => 0.0,
        })
    }

    /// `M̄ = Lᵀ D L`, from the last row to the first, so that no zero fills in.
    ///
    /// # Errors
    /// When a pivot does not stand above its rounding, with the joint and the speed.
    pub fn factorize(&mut self, mechanism: &Mechanism) -> Result<(), DynamicsError> {
        self.factors.copy_from_slice(&self.rows);
        let size = self.size;
        for k in (0..size).rev() {
            let pivot = self.factors[k * size + k];
            let limit = ROUNDINGS * size as f64 * f64::EPSILON * self.rows[k * size + k];
            if pivot.is_nan() || pivot <= limit {
                return Err(mechanism.singular_mass(Space::Speeds, k, pivot, limit));
            }
            let (above, row) = self.factors.split_at_mut(k * size);
            let mut ancestor = self.parents[k];
            while let Some(i) = ancestor {
                let weight = row[i] / pivot;
                let target = &mut above[i * size..=i * size + i];
                subtract(target, &row[..=i], weight, &self.parents, i);
                row[i] = weight;
                ancestor = self.parents[i];
            }
        }
        Ok(())
    }

    /// `M̄⁻¹ x` in place, with the factors of the last [`MassMatrix::factorize`].
    ///
    /// # Errors
    /// When `x` has the wrong size.
    pub fn solve(&self, x: &mut [f64]) -> Result<(), StateError> {
        check_size(WHOLE, "right-hand side", self.size, x.len())?;
        let size = self.size;
        for k in (0..size).rev() {
            self.each_ancestor(k, |i| x[i] -= self.factors[k * size + i] * x[k]);
        }
        for k in 0..size {
            let mut value = x[k] / self.factors[k * size + k];
            self.each_ancestor(k, |i| value -= self.factors[k * size + i] * x[i]);
            x[k] = value;
        }
        Ok(())
    }

    fn each_ancestor(&self, speed: usize, mut visit: impl FnMut(usize)) {
        let mut ancestor = self.parents[speed];
        while let Some(i) = ancestor {
            visit(i);
            ancestor = self.parents[i];
        }
    }
}

/// `target_j −= weight row_j` for j = i and every speed between i and the root.
fn subtract(target: &mut [f64], row: &[f64], weight: f64, parents: &[Option<usize>], i: usize) {
    let mut ancestor = Some(i);
    while let Some(j) = ancestor {
        target[j] -= weight * row[j];
        ancestor = parents[j];
    }
}

impl Recursive {
    /// Whether a mass matrix was made for a mechanism with so many speeds.
    fn check_mass(&self, mass: &MassMatrix) -> Result<(), StateError> {
        let speeds = self.mechanism.layout().speeds;
        check_size(WHOLE, "rows of the mass matrix", speeds, mass.size)
    }

    /// M̄ of the tree at `q` into `mass`; constraints that couple joints do not reduce it.
    ///
    /// # Errors
    /// When `q` has the wrong size, or `mass` belongs to a mechanism of another size.
    pub fn mass_matrix(&mut self, q: &[f64], mass: &mut MassMatrix) -> Result<(), StateError> {
        self.check_mass(mass)?;
        self.with_inputs(q, &[], |dynamics| {
            dynamics.stand(q);
            dynamics.compose();
            dynamics.fill_mass_matrix(mass);
            Ok(())
        })
    }

    /// M̄ of the tree, after [`Recursive::compose`].
    pub(super) fn fill_mass_matrix(&mut self, mass: &mut MassMatrix) {
        self.fill_mass(&mut mass.rows);
        self.load_mass(mass.size, &mut mass.rows);
    }

    /// Inward, after [`Recursive::stand`]: the rigid inertia N of each body and of all that hangs on it, and N X̄.
    pub(super) fn compose(&mut self) {
        // What a body hands over to the next stays in registers: to load what has just been stored is to wait for it.
        let mut held = SpatialInertia::zero();
        let mut holds = false;
        for (index, link) in self.links.iter().enumerate().rev() {
            let (before, rest) = self.nodes.split_at_mut(index);
            let Node { motion, rigid, .. } = &mut rest[0];
            let placement = &motion.placement;
            if !holds && link.carries {
                held = *rigid;
            }
            let whole = link.inertia.rotated(&placement.rotation).combine(&held);
            *rigid = whole;
            let own = link.columns.clone();
            match self.rungs[index].kind {
                Kind::TurnsOnce => {
                    let (turn, _) = split(&self.columns[own.start]);
                    self.momenta[own.start] = whole.apply_angular(&turn);
                }
                _ => {
                    let (columns, momenta) = (&self.columns[own.clone()], &mut self.momenta[own]);
                    link.joint.momenta(rigid, columns, momenta);
                }
            }
            (held, holds) = (SpatialInertia::zero(), false);
            if let Some(parent) = link.parent {
                let carried = whole.shifted(&placement.offset);
                let sum = match link.last {
                    true => carried,
                    false => before[parent].rigid.combine(&carried),
                };
                holds = parent + 1 == index;
                match holds {
                    true => held = sum,
                    false => before[parent].rigid = sum,
                }
            }
        }
    }

    /// `X_kᵀ F` for all speeds k from `body` to the root into their entries of `row`.
    pub(super) fn fill_row(&self, row: &mut [f64], body: usize, momentum: &Vector6<f64>) {
        self.each_to_root(body, momentum, |speed, product| row[speed] = product);
    }

    /// The lower triangle of M̄ without rotors, after [`Recursive::compose`]; where joints carry several bodies, summed over these.
    fn fill_mass(&mut self, rows: &mut [f64]) {
        if self.groups.is_empty() {
            return self.fill_rows(rows);
        }
        let size = self.mechanism.layout().speeds;
        rows.fill(0.0);
        for (body, own) in self.links.iter().enumerate() {
            for (speed, column) in own.speeds.clone().zip(own.columns.clone()) {
                let row = &mut rows[speed * size..(speed + 1) * size];
                let momentum = &self.momenta[column];
                self.each_to_root(body, momentum, |speed, product| row[speed] += product);
            }
        }
    }

    /// Tells every speed k from `body` to the root with `X_kᵀ F`.
    fn each_to_root(
        &self,
        mut body: usize,
        momentum: &Vector6<f64>,
        mut tell: impl FnMut(usize, f64),
    ) {
        let mut momentum = *momentum;
        loop {
            let link = &self.links[body];
            let columns = &self.columns[link.columns.clone()];
            for (speed, column) in link.speeds.clone().zip(columns) {
                tell(speed, column.dot(&momentum));
            }
            let Some(parent) = link.parent else { return };
            momentum = shift_wrench(&momentum, &self.nodes[body].motion.placement.offset);
            body = parent;
        }
    }
}
