//! Constraints that couple joints, Theorem 3 where S̄ is not block-diagonal: `A(Q)ᵀ v̄ = 0` on the speeds of the tree.
//!
//! Some speeds depend on the others: `v̄_d = B v̄_i` with `A_dᵀ B = −A_iᵀ`, so that S̄ = [1; B]. S̄ is found at every Q; which speeds are the
//! independent ones is fixed when the mechanism is made. The state has all speeds of the tree: entries of dependent ones are
//! completed, their momenta and rates are 0.

mod hamiltonian;
mod lagrangian;

use super::Recursive;
use crate::dynamics::DynamicsError;
use crate::lu::Lu;
use crate::mechanism::{Mechanism, Space};
use crate::spatial::fused::{apply, cross};
use crate::spatial::join;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{DMatrix, Vector3, Vector6};
use num_traits::Float;

/// How small the pivots of A_d may become next to its largest entry: at 1e-8 half of the digits of v̄_d are gone.
const PIVOT_LIMIT: f64 = 1e-8;

/// A constraint, in its body's joint-child frame.
#[derive(Clone, Debug)]
struct Row {
    body: usize,
    point: Vector3<f64>,
    direction: Vector3<f64>,
    /// `(r × d; d)` at the child frame's origin, world axes: its product with a twist is the forbidden velocity.
    wrench: Vector6<f64>,
}

/// The workspace of the constraints of a mechanism.
#[derive(Clone, Debug)]
pub(super) struct Coupling {
    rows: Vec<Row>,
    pub(super) dependent: Vec<usize>,
    pub(super) independent: Vec<usize>,
    /// Whether each of the independent speeds is prescribed.
    driven: Vec<bool>,
    /// Aᵀ, one row a constraint, one column per speed of the tree.
    matrix: Vec<f64>,
    lu: Lu<f64>,
    /// B, one row a dependent, one column an independent speed.
    basis: DMatrix<f64>,
    /// M S̄, one row per speed of the tree.
    momenta: DMatrix<f64>,
    /// `S̄ᵀ M S̄`.
    mass: DMatrix<f64>,
    /// Its factor.
    factored: DMatrix<f64>,
    multipliers: Vec<f64>,
    reduced: Vec<f64>,
    /// Speeds of the tree.
    whole: Vec<f64>,
    other: Vec<f64>,
}

impl Coupling {
    /// `None` for a mechanism without constraints.
    pub(super) fn new(mechanism: &Mechanism) -> Option<Self> {
        let constraints = mechanism.constraints();
        if constraints.is_empty() {
            return None;
        }
        let (size, count) = (mechanism.layout().speeds, constraints.len());
        let dependent = mechanism.dependent_speeds().to_vec();
        let independent: Vec<usize> = (0..size).filter(|i| !dependent.contains(i)).collect();
        let is_driven = |speed: &usize| {
            let drives = mechanism.drives().iter();
            let mut ranges = drives.map(|drive| &mechanism.bodies()[drive.body].ranges().speeds);
            ranges.any(|range| range.contains(speed))
        };
        let rest = independent.len();
        Some(Self {
            rows: rows(mechanism),
            driven: independent.iter().map(is_driven).collect(),
            matrix: vec![0.0; count * size],
            lu: Lu::new(dependent.len()),
            basis: DMatrix::zeros(dependent.len(), rest),
            momenta: DMatrix::zeros(size, rest),
            mass: DMatrix::zeros(rest, rest),
            factored: DMatrix::zeros(rest, rest),
            multipliers: vec![0.0; count],
            reduced: vec![0.0; rest],
            whole: vec![0.0; size],
            other: vec![0.0; size],
            dependent,
            independent,
        })
    }

    /// `S̄ x` into `whole`.
    pub(super) fn expand(&self, x: impl Fn(usize) -> f64, whole: &mut [f64]) {
        for (j, &speed) in self.independent.iter().enumerate() {
            whole[speed] = x(j);
        }
        for (i, &speed) in self.dependent.iter().enumerate() {
            let terms = (0..self.independent.len()).map(|j| self.basis[(i, j)] * x(j));
            whole[speed] = terms.sum();
        }
    }

    /// `S̄ᵀ f` into `reduced`.
    pub(super) fn reduce(&self, f: &[f64], reduced: &mut [f64]) {
        for (j, &speed) in self.independent.iter().enumerate() {
            let terms = self.dependent.iter().enumerate();
            let carried: f64 = terms.map(|(i, &d)| self.basis[(i, j)] * f[d]).sum();
            reduced[j] = f[speed] + carried;
        }
    }

    /// The constrained bodies, and `(r × d; d)` at the origins of their child frames, world axes: rows of Aᵀ are products with it.
    pub(super) fn wrenches(&self) -> impl Iterator<Item = (usize, Vector6<f64>)> {
        self.rows.iter().map(|row| (row.body, row.wrench))
    }

    /// μ of `A_d μ = p_d`, and the rates of the tree's momenta with `−Ȧ μ`, after [`Recursive::coupled_rates`].
    pub(super) fn momentum_multipliers(&self) -> (&[f64], &[f64]) {
        (&self.multipliers, &self.other)
    }

    /// v̄̇ of the tree, after [`Recursive::coupling_force_with`].
    pub(super) fn accelerations(&self) -> &[f64] {
        &self.other
    }

    /// Column j of B.
    pub(super) fn copy_basis(&self, j: usize, into: &mut [f64]) {
        into.copy_from_slice(self.basis.column(j).as_slice());
    }

    /// `A_dᵀ x = b` in place.
    pub(super) fn solve_dependent(&mut self, x: &mut [f64]) {
        self.lu.solve(x);
    }

    /// `A_d x = b` in place.
    pub(super) fn solve_multipliers(&mut self, x: &mut [f64]) {
        self.lu.solve_transposed(x);
    }

    /// x of `S̄ᵀMS̄ x = −S̄ᵀ (r + M p)`, with the dependent entries of p, after [`Recursive::coupled_accelerations`] or
    /// [`Recursive::coupled_speeds`]. Prescribed entries are 0, except for
    /// `prescribed`, a speed of the tree, which is 1.
    pub(super) fn answer(&self, r: &[f64], p: &[f64], prescribed: Option<usize>, x: &mut [f64]) {
        self.reduce(r, x);
        let given = prescribed.and_then(|speed| self.independent.iter().position(|&i| i == speed));
        for (j, x) in x.iter_mut().enumerate() {
            // M S̄ holds S̄ᵀ M as well.
            let carried = self.dependent.iter().zip(p);
            let carried: f64 = carried.map(|(&d, p)| self.momenta[(d, j)] * p).sum();
            let moved = given.map_or(0.0, |given| self.mass[(j, given)]);
            *x = -(*x + carried + moved);
        }
        self.solve_factored(x);
        if let Some(given) = given {
            x[given] = 1.0;
        }
    }

    /// `(S̄ᵀMS̄)⁻¹ x` in place after [`Coupling::factored`] holds its factor; entries of prescribed speeds become 0.
    fn solve_factored(&self, x: &mut [f64]) {
        for (x, _) in x
            .iter_mut()
            .zip(&self.driven)
            .filter(|(_, driven)| **driven)
        {
            *x = 0.0;
        }
        let mut side = nalgebra::DVectorViewMut::from_slice(x, self.factored.nrows());
        // The pivots are above zero.
        _ = self.factored.solve_lower_triangular_mut(&mut side)
            && self.factored.tr_solve_lower_triangular_mut(&mut side);
    }

    /// Entries of independent speeds into their places, 0 elsewhere.
    pub(super) fn scatter(&self, reduced: &[f64], whole: &mut [f64]) {
        whole.fill(0.0);
        for (&speed, &value) in self.independent.iter().zip(reduced) {
            whole[speed] = value;
        }
    }
}

/// The constraints of a mechanism in joint-child frames.
fn rows(mechanism: &Mechanism) -> Vec<Row> {
    let rows = mechanism.constraints().iter().map(|constraint| {
        let fixed = mechanism.bodies()[constraint.body].child_placement();
        Row {
            body: constraint.body,
            point: fixed.transform_point(&constraint.point),
            direction: apply(&fixed.rotation, &constraint.direction.normalize()),
            wrench: Vector6::zeros(),
        }
    });
    rows.collect()
}

impl Recursive {
    /// `Aᵀ` of the constraints at `q`, one row a constraint, one column per speed of the tree: for choosing which speeds depend.
    pub(crate) fn constraint_matrix(&mut self, q: &[f64]) -> DMatrix<f64> {
        self.weigh(q);
        let mut rows = rows(&self.mechanism);
        let size = self.mechanism.layout().speeds;
        let mut matrix = vec![0.0; rows.len() * size];
        self.fill_constraints(&mut rows, &mut matrix);
        DMatrix::from_row_slice(rows.len(), size, &matrix)
    }

    /// Wrenches and Aᵀ at the placements of the workspace.
    fn fill_constraints(&self, rows: &mut [Row], matrix: &mut [f64]) {
        let size = self.mechanism.layout().speeds;
        for (row, entries) in rows.iter_mut().zip(matrix.chunks_exact_mut(size)) {
            let rotation = &self.nodes[row.body].motion.placement.rotation;
            let direction = apply(rotation, &row.direction);
            let arm = apply(rotation, &row.point);
            row.wrench = join(&cross(&arm, &direction), &direction);
            entries.fill(0.0);
            self.fill_row(entries, row.body, &row.wrench);
        }
    }

    /// B and S̄ᵀMS̄ at `q`; own inertias and placements are those of `q` afterwards.
    fn couple(&mut self, q: &[f64], coupling: &mut Coupling) -> Result<(), DynamicsError> {
        self.weigh(q);
        self.find_basis(coupling)?;
        for j in 0..coupling.independent.len() {
            let mut whole = core::mem::take(&mut coupling.whole);
            let mut momenta = core::mem::take(&mut coupling.other);
            coupling.expand(|k| if k == j { 1.0 } else { 0.0 }, &mut whole);
            self.tree_momenta(&whole, &mut momenta);
            coupling.momenta.column_mut(j).copy_from_slice(&momenta);
            for (k, &speed) in coupling.independent.iter().enumerate() {
                let carried = coupling.dependent.iter().enumerate();
                let carried: f64 = carried
                    .map(|(i, &d)| coupling.basis[(i, k)] * momenta[d])
                    .sum();
                coupling.mass[(k, j)] = momenta[speed] + carried;
            }
            (coupling.whole, coupling.other) = (whole, momenta);
        }
        Ok(())
    }

    fn find_basis(&self, coupling: &mut Coupling) -> Result<(), DynamicsError> {
        self.fill_constraints(&mut coupling.rows, &mut coupling.matrix);
        let size = self.mechanism.layout().speeds;
        let (matrix, dependent) = (&coupling.matrix, &coupling.dependent);
        coupling
            .lu
            .factorize(|i, j| matrix[i * size + dependent[j]], PIVOT_LIMIT)
            .map_err(|(row, ratio)| DynamicsError::Coupling {
                constraint: self.mechanism.constraints()[row].name.clone(),
                ratio,
                limit: PIVOT_LIMIT,
            })?;
        for (j, &speed) in coupling.independent.iter().enumerate() {
            for (i, entry) in coupling.multipliers.iter_mut().enumerate() {
                *entry = -coupling.matrix[i * size + speed];
            }
            coupling.lu.solve(&mut coupling.multipliers);
            coupling
                .basis
                .column_mut(j)
                .copy_from_slice(&coupling.multipliers);
        }
        Ok(())
    }

    /// `M v̄` of the tree at the placements of the workspace, whose twists become those of v̄.
    pub(super) fn tree_momenta(&mut self, speeds: &[f64], momenta: &mut [f64]) {
        self.set_twists(speeds);
        self.set_momenta();
        self.gather(momenta);
        self.add_armature(speeds, momenta);
    }

    /// Speeds of the dependent joints from the others.
    pub(super) fn complete(
        &mut self,
        q: &[f64],
        speeds: &mut [f64],
        coupling: &mut Coupling,
    ) -> Result<(), DynamicsError> {
        self.weigh(q);
        self.find_basis(coupling)?;
        let mut given = core::mem::take(&mut coupling.reduced);
        for (value, &speed) in given.iter_mut().zip(&coupling.independent) {
            *value = speeds[speed];
        }
        coupling.expand(|j| given[j], speeds);
        coupling.reduced = given;
        Ok(())
    }

    /// `(S̄ᵀMS̄)⁻¹ x` in place; entries of prescribed speeds become 0.
    fn solve_reduced(&self, coupling: &mut Coupling, x: &mut [f64]) -> Result<(), DynamicsError> {
        coupling.factored.copy_from(&coupling.mass);
        let mass = &mut coupling.factored;
        for (j, _) in coupling
            .driven
            .iter()
            .enumerate()
            .filter(|(_, driven)| **driven)
        {
            mass.row_mut(j).fill(0.0);
            mass.column_mut(j).fill(0.0);
            mass[(j, j)] = 1.0;
        }
        if let Err((row, pivot, limit)) = cholesky(mass) {
            let speed = coupling.independent[row];
            return Err(self
                .mechanism
                .singular_mass(Space::Speeds, speed, pivot, limit));
        }
        coupling.solve_factored(x);
        Ok(())
    }
}

/// `M = L Lᵀ` in the lower triangle; a row whose pivot does not stand above its rounding, with both.
fn cholesky(matrix: &mut DMatrix<f64>) -> Result<(), (usize, f64, f64)> {
    let size = matrix.nrows();
    for row in 0..size {
        let limit = size as f64 * f64::EPSILON * matrix[(row, row)];
        for column in 0..=row {
            let known = (0..column).map(|k| matrix[(row, k)] * matrix[(column, k)]);
            let rest = matrix[(row, column)] - known.sum::<f64>();
            if column < row {
                matrix[(row, column)] = rest / matrix[(column, column)];
                continue;
            }
            if rest.is_nan() || rest <= limit {
                return Err((row, rest, limit));
            }
            matrix[(row, row)] = Float::sqrt(rest);
        }
    }
    Ok(())
}
