//! The inertial parameters of all bodies, and the energies that are linear in them.

use super::{Mechanism, StateError};
use crate::spatial::{INERTIAL_PARAMETERS, energy_row};
use alloc::vec::Vec;

/// Kinetic and potential energy as linear forms in the inertial parameters π: `T = kinetic · π + kinetic_rest`, `V = potential · π + potential_rest`.
///
/// π has ten entries a body, those of [`Mechanism::inertial_parameters`]. The energies are those of
/// [`Kinematics`](super::Kinematics), J; that of gravity is zero at the world's origin.
#[derive(Clone, Debug, PartialEq)]
pub struct EnergyRegressor {
    /// J for each unit of a parameter.
    pub kinetic: Vec<f64>,
    /// J for each unit of a parameter.
    pub potential: Vec<f64>,
    /// Kinetic energy of rotors, J.
    pub kinetic_rest: f64,
    /// Energy stored in springs and other elements, J.
    pub potential_rest: f64,
}

impl Mechanism {
    /// π: the ten inertial parameters of each body, in the order of [`Mechanism::bodies`], each in its body frame and about that frame's origin; names
    /// and units are [`INERTIAL_PARAMETER_NAMES`](crate::spatial::INERTIAL_PARAMETER_NAMES) and
    /// [`INERTIAL_PARAMETER_UNITS`](crate::spatial::INERTIAL_PARAMETER_UNITS).
    pub fn inertial_parameters(&self) -> Vec<f64> {
        let bodies = self.bodies.iter();
        bodies
            .flat_map(|body| body.mass().inertial_parameters())
            .collect()
    }

    /// The energies at `q` and v̄ as linear forms in π.
    ///
    /// # Errors
    /// When a vector has the wrong size, or is not finite.
    pub fn energy_regressor(
        &self,
        q: &[f64],
        speeds: &[f64],
    ) -> Result<EnergyRegressor, StateError> {
        let state = self.kinematics(q, speeds)?;
        let size = INERTIAL_PARAMETERS * self.bodies.len();
        let (mut kinetic, mut potential) = (Vec::with_capacity(size), Vec::with_capacity(size));
        for body in &state.bodies {
            kinetic.extend(energy_row(&body.twist, &body.twist).map(|entry| 0.5 * entry));
            let mut row = [0.0; INERTIAL_PARAMETERS];
            row[0] = -self.gravity.dot(&body.pose.translation);
            let in_body = body.pose.rotation.tr_mul(&self.gravity);
            row[1..4].copy_from_slice((-in_body).as_slice());
            potential.extend(row);
        }
        Ok(EnergyRegressor {
            kinetic,
            potential,
            kinetic_rest: state.rotor_energy,
            potential_rest: state.element_energy,
        })
    }
}
