//! Theorems 2 and 3 as they stand: every matrix of (24)–(28) and (34)–(37) can be looked at.
//!
//! Index patterns follow the paper, with its errata set right: (26) contracts momentum with the rows of S and velocity with
//! S⁻¹; after (36), `p = M S̄ M̄⁻¹ p̄`. Cost grows with the cube of the number of freedoms, and matrices are allocated.

mod equipment;
mod expansion;
mod factor;
mod holonomic;
mod nonholonomic;
mod tree;

pub use expansion::Expansion;

use super::{Dynamics, DynamicsError};
use crate::mechanism::{Mechanism, StateError, WHOLE, check_size};
use alloc::sync::Arc;
use alloc::vec;
use equipment::{ElementForces, driven, driven_freedoms};
use nalgebra::DVector;

/// The reference form of a mechanism's dynamics.
#[derive(Clone, Debug)]
pub struct Reference {
    mechanism: Arc<Mechanism>,
}

impl Reference {
    /// The reference form of `mechanism`.
    pub const fn new(mechanism: Arc<Mechanism>) -> Self {
        Self { mechanism }
    }

    /// All that Theorems 2 and 3 need at `q`, to first order in ϕ.
    ///
    /// # Errors
    /// When `q` has the wrong size.
    pub fn expansion(&self, q: &[f64]) -> Result<Expansion, StateError> {
        Expansion::new(&self.mechanism, q)
    }

    /// λ at `q` and v̄ under efforts τ, (37): the constraints act on the joints with efforts Aλ.
    ///
    /// # Errors
    /// A singular mass matrix; dependent constraints; a wrong size.
    pub fn constraint_force(
        &self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
    ) -> Result<DVector<f64>, DynamicsError> {
        let layout = self.mechanism.layout();
        let speeds = vector("speeds", layout.speeds, speeds)?;
        let efforts = vector("efforts", layout.freedoms, efforts)?;
        self.expansion(q)?
            .constraint_force(&self.mechanism, &speeds, &efforts)
    }
}

/// A slice of the right size as a vector.
fn vector(
    quantity: &'static str,
    expected: usize,
    slice: &[f64],
) -> Result<DVector<f64>, StateError> {
    check_size(WHOLE, quantity, expected, slice.len())?;
    Ok(DVector::from_column_slice(slice))
}

impl Dynamics for Reference {
    fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }

    fn accelerations(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let layout = self.mechanism.layout();
        let speeds = vector("speeds", layout.speeds, speeds)?;
        let efforts = vector("efforts", layout.freedoms, efforts)?;
        check_size(WHOLE, "rates", layout.speeds, rates.len())?;
        let expansion = self.expansion(q)?;
        let elements = ElementForces::new(&self.mechanism, &expansion, q, speeds.as_slice())?;
        let known = driven_freedoms(&self.mechanism, efforts.as_slice());
        let efforts = efforts + elements.efforts;
        let solution = expansion.solve_accelerations(&self.mechanism, &speeds, &efforts, &known)?;
        rates.copy_from_slice(solution.as_slice());
        Ok(())
    }

    fn momenta(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        momenta: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let size = self.mechanism.layout().speeds;
        let speeds = vector("speeds", size, speeds)?;
        check_size(WHOLE, "momenta", size, momenta.len())?;
        let mut product = self.expansion(q)?.reduced_mass_matrix() * &speeds;
        for (index, speed) in driven(&self.mechanism, speeds.as_slice()) {
            product[index] = speed;
        }
        momenta.copy_from_slice(product.as_slice());
        Ok(())
    }

    fn speeds(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        speeds: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let size = self.mechanism.layout().speeds;
        let momenta = vector("momenta", size, momenta)?;
        check_size(WHOLE, "speeds", size, speeds.len())?;
        let solution = self.expansion(q)?.speeds(&self.mechanism, &momenta)?;
        speeds.copy_from_slice(solution.as_slice());
        Ok(())
    }

    fn momentum_rates(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        efforts: &mut dyn FnMut(&[f64], &mut [f64]),
        speeds: &mut [f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let layout = self.mechanism.layout();
        let momenta = vector("momenta", layout.speeds, momenta)?;
        check_size(WHOLE, "speeds", layout.speeds, speeds.len())?;
        check_size(WHOLE, "rates", layout.speeds, rates.len())?;
        let expansion = self.expansion(q)?;
        let v = expansion.speeds(&self.mechanism, &momenta)?;
        speeds.copy_from_slice(v.as_slice());
        let mut tau = vec![0.0; layout.freedoms];
        efforts(speeds, &mut tau);
        let known = driven_freedoms(&self.mechanism, &tau);
        let elements = ElementForces::new(&self.mechanism, &expansion, q, speeds)?;
        let tau = DVector::from_vec(tau) + elements.efforts;
        rates.copy_from_slice(expansion.reduced_momentum_rate(&v, &tau).as_slice());
        for (index, rate) in known {
            rates[index] = rate;
        }
        Ok(())
    }

    fn hamiltonian(&mut self, q: &[f64], momenta: &[f64]) -> Result<f64, DynamicsError> {
        let momenta = vector("momenta", self.mechanism.layout().speeds, momenta)?;
        let expansion = self.expansion(q)?;
        let v = expansion.speeds(&self.mechanism, &momenta)?;
        let elements = ElementForces::new(&self.mechanism, &expansion, q, v.as_slice())?;
        let kinetic = 0.5 * v.dot(&(expansion.reduced_mass_matrix() * &v));
        Ok(kinetic + expansion.potential + elements.energy)
    }
}
