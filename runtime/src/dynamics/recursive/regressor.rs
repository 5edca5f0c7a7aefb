//! The joint torque regressor: inverse dynamics is linear in the inertial parameters of the bodies.
//!
//! The wrench that a body takes is its body regressor times its ten parameters ([`body_regressor`]). Shifted from frame to frame towards the root,
//! each of its ten columns meets the columns of X̄ of the joints on the way, as the wrench itself does in inverse dynamics: `O(n · depth)` products.
//! What does not depend on inertias is swept inward once, as τ₀.

use super::Recursive;
use crate::mechanism::{Mechanism, Space, StateError, WHOLE, check_size};
use crate::spatial::{INERTIAL_PARAMETERS, body_regressor, shift_wrench, turn_back, turn_out};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{DMatrix, Vector6};

/// Y and τ₀ of one state of a mechanism: `τ = Y π + τ₀` are the efforts of [`Recursive::inverse_dynamics`].
///
/// π has ten entries a body, in the order of [`Mechanism::bodies`](crate::mechanism::Mechanism::bodies), in each those of
/// [`INERTIAL_PARAMETER_NAMES`](crate::spatial::INERTIAL_PARAMETER_NAMES), **about the origin and in the axes of the body frame**
/// ([`Mechanism::inertial_parameters`](crate::mechanism::Mechanism::inertial_parameters)). That order is Pinocchio's; its frames are those of
/// joints, which are the body frames of robots in URDF. Rows are speeds: efforts are `S̄ᵀτ`, N m where the speed is in rad/s and N where it is in m/s. Gravity is in Y. τ₀
/// is what no inertial parameter enters: what rotors take, less what springs, dampers, limits and other elements exert.
#[derive(Clone, Debug, PartialEq)]
pub struct JointTorqueRegressor {
    rows: usize,
    columns: usize,
    /// Column by column.
    entries: Vec<f64>,
    rest: Vec<f64>,
}

impl JointTorqueRegressor {
    /// Room for the regressor of `mechanism`.
    pub fn new(mechanism: &Mechanism) -> Self {
        let rows = mechanism.layout().speeds;
        let columns = INERTIAL_PARAMETERS * mechanism.bodies().len();
        Self {
            rows,
            columns,
            entries: vec![0.0; rows * columns],
            rest: vec![0.0; rows],
        }
    }

    /// Number of rows: of speeds.
    pub const fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns: of inertial parameters, ten a body.
    pub const fn columns(&self) -> usize {
        self.columns
    }

    /// The effort on a speed by one unit of a parameter; zero for an index out of range.
    pub fn entry(&self, row: usize, column: usize) -> f64 {
        let known = row < self.rows && column < self.columns();
        match known {
            true => self.entries[column * self.rows + row],
            false => 0.0,
        }
    }

    /// All entries of Y, column by column.
    pub fn entries(&self) -> &[f64] {
        &self.entries
    }

    /// Y; allocates.
    pub fn matrix(&self) -> DMatrix<f64> {
        DMatrix::from_column_slice(self.rows, self.columns(), &self.entries)
    }

    /// τ₀, one entry per speed.
    pub fn rest(&self) -> &[f64] {
        &self.rest
    }

    /// `Y π + τ₀` into `efforts`, one entry per speed.
    ///
    /// # Errors
    /// When a vector has the wrong size.
    pub fn efforts(&self, parameters: &[f64], efforts: &mut [f64]) -> Result<(), StateError> {
        check_size(
            WHOLE,
            "inertial parameters",
            self.columns(),
            parameters.len(),
        )?;
        check_size(WHOLE, "efforts", self.rows, efforts.len())?;
        efforts.copy_from_slice(&self.rest);
        for (column, parameter) in self.entries.chunks_exact(self.rows.max(1)).zip(parameters) {
            for (effort, entry) in efforts.iter_mut().zip(column) {
                *effort += entry * parameter;
            }
        }
        Ok(())
    }
}

impl Recursive {
    /// Y and τ₀ at `q`, v̄ and `accelerations` = v̄̇ into `out`, so that `Y π + τ₀` is what [`Recursive::inverse_dynamics`] finds there, to rounding.
    /// Constraints that couple joints exert nothing here, as there. Allocates nothing.
    ///
    /// # Errors
    /// When a vector has the wrong size, or is not finite; a regressor that was made for another mechanism; entries that are not finite.
    pub fn joint_torque_regressor(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        accelerations: &[f64],
        out: &mut JointTorqueRegressor,
    ) -> Result<(), StateError> {
        let bodies = self.links.len();
        self.check_room("regressor", &out.rest)?;
        let columns = INERTIAL_PARAMETERS * bodies;
        check_size(WHOLE, "regressor columns", columns, out.columns)?;
        let vectors: [(&'static str, &[f64]); 2] =
            [("speeds", speeds), ("accelerations", accelerations)];
        self.with_inputs(q, &vectors, |dynamics| {
            dynamics.advance(q, speeds, Some(accelerations));
            out.entries.fill(0.0);
            let size = INERTIAL_PARAMETERS * out.rows;
            for body in 0..bodies {
                let own = body * size..(body + 1) * size;
                dynamics.regress(body, &mut out.entries[own], out.rows);
            }
            dynamics.gather_rest((q, speeds, accelerations), &mut out.rest);
            Ok::<_, StateError>(())
        })?;
        let found = [("effort", Space::Speeds, &*out.rest)];
        self.mechanism.check_finite((q, speeds), &found)?;
        let found = out.entries.chunks_exact(out.rows.max(1));
        found.into_iter().try_for_each(|column| {
            let found = [("regressor entry", Space::Speeds, column)];
            self.mechanism.check_finite((q, speeds), &found)
        })
    }

    /// The ten columns of one body, at the motion of the nodes.
    fn regress(&self, body: usize, out: &mut [f64], rows: usize) {
        let motion = &self.nodes[body].motion;
        let frame = self.mechanism.bodies()[body].child_placement();
        let rotation = &motion.placement.rotation;
        let in_body = |vector| frame.act_twist_inverse(&turn_back(rotation, vector));
        let regressor = body_regressor(&in_body(&motion.twist), &in_body(&motion.rate));
        let columns = regressor.column_iter();
        for (column, out) in columns.zip(out.chunks_exact_mut(rows.max(1))) {
            let wrench = turn_out(rotation, &frame.act_wrench(&column.into_owned()));
            self.project(body, wrench, out);
        }
    }

    /// `X̄ᵀ` of a wrench on one body, at its own child frame in world axes, of every joint that carries it, into their entries of `efforts`.
    fn project(&self, body: usize, mut wrench: Vector6<f64>, efforts: &mut [f64]) {
        let mut next = Some(body);
        while let Some(index) = next {
            let link = &self.links[index];
            let columns = &self.columns[link.columns.clone()];
            for (effort, column) in efforts[link.speeds.clone()].iter_mut().zip(columns) {
                *effort = column.dot(&wrench);
            }
            wrench = shift_wrench(&wrench, &self.nodes[index].motion.placement.offset);
            next = link.parent;
        }
    }

    /// τ₀ at a motion of the nodes at (q, v̄, v̄̇): inverse dynamics of bodies without inertia. The wrenches of the nodes become those of the elements.
    fn gather_rest(&mut self, (q, speeds, rates): (&[f64], &[f64], &[f64]), rest: &mut [f64]) {
        rest.fill(0.0);
        if self.acted_on {
            self.act(q, speeds, None);
            for (rest, force) in rest.iter_mut().zip(&self.forces) {
                *rest = -force;
            }
            for (node, external) in self.nodes.iter_mut().zip(&self.external) {
                node.wrench = -external;
            }
            for index in (0..self.links.len()).rev() {
                let (link, node) = (&self.links[index], &self.nodes[index]);
                let columns = &self.columns[link.columns.clone()];
                for (rest, column) in rest[link.speeds.clone()].iter_mut().zip(columns) {
                    *rest += column.dot(&node.wrench);
                }
                self.add_to_parent(index);
            }
        }
        self.add_armature(rates, rest);
    }
}
