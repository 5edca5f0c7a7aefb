//! Inverse dynamics by Newton–Euler recursion: no mass matrix, no S, no γ, no derivative in ϕ.
//!
//! Frames are the joints' child frames. Outward: `V_i = Ad V_λ + X̄ v̄` and
//! `V̇_i = Ad V̇_λ + X̄ v̄̇ + c + ad_V X̄ v̄`, from `V̇₀ = (0; −g)`. Inward: `F_i = G V̇ − ad_Vᵀ G V + Σ Ad⁻ᵀ F_child`.
//! Projected on the joints, F is (24) and (34).

use super::DynamicsError;
use crate::erased::Layout;
use crate::mechanism::{Body, Mechanism, StateError, WHOLE, check_size};
use crate::spatial::{Pose, bracket_dual_product, bracket_product, join};
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Cholesky, Matrix6, Vector3, Vector6};

/// Inverse dynamics of one mechanism, with its workspace: after construction nothing allocates.
#[derive(Clone, Debug)]
pub struct NewtonEuler {
    mechanism: Arc<Mechanism>,
    steps: Vec<Step>,
}

/// One joint's share of the workspace.
#[derive(Clone, Debug)]
struct Step {
    /// Child frame in the parent's child frame.
    pose: Pose<f64>,
    /// X^c, 6×K column by column.
    twist_map: Vec<f64>,
    /// S̄, K×S column by column.
    speed_basis: Vec<f64>,
    /// A, K×C column by column.
    constraint: Vec<f64>,
    /// A velocity or its rate, K; after the inward sweep X^cᵀF.
    freedoms: Vec<f64>,
    twist: Vector6<f64>,
    acceleration: Vector6<f64>,
    wrench: Vector6<f64>,
}

impl Step {
    fn new(size: &Layout) -> Self {
        Self {
            pose: Pose::identity(),
            twist_map: vec![0.0; 6 * size.freedoms],
            speed_basis: vec![0.0; size.freedoms * size.speeds],
            constraint: vec![0.0; size.freedoms * size.constraints],
            freedoms: vec![0.0; size.freedoms],
            twist: Vector6::zeros(),
            acceleration: Vector6::zeros(),
            wrench: Vector6::zeros(),
        }
    }

    /// `X^c S̄ s` for speeds or their rates.
    fn relative(&mut self, speeds: &[f64]) -> Vector6<f64> {
        multiply(&self.speed_basis, speeds, &mut self.freedoms);
        let mut twist = Vector6::zeros();
        multiply(&self.twist_map, &self.freedoms, twist.as_mut_slice());
        twist
    }

    /// Twist and acceleration from those of the parent.
    fn outward(
        &mut self,
        body: &Body,
        (parent_twist, parent_acceleration): (Vector6<f64>, Vector6<f64>),
        q: &[f64],
        (speeds, rates): (&[f64], &[f64]),
    ) {
        let joint = body.joint();
        self.pose = body.joint_frame().compose(&joint.pose(q));
        joint.twist_map_child(q, &mut self.twist_map);
        joint.speed_basis(q, &mut self.speed_basis);
        joint.constraint(q, &mut self.constraint);
        let relative = self.relative(speeds);
        self.twist = self.pose.act_twist_inverse(&parent_twist) + relative;
        self.acceleration = self.pose.act_twist_inverse(&parent_acceleration)
            + self.relative(rates)
            + joint.bias_acceleration(q, speeds)
            + bracket_product(&self.twist, &relative);
        let inertia = body.joint_inertia();
        let momentum = inertia.apply(&self.twist);
        self.wrench =
            inertia.apply(&self.acceleration) - bracket_dual_product(&self.twist, &momentum);
    }
}

impl NewtonEuler {
    /// The recursion for `mechanism`.
    pub fn new(mechanism: Arc<Mechanism>) -> Self {
        let steps = mechanism
            .bodies()
            .iter()
            .map(|body| Step::new(&body.joint().layout()))
            .collect();
        Self { mechanism, steps }
    }

    /// `S̄ᵀτ` into `efforts` (one entry a speed): what the joints must exert for the mechanism to accelerate with
    /// `accelerations` = v̄̇ at `q` and v̄.
    ///
    /// # Errors
    /// When a vector has the wrong size.
    pub fn inverse_dynamics(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        accelerations: &[f64],
        efforts: &mut [f64],
    ) -> Result<(), StateError> {
        let layout = self.mechanism.layout();
        check_size(WHOLE, "configuration", layout.configuration, q.len())?;
        check_size(WHOLE, "speeds", layout.speeds, speeds.len())?;
        check_size(WHOLE, "accelerations", layout.speeds, accelerations.len())?;
        check_size(WHOLE, "efforts", layout.speeds, efforts.len())?;
        self.outward(q, speeds, accelerations);
        self.inward();
        for (body, step) in self.mechanism.bodies().iter().zip(&self.steps) {
            let own = &mut efforts[body.ranges().speeds.clone()];
            multiply_transposed(&step.speed_basis, &step.freedoms, own);
        }
        Ok(())
    }

    /// The wrench that joint `body` exerts on its child, in the joint's child frame, as of the last
    /// [`NewtonEuler::inverse_dynamics`]; `None` when there is no such body.
    pub fn joint_wrench(&self, body: usize) -> Option<&Vector6<f64>> {
        self.steps.get(body).map(|step| &step.wrench)
    }

    /// `X^cᵀF = τ + Aλ` of every joint into `efforts` (one entry a freedom), as of the last
    /// [`NewtonEuler::inverse_dynamics`].
    ///
    /// # Errors
    /// When `efforts` has the wrong size.
    pub fn joint_efforts(&self, efforts: &mut [f64]) -> Result<(), StateError> {
        check_size(
            WHOLE,
            "efforts",
            self.mechanism.layout().freedoms,
            efforts.len(),
        )?;
        for (body, step) in self.mechanism.bodies().iter().zip(&self.steps) {
            efforts[body.ranges().freedoms.clone()].copy_from_slice(&step.freedoms);
        }
        Ok(())
    }

    /// `λ = (AᵀA)⁻¹Aᵀ(X^cᵀF − τ)` into `forces` (one entry a constraint), for applied efforts τ (one a freedom), as of
    /// the last [`NewtonEuler::inverse_dynamics`].
    ///
    /// # Errors
    /// When a vector has the wrong size; when A has lost rank.
    pub fn constraint_force(
        &self,
        efforts: &[f64],
        forces: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let layout = self.mechanism.layout();
        check_size(WHOLE, "efforts", layout.freedoms, efforts.len())?;
        check_size(WHOLE, "constraint forces", layout.constraints, forces.len())?;
        for (body, step) in self.mechanism.bodies().iter().zip(&self.steps) {
            let ranges = body.ranges();
            let own = &mut forces[ranges.constraints.clone()];
            joint_constraint_force(step, &efforts[ranges.freedoms.clone()], own)?;
        }
        Ok(())
    }

    fn outward(&mut self, q: &[f64], speeds: &[f64], accelerations: &[f64]) {
        // A base that accelerates upwards makes bodies weigh what gravity makes them weigh.
        let base = join(&Vector3::zeros(), &-self.mechanism.gravity());
        for (index, body) in self.mechanism.bodies().iter().enumerate() {
            let parent = body.parent().map_or((Vector6::zeros(), base), |parent| {
                (self.steps[parent].twist, self.steps[parent].acceleration)
            });
            let own = body.ranges().speeds.clone();
            let motion = (&speeds[own.clone()], &accelerations[own]);
            self.steps[index].outward(body, parent, body.configuration(q), motion);
        }
    }

    fn inward(&mut self) {
        for (index, body) in self.mechanism.bodies().iter().enumerate().rev() {
            let step = &mut self.steps[index];
            let carried = step.pose.act_wrench(&step.wrench);
            multiply_transposed(&step.twist_map, step.wrench.as_slice(), &mut step.freedoms);
            if let Some(parent) = body.parent() {
                self.steps[parent].wrench += carried;
            }
        }
    }
}

/// `(AᵀA)⁻¹ Aᵀ (X^cᵀF − τ)` of one joint; a joint has six constraints at most, unused rows are those of the identity.
fn joint_constraint_force(
    step: &Step,
    efforts: &[f64],
    forces: &mut [f64],
) -> Result<(), DynamicsError> {
    let (rows, size) = (efforts.len(), forces.len());
    let column = |i: usize| &step.constraint[i * rows..(i + 1) * rows];
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let mut gram = Matrix6::identity();
    let mut side = Vector6::zeros();
    for i in 0..size {
        side[i] = dot(column(i), &step.freedoms) - dot(column(i), efforts);
        for j in 0..size {
            gram[(i, j)] = dot(column(i), column(j));
        }
    }
    let factors = Cholesky::new(gram).ok_or(DynamicsError::DependentConstraints)?;
    forces.copy_from_slice(&factors.solve(&side).as_slice()[..size]);
    Ok(())
}

/// `out = matrix · x`, the matrix column by column.
fn multiply(matrix: &[f64], x: &[f64], out: &mut [f64]) {
    out.fill(0.0);
    for (column, &weight) in matrix.chunks_exact(out.len().max(1)).zip(x) {
        for (sum, &entry) in out.iter_mut().zip(column) {
            *sum += entry * weight;
        }
    }
}

/// `out = matrixᵀ · x`, the matrix column by column.
fn multiply_transposed(matrix: &[f64], x: &[f64], out: &mut [f64]) {
    for (sum, column) in out.iter_mut().zip(matrix.chunks_exact(x.len().max(1))) {
        *sum = column
            .iter()
            .zip(x)
            .map(|(entry, weight)| entry * weight)
            .sum();
    }
}
