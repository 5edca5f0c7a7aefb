//! Equations of motion of a mechanism, in Lagrangian (v̄) and port-Hamiltonian (p̄) form.
//!
//! * [`Reference`]: Theorems 2 and 3 literally, matrices and all. For reading, checking and small mechanisms.
//! * [`Recursive`]: the same in O(n), by recursions that share no formula with the former. For everything else.
//! * [`Refined`]: the same to the last digit where doubles cancel; slower.
//! * [`parameters`]: the combinations of inertial parameters on which the equations depend.
//! * [`quasi`]: Theorem 1, for systems in quasi-coordinates that a caller writes down.
//!
//! Whatever integrates or compares equations of motion does so through [`Dynamics`].

mod error;
pub mod parameters;
pub mod quasi;
pub mod recursive;
pub mod reference;

pub use error::DynamicsError;
pub use recursive::LoadedMass;
pub use recursive::{
    EffortAtPort, ForwardDerivatives, ForwardSecondDerivatives, Frame, FrameReadings,
    HamiltonianDerivatives, InverseDerivatives, InverseMassMatrix, InverseSecondDerivatives,
    JointTorqueRegressor, MassMatrix, PinError, PinForce, Readings, Recursive, Refined,
    Sensitivity,
};
pub use reference::Reference;

use crate::mechanism::Mechanism;
use crate::time_function::Moment;
use alloc::boxed::Box;
use alloc::sync::Arc;

/// Equations of motion of one mechanism.
///
/// `q` is a configuration, `speeds` v̄ and `momenta` p̄ have one entry per speed, `efforts` τ one per freedom: τ is collocated
/// with v. Where constraints couple joints ([`Mechanism::with_constraints`]), v̄ has the speeds of all joints, and the entries of dependent
/// ones are 0 in p̄ and in all rates. Configurations are taken to lie on the joints' manifolds ([`Mechanism::check_configuration`]).
/// What a call that ends with an error has written has no value.
pub trait Dynamics {
    /// The mechanism whose equations these are.
    fn mechanism(&self) -> &Arc<Mechanism>;

    /// The equations of another mechanism: of this kind and in this arithmetic, or [`Recursive`] where the kind is bound to one mechanism.
    fn of(&self, mechanism: Arc<Mechanism>) -> Box<dyn Dynamics> {
        Box::new(Recursive::new(mechanism))
    }

    /// The time at which elements act from now on, for those that change with it ([`Element::functions`](crate::elements::Element::functions)); 0 at
    /// first. Efforts that change with time are handed in as τ ([`Mechanism::add_timed_efforts`]).
    fn set_moment(&mut self, _moment: Moment) {}

    /// The speeds that constraints couple to the others, into their entries of `speeds`; the others are read. Nothing to do where no
    /// constraint couples joints.
    ///
    /// # Errors
    /// Constraints that do not determine them; a wrong size.
    fn complete_speeds(&mut self, q: &[f64], speeds: &mut [f64]) -> Result<(), DynamicsError>;

    /// v̄̇ into `rates`, (24), (34).
    ///
    /// # Errors
    /// A singular mass matrix; a wrong size.
    fn forward_dynamics(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError>;

    /// `p̄ = M̄ v̄` into `momenta`.
    ///
    /// # Errors
    /// A wrong size.
    fn momenta(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        momenta: &mut [f64],
    ) -> Result<(), DynamicsError>;

    /// `v̄ = M̄⁻¹ p̄` into `speeds`.
    ///
    /// # Errors
    /// A singular mass matrix; a wrong size.
    fn speeds(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        speeds: &mut [f64],
    ) -> Result<(), DynamicsError>;

    /// v̄ into `speeds` and p̄̇ into `rates`, (27), (35).
    ///
    /// `efforts` is handed v̄ and fills in τ, so that efforts that depend on v̄ do not cost a second factorisation.
    ///
    /// # Errors
    /// A singular mass matrix; a wrong size.
    fn momentum_rates(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        efforts: &mut dyn FnMut(&[f64], &mut [f64]),
        speeds: &mut [f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError>;

    /// `H = ½ p̄ᵀ M̄⁻¹ p̄ + V`, J.
    ///
    /// # Errors
    /// A singular mass matrix; a wrong size.
    fn hamiltonian(&mut self, q: &[f64], momenta: &[f64]) -> Result<f64, DynamicsError>;

    /// v̄̇ of [`Dynamics::forward_dynamics`] and its derivatives in local coordinates ϕ about Q, v̄ and τ into `out`, as
    /// [`Recursive::forward_dynamics_derivatives`] has them.
    ///
    /// # Errors
    /// A singular mass matrix; a wrong size; results that were made for another mechanism; [`DynamicsError::NotDifferentiable`] where something
    /// acts whose derivatives are not known.
    fn forward_dynamics_derivatives(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        out: &mut ForwardDerivatives,
    ) -> Result<(), DynamicsError>;

    /// v̄ and the derivatives of v̄ and p̄̇ of [`Dynamics::momentum_rates`] in ϕ, p̄ and τ into `out`, as [`Recursive::hamiltonian_derivatives`] has
    /// them.
    ///
    /// # Errors
    /// Those of [`Dynamics::forward_dynamics_derivatives`].
    fn hamiltonian_derivatives(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        efforts: &[f64],
        out: &mut HamiltonianDerivatives,
    ) -> Result<(), DynamicsError>;
}
