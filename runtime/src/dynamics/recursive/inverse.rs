//! Inverse dynamics, what the joints carry, and constraint forces.

use super::Recursive;
use crate::dynamics::DynamicsError;
use crate::mechanism::{Space, StateError, WHOLE, check_size};
use crate::spatial::turn_back;
use nalgebra::{Cholesky, Matrix6, Vector6};

/// A joint moves a body in six ways at most.
pub(super) use crate::joint::MOST_FREEDOMS;

impl Recursive {
    /// `S̄ᵀτ` into `efforts` (one entry per speed): what inputs must exert, beside the elements, for the mechanism to accelerate with
    /// `accelerations` = v̄̇ at `q` and v̄. Constraints that couple joints exert nothing here: for their share see [`Recursive::coupling_force`].
    ///
    /// # Errors
    /// When a vector has the wrong size, or is not finite.
    pub fn inverse_dynamics(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        accelerations: &[f64],
        efforts: &mut [f64],
    ) -> Result<(), StateError> {
        self.check_room("efforts", efforts)?;
        self.with_inputs(
            q,
            &[("speeds", speeds), ("accelerations", accelerations)],
            |dynamics| {
                dynamics.advance(q, speeds, Some(accelerations));
                dynamics.gather_needed(q, speeds, efforts);
                dynamics.add_armature(accelerations, efforts);
                Ok::<_, StateError>(())
            },
        )?;
        let found = [("effort", Space::Speeds, &*efforts)];
        self.mechanism.check_finite((q, speeds), &found)
    }

    /// `C̄ v̄ + S̄ᵀN̂` of the tree into `efforts` (one entry per speed): inverse dynamics at v̄̇ = 0.
    ///
    /// # Errors
    /// When a vector has the wrong size, or is not finite.
    pub fn bias_forces(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &mut [f64],
    ) -> Result<(), StateError> {
        self.check_room("efforts", efforts)?;
        self.with_inputs(q, &[("speeds", speeds)], |dynamics| {
            dynamics.advance(q, speeds, None);
            dynamics.gather_needed(q, speeds, efforts);
            Ok::<_, StateError>(())
        })?;
        let found = [("effort", Space::Speeds, &*efforts)];
        self.mechanism.check_finite((q, speeds), &found)
    }

    /// What inputs must do beside the elements for the bodies to take the wrenches of the nodes.
    fn gather_needed(&mut self, q: &[f64], speeds: &[f64], efforts: &mut [f64]) {
        if !self.acted_on {
            return self.gather(efforts);
        }
        self.act(q, speeds, None);
        self.relieve();
        self.gather(efforts);
        for (effort, element) in efforts.iter_mut().zip(&self.forces) {
            *effort -= element;
        }
    }

    /// The wrench that the joint of `body` exerts on its child, in the joint's child frame, as of the last
    /// [`Recursive::inverse_dynamics`], or of [`Recursive::coupling_force`] where constraints couple joints; `None` when there is no such
    /// body.
    pub fn joint_wrench(&self, body: usize) -> Option<Vector6<f64>> {
        let node = self.nodes.get(body)?;
        Some(turn_back(&node.motion.placement.rotation, &node.wrench))
    }

    /// `X^cᵀF = τ + Aλ` of every joint into `efforts` (one entry per degree of freedom), as of the last
    /// [`Recursive::inverse_dynamics`] at `q`, or [`Recursive::coupling_force`] where constraints couple joints: also what it takes to move a
    /// joint whose motion is prescribed. What rotors take comes on top.
    ///
    /// # Errors
    /// When a vector has the wrong size, or is not finite.
    pub fn joint_efforts(&self, q: &[f64], efforts: &mut [f64]) -> Result<(), StateError> {
        self.check(q, &[])?;
        self.mechanism
            .check_room("efforts", Space::Freedoms, efforts)?;
        for (index, body) in self.mechanism.joints() {
            self.joint_effort(index, q, &mut efforts[body.ranges().freedoms.clone()]);
        }
        Ok(())
    }

    /// `X^cᵀF` of one joint, summed over the bodies that it carries.
    pub(super) fn joint_effort(&self, index: usize, q: &[f64], effort: &mut [f64]) {
        effort.fill(0.0);
        for index in self.mechanism.carried(index) {
            let link = &self.links[index];
            let wrench = self.joint_wrench(index).unwrap_or_default();
            let mut map = [0.0; 6 * MOST_FREEDOMS];
            let map = &mut map[..6 * effort.len()];
            let q = &q[link.configuration.clone()];
            link.joint.twist_map_child(q, map);
            for (effort, column) in effort.iter_mut().zip(map.chunks_exact(6)) {
                *effort += column.iter().zip(&wrench).map(|(x, f)| x * f).sum::<f64>();
            }
        }
    }

    /// `λ = (AᵀA)⁻¹Aᵀ(X^cᵀF − τ)` into `forces` (one entry a constraint), for applied efforts τ (one per degree of freedom), as of
    /// the last [`Recursive::inverse_dynamics`] at `q`, or [`Recursive::coupling_force`] where constraints couple joints. Entries of τ of joints
    /// whose motion is prescribed are not read.
    ///
    /// # Errors
    /// When a vector has the wrong size; when A has lost rank.
    pub fn constraint_force(
        &self,
        q: &[f64],
        efforts: &[f64],
        forces: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let layout = self.mechanism.layout();
        self.check(q, &[])?;
        self.check_efforts(q, &[], efforts)?;
        check_size(WHOLE, "constraint forces", layout.constraints, forces.len())?;
        for (index, body) in self.mechanism.joints() {
            let ranges = body.ranges();
            let mut carried = [0.0; MOST_FREEDOMS];
            let carried = &mut carried[..ranges.freedoms.len()];
            self.joint_effort(index, q, carried);
            self.add_rotor_efforts(index, q, carried);
            let applied = match self.links[index].driven {
                // They begin with its accelerations, and no effort of its own has a part along A.
                true => &[],
                false => &efforts[ranges.freedoms.clone()],
            };
            for (effort, applied) in carried.iter_mut().zip(applied) {
                *effort -= applied;
            }
            if !self.mechanism.elements().is_empty() {
                let elements = &self.efforts[ranges.freedoms.clone()];
                for (effort, element) in carried.iter_mut().zip(elements) {
                    *effort -= element;
                }
            }
            let own = &mut forces[ranges.constraints.clone()];
            let mut constraint = [0.0; MOST_FREEDOMS * MOST_FREEDOMS];
            let constraint = &mut constraint[..carried.len() * own.len()];
            body.joint().constraint(body.configuration(q), constraint);
            outside(constraint, carried, own)?;
        }
        Ok(())
    }
}

/// `(AᵀA)⁻¹ Aᵀ f` of one joint, A column by column; six constraints at most, unused rows are those of the identity.
fn outside(constraint: &[f64], f: &[f64], forces: &mut [f64]) -> Result<(), DynamicsError> {
    let (rows, size) = (f.len(), forces.len());
    let column = |i: usize| &constraint[i * rows..(i + 1) * rows];
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let mut gram = Matrix6::identity();
    let mut side = Vector6::zeros();
    for i in 0..size {
        side[i] = dot(column(i), f);
        for j in 0..size {
            gram[(i, j)] = dot(column(i), column(j));
        }
    }
    let factors = Cholesky::new(gram).ok_or(DynamicsError::DependentConstraints)?;
    forces.copy_from_slice(&factors.solve(&side).as_slice()[..size]);
    Ok(())
}
