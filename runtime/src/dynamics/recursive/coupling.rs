//! Constraints that couple joints, Theorem 3 where S̄ is not block-diagonal: `A(Q)ᵀ v̄ = 0` on the speeds of the tree.
//!
//! Some speeds depend on the others: `v̄_d = B v̄_i` with `A_dᵀ B = −A_iᵀ`, so that S̄ = [1; B]. S̄ is found at every Q; which speeds are the
//! independent ones is fixed when the mechanism is made. The state has all speeds of the tree: entries of dependent ones are
//! completed, their momenta and rates are 0.

use super::Recursive;
use super::lu::Lu;
use crate::dynamics::DynamicsError;
use crate::mechanism::Mechanism;
use crate::spatial::fused::{add_cross, apply, cross, dot};
use crate::spatial::{bracket_dual_product, join, split};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Cholesky, DMatrix, Vector3, Vector6};

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
    /// Aᵀ, one row a constraint, one column a speed of the tree.
    matrix: Vec<f64>,
    lu: Lu,
    /// B, one row a dependent, one column an independent speed.
    basis: DMatrix<f64>,
    /// M S̄, one row a speed of the tree.
    momenta: DMatrix<f64>,
    /// `S̄ᵀ M S̄`.
    mass: DMatrix<f64>,
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
            multipliers: vec![0.0; count],
            reduced: vec![0.0; rest],
            whole: vec![0.0; size],
            other: vec![0.0; size],
            dependent,
            independent,
        })
    }

    /// `S̄ x` into `whole`.
    fn expand(&self, x: impl Fn(usize) -> f64, whole: &mut [f64]) {
        for (j, &speed) in self.independent.iter().enumerate() {
            whole[speed] = x(j);
        }
        for (i, &speed) in self.dependent.iter().enumerate() {
            let terms = (0..self.independent.len()).map(|j| self.basis[(i, j)] * x(j));
            whole[speed] = terms.sum();
        }
    }

    /// `S̄ᵀ f` into `reduced`.
    fn reduce(&self, f: &[f64], reduced: &mut [f64]) {
        for (j, &speed) in self.independent.iter().enumerate() {
            let terms = self.dependent.iter().enumerate();
            let carried: f64 = terms.map(|(i, &d)| self.basis[(i, j)] * f[d]).sum();
            reduced[j] = f[speed] + carried;
        }
    }

    /// Entries of independent speeds into their places, 0 elsewhere.
    fn scatter(&self, reduced: &[f64], whole: &mut [f64]) {
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
            direction: apply(&fixed.rotation, &constraint.direction),
            wrench: Vector6::zeros(),
        }
    });
    rows.collect()
}

impl Recursive {
    /// `Aᵀ` of the constraints at `q`, one row a constraint, one column a speed of the tree: for choosing which speeds depend.
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
            let end = self.links[row.body].speeds.end;
            self.fill_row(&mut entries[..end], row.body, &row.wrench);
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
    fn tree_momenta(&mut self, speeds: &[f64], momenta: &mut [f64]) {
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

    /// v̄̇ under τ; see [`Recursive::coupled_rates`] for the way.
    pub(super) fn coupled_accelerations(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        rates: &mut [f64],
        coupling: &mut Coupling,
    ) -> Result<(), DynamicsError> {
        self.couple(q, coupling)?;
        self.known_accelerations(q, speeds, efforts, coupling);
        let known = core::mem::take(&mut coupling.whole);
        let mut needed = core::mem::take(&mut coupling.other);
        self.advance(q, speeds, Some(&known));
        self.act(q, speeds, Some(efforts));
        self.relieve();
        self.gather(&mut needed);
        self.add_armature(&known, &mut needed);
        for (needed, force) in needed.iter_mut().zip(&self.forces) {
            *needed = force - *needed;
        }
        let mut reduced = core::mem::take(&mut coupling.reduced);
        coupling.reduce(&needed, &mut reduced);
        let solved = self.solve_reduced(coupling, &mut reduced);
        for (value, &speed) in reduced.iter_mut().zip(&coupling.independent) {
            *value += known[speed];
        }
        coupling.scatter(&reduced, rates);
        coupling.reduced = reduced;
        (coupling.whole, coupling.other) = (known, needed);
        solved
    }

    /// What is known of v̄̇ into `coupling.whole`: prescribed rates, and what the constraints ask of the dependent ones.
    fn known_accelerations(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        coupling: &mut Coupling,
    ) {
        self.set_driven_rates(efforts);
        self.advance(q, speeds, None);
        let gravity = *self.mechanism.gravity();
        for (row, value) in coupling.rows.iter().zip(&mut coupling.multipliers) {
            *value = -self.velocity_product_of(row, &gravity);
        }
        coupling.lu.solve(&mut coupling.multipliers);
        let mut whole = core::mem::take(&mut coupling.whole);
        let prescribed = |j: usize| match coupling.driven[j] {
            true => self.driven[coupling.independent[j]],
            false => 0.0,
        };
        coupling.expand(prescribed, &mut whole);
        for (&speed, &value) in coupling.dependent.iter().zip(&coupling.multipliers) {
            whole[speed] += value;
        }
        coupling.whole = whole;
    }

    /// `Ȧᵀ v̄` of one constraint: `d · a_P + (ω × d) · v_P` at v̄̇ = 0.
    fn velocity_product_of(&self, row: &Row, gravity: &Vector3<f64>) -> f64 {
        let motion = &self.nodes[row.body].motion;
        let (_, direction) = split(&row.wrench);
        let arm = apply(&motion.placement.rotation, &row.point);
        let ((omega, velocity), (alpha, rate)) = (split(&motion.twist), split(&motion.rate));
        // The base accelerates with −g in the sweep; a point's acceleration is the rate of the frame's velocity plus ω × v.
        let origin = add_cross(&(rate + gravity), &omega, &velocity);
        let turned = add_cross(&origin, &alpha, &arm);
        let acceleration = add_cross(&turned, &omega, &cross(&omega, &arm));
        let at_point = add_cross(&velocity, &omega, &arm);
        dot(&direction, &acceleration) + dot(&cross(&omega, &direction), &at_point)
    }

    /// `(S̄ᵀMS̄)⁻¹ x` in place; entries of prescribed speeds become 0.
    fn solve_reduced(&self, coupling: &mut Coupling, x: &mut [f64]) -> Result<(), DynamicsError> {
        let mut mass = core::mem::replace(&mut coupling.mass, DMatrix::zeros(0, 0));
        for (j, _) in coupling
            .driven
            .iter()
            .enumerate()
            .filter(|(_, driven)| **driven)
        {
            mass.row_mut(j).fill(0.0);
            mass.column_mut(j).fill(0.0);
            mass[(j, j)] = 1.0;
            x[j] = 0.0;
        }
        let size = mass.nrows();
        let Some(factors) = Cholesky::new(mass) else {
            coupling.mass = DMatrix::zeros(size, size);
            return Err(self.singular_reduced(coupling));
        };
        let mut side = nalgebra::DVectorViewMut::from_slice(x, size);
        factors.solve_mut(&mut side);
        coupling.mass = factors.unpack_dirty();
        Ok(())
    }

    fn singular_reduced(&self, coupling: &Coupling) -> DynamicsError {
        let speed = coupling.independent.first().copied().unwrap_or(0);
        let bodies = self.mechanism.bodies().iter();
        let owner = bodies
            .enumerate()
            .find(|(_, body)| body.ranges().speeds.contains(&speed));
        let (body, start) =
            owner.map_or((0, 0), |(index, body)| (index, body.ranges().speeds.start));
        self.mechanism.singular(
            body,
            &crate::steps::PivotFailure {
                speed: speed - start,
                pivot: 0.0,
                limit: 0.0,
            },
        )
    }

    /// `p̄ = S̄ᵀ M v̄`; entries of prescribed speeds are the speeds.
    pub(super) fn coupled_momenta(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        momenta: &mut [f64],
        coupling: &mut Coupling,
    ) -> Result<(), DynamicsError> {
        self.weigh(q);
        self.find_basis(coupling)?;
        let mut reduced = core::mem::take(&mut coupling.reduced);
        self.tree_momenta(speeds, momenta);
        coupling.reduce(momenta, &mut reduced);
        coupling.scatter(&reduced, momenta);
        coupling.reduced = reduced;
        self.copy_driven(speeds, momenta);
        Ok(())
    }

    /// v̄ from p̄; placements, own inertias and twists are those of the result.
    pub(super) fn coupled_speeds(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        speeds: &mut [f64],
        coupling: &mut Coupling,
    ) -> Result<(), DynamicsError> {
        self.couple(q, coupling)?;
        let mut reduced = core::mem::take(&mut coupling.reduced);
        for (j, (value, &speed)) in reduced.iter_mut().zip(&coupling.independent).enumerate() {
            // What prescribed speeds contribute to the momenta of the others is known.
            let prescribed = coupling
                .driven
                .iter()
                .enumerate()
                .filter(|(_, driven)| **driven);
            let carried =
                prescribed.map(|(k, _)| coupling.mass[(j, k)] * momenta[coupling.independent[k]]);
            *value = momenta[speed] - carried.sum::<f64>();
        }
        let solved = self.solve_reduced(coupling, &mut reduced);
        for (j, value) in reduced.iter_mut().enumerate() {
            if coupling.driven[j] {
                *value = momenta[coupling.independent[j]];
            }
        }
        coupling.expand(|j| reduced[j], speeds);
        coupling.reduced = reduced;
        self.set_twists(speeds);
        solved
    }

    /// p̄̇ = S̄ᵀ ṗ + S̄̇ᵀ p, with p = M v̄ the momenta of the tree.
    ///
    /// `S̄̇ᵀp = −S̄ᵀ Ȧ μ` with `A_d μ = p_d`. Ȧμ obeys the recursion of the momenta, with `−Σ μ F` in place of G V and `Σ μ ad_Vᵀ F` in place of
    /// the external wrench, F the wrenches of the constraints: so both go through one sweep.
    pub(super) fn coupled_rates(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        rates: &mut [f64],
        coupling: &mut Coupling,
    ) {
        let mut momenta = core::mem::take(&mut coupling.other);
        self.tree_momenta(speeds, &mut momenta);
        for (value, &speed) in coupling.multipliers.iter_mut().zip(&coupling.dependent) {
            *value = momenta[speed];
        }
        coupling.lu.solve_transposed(&mut coupling.multipliers);
        self.prepare_rates();
        for (row, &weight) in coupling.rows.iter().zip(&coupling.multipliers) {
            let node = &mut self.nodes[row.body];
            let weighted = row.wrench * weight;
            node.motion.rate += bracket_dual_product(&node.motion.twist, &weighted);
            node.wrench -= weighted;
        }
        self.gather_rates(q, speeds, &mut momenta);
        let mut reduced = core::mem::take(&mut coupling.reduced);
        coupling.reduce(&momenta, &mut reduced);
        coupling.scatter(&reduced, rates);
        coupling.reduced = reduced;
        coupling.other = momenta;
    }

    /// λ of the constraints that couple joints into `forces`, one entry a constraint: they act on the tree with efforts `S̄ᵀ`-wise `Aλ`.
    ///
    /// `rates` are the accelerations that [`Dynamics::accelerations`](crate::dynamics::Dynamics::accelerations) found for `efforts`.
    ///
    /// # Errors
    /// A wrong size; constraints that no longer determine their speeds.
    pub fn coupling_force(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        rates: &[f64],
        efforts: &[f64],
        forces: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let count = self.mechanism.constraints().len();
        crate::mechanism::check_size(
            crate::mechanism::WHOLE,
            "constraint forces",
            count,
            forces.len(),
        )?;
        self.check(q, &[("speeds", speeds.len()), ("rates", rates.len())])?;
        self.check_efforts(efforts)?;
        let Some(mut coupling) = self.coupling.take() else {
            return Ok(());
        };
        let result = self.coupling_force_with(q, speeds, rates, efforts, forces, &mut coupling);
        self.coupling = Some(coupling);
        result
    }

    fn coupling_force_with(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        rates: &[f64],
        efforts: &[f64],
        forces: &mut [f64],
        coupling: &mut Coupling,
    ) -> Result<(), DynamicsError> {
        self.weigh(q);
        self.find_basis(coupling)?;
        self.known_accelerations(q, speeds, efforts, coupling);
        let known = core::mem::take(&mut coupling.whole);
        let mut all = core::mem::take(&mut coupling.other);
        // Known rates hold what the constraints ask at v̄̇ᵢ = prescribed; the rest follows S̄.
        let rest = |j: usize| {
            let speed = coupling.independent[j];
            rates[speed] - known[speed]
        };
        coupling.expand(rest, &mut all);
        for (all, known) in all.iter_mut().zip(&known) {
            *all += known;
        }
        self.advance(q, speeds, Some(&all));
        self.act(q, speeds, Some(efforts));
        self.relieve();
        let mut needed = known;
        self.gather(&mut needed);
        self.add_armature(&all, &mut needed);
        for (force, &speed) in forces.iter_mut().zip(&coupling.dependent) {
            *force = needed[speed] - self.forces[speed];
        }
        coupling.lu.solve_transposed(forces);
        (coupling.whole, coupling.other) = (needed, all);
        Ok(())
    }
}
