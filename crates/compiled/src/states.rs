//! What compiled equations tell of a state beside what the trait `Dynamics` asks: inverse dynamics, M̄, energies, poses.

use super::tree::Compiled;
use alloc::vec::Vec;
use hamel_runtime::dynamics::{Dynamics, DynamicsError, InverseDerivatives, MassMatrix};
use hamel_runtime::mechanism::{Mechanism, StateError, WHOLE, check_size};
use hamel_runtime::scalar::all_finite;

/// Numbers of the pose of a body: a rotation, and an origin.
const POSE: usize = 12;

impl Compiled {
    /// `S̄ᵀτ` into `efforts` (one entry per speed), as [`Recursive::inverse_dynamics`](hamel_runtime::dynamics::Recursive::inverse_dynamics) has it.
    ///
    /// # Errors
    /// A wrong size; a number that is not finite.
    pub fn inverse_dynamics(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        accelerations: &[f64],
        efforts: &mut [f64],
    ) -> Result<(), StateError> {
        // The module is not told of efforts that change with time.
        if let Some(inverse) =
            (self.functions.inverse_dynamics.as_ref()).filter(|_| !self.timed.are_there)
        {
            self.check(q, [("speeds", speeds), ("accelerations", accelerations)])?;
            self.check_room("efforts", efforts)?;
            inverse(q, speeds, accelerations, efforts);
            if all_finite(efforts) {
                return Ok(());
            }
        }
        self.tree
            .inverse_dynamics(q, speeds, accelerations, efforts)
    }

    /// Inverse dynamics at v̄̇ = 0 into `efforts` (one entry per speed).
    ///
    /// # Errors
    /// A wrong size; a number that is not finite.
    pub fn bias_forces(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &mut [f64],
    ) -> Result<(), StateError> {
        if let Some(bias) = (self.functions.bias_forces.as_ref()).filter(|_| !self.timed.are_there)
        {
            self.check(q, [("speeds", speeds)])?;
            self.check_room("efforts", efforts)?;
            bias(q, speeds, &[], efforts);
            if all_finite(efforts) {
                return Ok(());
            }
        }
        self.tree.bias_forces(q, speeds, efforts)
    }

    /// M̄ into `rows`, one after the other.
    ///
    /// # Errors
    /// A wrong size; a number that is not finite.
    pub fn mass_matrix(&mut self, q: &[f64], rows: &mut [f64]) -> Result<(), StateError> {
        let size = self.functions.speeds;
        self.check(q, [])?;
        check_size(WHOLE, "entries of the mass matrix", size * size, rows.len())?;
        if let Some(mass) = &self.functions.mass_matrix {
            mass(q, &[], &[], rows);
            if all_finite(rows) {
                return Ok(());
            }
        }
        let mechanism = self.tree.mechanism();
        let mut mass = MassMatrix::new(mechanism);
        self.tree.mass_matrix(q, &mut mass)?;
        for (index, entry) in rows.iter_mut().enumerate() {
            *entry = mass.entry(index / size, index % size);
        }
        Ok(())
    }

    /// Kinetic and potential energy, J.
    ///
    /// # Errors
    /// A wrong size; a number that is not finite.
    pub fn energies(&mut self, q: &[f64], speeds: &[f64]) -> Result<[f64; 2], StateError> {
        if let Some(energies) = &self.functions.energies {
            self.check(q, [("speeds", speeds)])?;
            let mut found = [0.0; 2];
            energies(q, speeds, &[], &mut found);
            if all_finite(&found) {
                return Ok(found);
            }
        }
        let found = self.tree.mechanism().kinematics(q, speeds)?;
        Ok([found.kinetic_energy(), found.potential_energy()])
    }

    /// Poses of all bodies into `numbers`: of each its rotation to world axes by rows, and its origin, m.
    ///
    /// # Errors
    /// A wrong size; a number that is not finite.
    pub fn poses(&mut self, q: &[f64], numbers: &mut [f64]) -> Result<(), StateError> {
        self.check(q, [])?;
        let bodies = self.tree.mechanism().bodies().len();
        check_size(WHOLE, "numbers of poses", POSE * bodies, numbers.len())?;
        if let Some(poses) = &self.functions.poses {
            poses(q, &[], &[], numbers);
            if all_finite(numbers) {
                return Ok(());
            }
        }
        let found = poses_of(self.tree.mechanism(), q)?;
        numbers.copy_from_slice(&found);
        Ok(())
    }

    /// The derivatives of inverse dynamics in ϕ and v̄ at (q, v̄, v̄̇) into `out`, as
    /// [`Recursive::inverse_dynamics_derivatives`](hamel_runtime::dynamics::Recursive::inverse_dynamics_derivatives) has them.
    ///
    /// # Errors
    /// A wrong size; results that were made for another mechanism; something that acts on the mechanism whose derivatives are not known.
    pub fn inverse_dynamics_derivatives(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        accelerations: &[f64],
        out: &mut InverseDerivatives,
    ) -> Result<(), DynamicsError> {
        let inverse = self.functions.inverse_dynamics_derivatives.as_ref();
        if let Some(inverse) = inverse.filter(|_| !self.timed.are_there) {
            self.check(q, [("speeds", speeds), ("accelerations", accelerations)])?;
            let count = speeds.len() * (self.functions.freedoms + speeds.len());
            let rows = &mut self.rows[..count];
            inverse(q, speeds, accelerations, rows);
            if all_finite(rows) {
                return out.read(rows);
            }
        }
        self.tree
            .inverse_dynamics_derivatives(q, speeds, accelerations, out)
    }
}

/// Poses of all bodies by the mechanism, as the function of a module has them.
pub(super) fn poses_of(mechanism: &Mechanism, q: &[f64]) -> Result<Vec<f64>, StateError> {
    let rest = alloc::vec![0.0; mechanism.layout().speeds];
    let found = mechanism.kinematics(q, &rest)?;
    let poses = found.bodies.iter().flat_map(|body| {
        let rotation = body.pose.rotation.transpose();
        let numbers = rotation.iter().chain(&body.pose.translation).copied();
        numbers.collect::<Vec<f64>>()
    });
    Ok(poses.collect())
}
