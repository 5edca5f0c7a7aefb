//! Velocities of one joint: from a twist to v, from v to v̄ and back.

use super::check::{Space, check_size};
use super::inverse_kinematics::least_squares;
use super::{Body, Mechanism, StateError};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{DMatrix, DVector, DVectorView, Vector6};

/// How far a velocity may violate `Aᵀ v = 0`, relative to max(1, |v|).
pub const CONSTRAINT_TOLERANCE: f64 = 1e-9;

impl Body {
    /// X^c at this joint's Q.
    pub(super) fn twist_map_child(&self, q: &[f64]) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(6, self.ranges.freedoms.len());
        self.joint().twist_map_child(q, matrix.as_mut_slice());
        matrix
    }

    /// S̄ at this joint's Q.
    pub(super) fn speed_basis(&self, q: &[f64]) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.ranges.freedoms.len(), self.ranges.speeds.len());
        self.joint().speed_basis(q, matrix.as_mut_slice());
        matrix
    }

    fn check_constraint(&self, q: &[f64], v: &DVector<f64>) -> Result<(), StateError> {
        let mut constraint = DMatrix::zeros(v.len(), self.ranges.constraints.len());
        self.joint().constraint(q, constraint.as_mut_slice());
        let value = constraint.tr_mul(v).amax();
        let limit = CONSTRAINT_TOLERANCE * v.norm().max(1.0);
        if value <= limit {
            return Ok(());
        }
        Err(StateError::ConstraintViolated {
            joint: self.joint_name().into(),
            value,
            limit,
        })
    }
}

impl Mechanism {
    /// The v of the joint under body `body`, at the joint's own configuration `q`, that makes its child move with
    /// `twist` relative to its parent; `twist` in the joint's child frame.
    ///
    /// # Errors
    /// When the joint cannot move so, to 1e-9 of max(1, |twist|); NaN; wrong size; no such body.
    pub fn velocity_from_twist(
        &self,
        body: usize,
        q: &[f64],
        twist: &Vector6<f64>,
    ) -> Result<Vec<f64>, StateError> {
        let body = self.body(body)?;
        body.check_configuration(q)?;
        let entries = ["omega_x", "omega_y", "omega_z", "v_x", "v_y", "v_z"];
        body.check_finite("twist", &entries, twist.as_slice())?;
        let map = body.twist_map_child(q);
        let target = DVector::from_column_slice(twist.as_slice());
        let velocity = least_squares(&map, &target);
        let residual = (&map * &velocity - &target).norm();
        let limit = CONSTRAINT_TOLERANCE * target.norm().max(1.0);
        if residual.is_nan() || residual > limit {
            return Err(StateError::TwistOutsideFreedoms {
                joint: body.joint_name().into(),
                residual,
                limit,
            });
        }
        Ok(velocity.as_slice().to_vec())
    }

    /// The speeds v̄ with `v = S̄ v̄`, for the joint under body `body` at its own configuration `q`.
    ///
    /// # Errors
    /// When v violates `Aᵀ v = 0` beyond [`CONSTRAINT_TOLERANCE`]; NaN; wrong size; no such body.
    pub fn speeds_from_velocity(
        &self,
        body: usize,
        q: &[f64],
        velocity: &[f64],
    ) -> Result<Vec<f64>, StateError> {
        let body = self.body(body)?;
        body.check_configuration(q)?;
        let freedoms = body.ranges.freedoms.len();
        check_size(body.joint_name(), "velocity", freedoms, velocity.len())?;
        body.check_finite("velocity", body.joint().freedoms(), velocity)?;
        if body.joint().structures().speed_basis.is_identity() {
            return Ok(velocity.to_vec());
        }
        let v = DVector::from_column_slice(velocity);
        body.check_constraint(q, &v)?;
        Ok(least_squares(&body.speed_basis(q), &v).as_slice().to_vec())
    }

    /// `v = S̄ v̄` of all joints.
    ///
    /// # Errors
    /// When a vector has the wrong size, or is not finite.
    pub fn velocity_from_speeds(&self, q: &[f64], speeds: &[f64]) -> Result<Vec<f64>, StateError> {
        self.check_vector("configuration", Space::Configuration, q)?;
        self.check_vector("speeds", Space::Speeds, speeds)?;
        let mut velocity = vec![0.0; self.layout.freedoms];
        for (_, body) in self.joints() {
            let own = DVectorView::from_slice(
                &speeds[body.ranges.speeds.clone()],
                body.ranges.speeds.len(),
            );
            let v = body.speed_basis(body.configuration(q)) * own;
            velocity[body.ranges.freedoms.clone()].copy_from_slice(v.as_slice());
        }
        Ok(velocity)
    }
}
