//! Theorems 2 and 3 as they stand: every matrix of (24)–(28) and (34)–(37) can be looked at.
//!
//! Index patterns follow the paper, with its errata set right: (26) contracts momentum with the rows of S and velocity with
//! S⁻¹; after (36), `p = M S̄ M̄⁻¹ p̄`. Cost grows with the cube of the number of degrees of freedom, and matrices are allocated.

mod actuation;
mod coupling;
mod expansion;
mod factor;
mod holonomic;
mod nonholonomic;
mod tree;

pub use expansion::Expansion;

use super::{Dynamics, DynamicsError, ForwardDerivatives, HamiltonianDerivatives, Recursive};
use crate::mechanism::{Mechanism, Space, StateError};
use crate::time_function::Moment;
use actuation::{ElementForces, driven, driven_freedoms};
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec;
use nalgebra::DVector;

/// The reference form of a mechanism's dynamics.
#[derive(Clone, Debug)]
pub struct Reference {
    mechanism: Arc<Mechanism>,
    /// When elements act.
    moment: Moment,
}

impl Reference {
    /// The reference form of `mechanism`.
    pub const fn new(mechanism: Arc<Mechanism>) -> Self {
        Self {
            mechanism,
            moment: Moment {
                time: 0.0,
                within: 0.0,
            },
        }
    }

    /// All that Theorems 2 and 3 need at `q`, to first order in ϕ.
    ///
    /// # Errors
    /// When `q` has the wrong size, or a kernel of a joint is not finite there.
    pub fn expansion(&self, q: &[f64]) -> Result<Expansion, StateError> {
        Expansion::new(&self.mechanism, q)
    }

    /// λ at `q` and v̄ under efforts τ, (37): the constraints act on the joints with efforts Aλ. Those of the joints come first, then those
    /// that couple joints. For a mechanism without drives.
    ///
    /// # Errors
    /// A singular mass matrix; dependent constraints; a wrong size.
    pub fn constraint_force(
        &self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
    ) -> Result<DVector<f64>, DynamicsError> {
        let speeds = self.speeds_of("speeds", speeds)?;
        let efforts = self.efforts_of(efforts)?;
        let expansion = self.expansion(q)?;
        let elements = ElementForces::new(&self.mechanism, &expansion, (q, speeds), self.moment)?;
        let reduced = expansion.select(speeds);
        expansion.constraint_force(&self.mechanism, &reduced, &(efforts + elements.efforts))
    }
}

impl Reference {
    /// Numbers with one entry per speed: of the right size, and finite.
    fn speeds_of<'a>(
        &self,
        quantity: &'static str,
        slice: &'a [f64],
    ) -> Result<&'a [f64], StateError> {
        self.mechanism
            .check_vector(quantity, Space::Speeds, slice)?;
        Ok(slice)
    }

    /// τ as a vector, of the right size and finite.
    fn efforts_of(&self, slice: &[f64]) -> Result<DVector<f64>, StateError> {
        self.mechanism
            .check_vector("efforts", Space::Freedoms, slice)?;
        Ok(DVector::from_column_slice(slice))
    }

    /// Whether room for results has one entry per speed.
    fn check_room(&self, quantity: &'static str, room: &[f64]) -> Result<(), StateError> {
        self.mechanism.check_room(quantity, Space::Speeds, room)
    }

    /// v̄ of the joints, and the independent among it, from p̄.
    fn solve_speeds(
        &self,
        expansion: &Expansion,
        q: &[f64],
        momenta: &[f64],
    ) -> Result<(DVector<f64>, DVector<f64>), DynamicsError> {
        let known = driven(&self.mechanism, expansion, momenta);
        let reduced = expansion.select(momenta);
        let reduced = expansion.solve_speeds(&self.mechanism, &reduced, &known)?;
        let speeds = expansion.whole_speeds(&self.mechanism, q, &reduced);
        Ok((speeds, reduced))
    }
}

impl Dynamics for Reference {
    fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }

    fn of(&self, mechanism: Arc<Mechanism>) -> Box<dyn Dynamics> {
        Box::new(Self::new(mechanism))
    }

    fn set_moment(&mut self, moment: Moment) {
        self.moment = moment;
    }

    fn complete_speeds(&mut self, q: &[f64], speeds: &mut [f64]) -> Result<(), DynamicsError> {
        self.speeds_of("speeds", speeds)?;
        let expansion = self.expansion(q)?;
        let reduced = expansion.select(speeds);
        let whole = expansion.whole_speeds(&self.mechanism, q, &reduced);
        for &speed in self.mechanism.dependent_speeds() {
            speeds[speed] = whole[speed];
        }
        Ok(())
    }

    fn forward_dynamics(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let speeds = self.speeds_of("speeds", speeds)?;
        let efforts = self.efforts_of(efforts)?;
        self.check_room("rates", rates)?;
        let expansion = self.expansion(q)?;
        let elements = ElementForces::new(&self.mechanism, &expansion, (q, speeds), self.moment)?;
        let known = driven_freedoms(&self.mechanism, &expansion, efforts.as_slice());
        let efforts = efforts + elements.efforts;
        let reduced = expansion.select(speeds);
        let solution =
            expansion.solve_accelerations(&self.mechanism, &reduced, &efforts, &known)?;
        expansion.scatter(&solution, rates);
        Ok(())
    }

    fn momenta(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        momenta: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let speeds = self.speeds_of("speeds", speeds)?;
        self.check_room("momenta", momenta)?;
        let expansion = self.expansion(q)?;
        let mut product = expansion.reduced_mass_matrix() * expansion.select(speeds);
        for (index, speed) in driven(&self.mechanism, &expansion, speeds) {
            product[index] = speed;
        }
        expansion.scatter(&product, momenta);
        Ok(())
    }

    fn speeds(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        speeds: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let momenta = self.speeds_of("momenta", momenta)?;
        self.check_room("speeds", speeds)?;
        let expansion = self.expansion(q)?;
        let (solution, _) = self.solve_speeds(&expansion, q, momenta)?;
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
        let momenta = self.speeds_of("momenta", momenta)?;
        self.check_room("speeds", speeds)?;
        self.check_room("rates", rates)?;
        let expansion = self.expansion(q)?;
        let (whole, reduced) = self.solve_speeds(&expansion, q, momenta)?;
        speeds.copy_from_slice(whole.as_slice());
        let mut tau = vec![0.0; self.mechanism.layout().freedoms];
        efforts(speeds, &mut tau);
        self.efforts_of(&tau)?;
        let known = driven_freedoms(&self.mechanism, &expansion, &tau);
        let elements = ElementForces::new(&self.mechanism, &expansion, (q, speeds), self.moment)?;
        let tau = DVector::from_vec(tau) + elements.efforts;
        let mut solution = expansion.reduced_momentum_rate(&reduced, &tau);
        for (index, rate) in known {
            solution[index] = rate;
        }
        expansion.scatter(&solution, rates);
        Ok(())
    }

    fn hamiltonian(&mut self, q: &[f64], momenta: &[f64]) -> Result<f64, DynamicsError> {
        let momenta = self.speeds_of("momenta", momenta)?;
        let expansion = self.expansion(q)?;
        let (whole, reduced) = self.solve_speeds(&expansion, q, momenta)?;
        let elements = ElementForces::new(
            &self.mechanism,
            &expansion,
            (q, whole.as_slice()),
            self.moment,
        )?;
        let kinetic = 0.5 * reduced.dot(&(expansion.reduced_mass_matrix() * &reduced));
        Ok(kinetic + expansion.potential + elements.energy)
    }

    fn forward_dynamics_derivatives(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        out: &mut ForwardDerivatives,
    ) -> Result<(), DynamicsError> {
        Recursive::new(Arc::clone(&self.mechanism))
            .forward_dynamics_derivatives(q, speeds, efforts, out)
    }

    fn hamiltonian_derivatives(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        efforts: &[f64],
        out: &mut HamiltonianDerivatives,
    ) -> Result<(), DynamicsError> {
        Recursive::new(Arc::clone(&self.mechanism))
            .hamiltonian_derivatives(q, momenta, efforts, out)
    }
}
