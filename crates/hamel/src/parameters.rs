//! Inertial parameters of a model: what identification and adaptive control ask for.

use crate::{Error, Model};
use hamel_integrate::State;
use hamel_runtime::dynamics::JointTorqueRegressor;
use hamel_runtime::dynamics::parameters::{BaseParameters, ParameterError};
use hamel_runtime::mechanism::EnergyRegressor;
use nalgebra::DVector;

impl Model {
    /// π: ten parameters a body, in the order of [`Model::bodies`], `m, mc_x, mc_y, mc_z, I_xx, I_xy, I_yy, I_xz, I_yz, I_zz` in its body frame and about
    /// that frame's origin; kg, kg m, kg m².
    pub fn inertial_parameters(&self) -> DVector<f64> {
        DVector::from_vec(self.mechanism().inertial_parameters())
    }

    /// Y and τ₀ with `τ = Y π + τ₀`, where τ are the efforts of [`Model::inverse_dynamics`] for v̄̇ = `accelerations`.
    ///
    /// # Errors
    /// A wrong size; numbers that are not finite.
    pub fn joint_torque_regressor(
        &mut self,
        state: &State,
        accelerations: &[f64],
    ) -> Result<JointTorqueRegressor, Error> {
        let mut regressor = JointTorqueRegressor::new(self.mechanism());
        let (q, speeds) = (&*state.configuration, &*state.speeds);
        self.dynamics_mut()
            .joint_torque_regressor(q, speeds, accelerations, &mut regressor)?;
        Ok(regressor)
    }

    /// Kinetic and potential energy as linear forms in π, J.
    ///
    /// # Errors
    /// A wrong size; numbers that are not finite.
    pub fn energy_regressor(&self, state: &State) -> Result<EnergyRegressor, Error> {
        let (q, speeds) = (&*state.configuration, &*state.speeds);
        Ok(self.mechanism().energy_regressor(q, speeds)?)
    }

    /// The combinations of inertial parameters on which the efforts depend.
    ///
    /// # Errors
    /// A joint of which too few configurations are found.
    pub fn base_parameters(&self) -> Result<BaseParameters, ParameterError> {
        BaseParameters::new(self.mechanism())
    }
}
