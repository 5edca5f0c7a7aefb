//! The mechanism at one time, in the quantities that all outputs show.

use hamel::mechanism::{BodyState, Kinematics, Mechanism, StateError};
use hamel::spatial::so3;
use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

/// All bodies at one time.
#[derive(Clone, Debug, Serialize)]
pub struct Sample<'a> {
    /// Time, s.
    pub t: f64,
    /// Kinetic and potential energy, the latter zero at the world's origin, J.
    pub energy: f64,
    /// The bodies, in the order of the mechanism.
    pub bodies: Vec<BodySample<'a>>,
}

/// One body at one time.
#[derive(Clone, Debug, Serialize)]
pub struct BodySample<'a> {
    /// Name of the body.
    pub name: &'a str,
    /// Centre of mass, world axes, m.
    pub position_com: [f64; 3],
    /// R by rows: body axes to world axes.
    pub rotation_body_to_world_rowmajor: [f64; 9],
    /// Velocity of the centre of mass, world axes, m/s.
    pub velocity_com_world: [f64; 3],
    /// vee(Rᵀ Ṙ), body axes, rad/s.
    pub angular_velocity_body: [f64; 3],
}

impl<'a> Sample<'a> {
    /// The mechanism at the time `t` in the state (`q`, `speeds`).
    ///
    /// # Errors
    /// A state of the wrong size.
    pub fn new(
        mechanism: &'a Mechanism,
        t: f64,
        q: &[f64],
        speeds: &[f64],
    ) -> Result<Self, StateError> {
        Ok(Self::of(mechanism, t, &mechanism.kinematics(q, speeds)?))
    }

    /// The mechanism at the time `t` where its kinematics are known.
    pub fn of(mechanism: &'a Mechanism, t: f64, kinematics: &Kinematics) -> Self {
        let bodies = mechanism.bodies().iter().zip(&kinematics.bodies);
        Self {
            t,
            energy: kinematics.energy(),
            bodies: bodies
                .map(|(body, state)| BodySample::new(body.name(), state))
                .collect(),
        }
    }

    /// A row of the trajectory: time, energy, and position, attitude and velocities of each body.
    pub fn numbers(&self) -> Vec<f64> {
        let bodies = self.bodies.iter().flat_map(|body| {
            let pose = body.position_com.into_iter().chain(body.rotation_vector());
            pose.chain(body.velocity_com_world)
                .chain(body.angular_velocity_body)
        });
        [self.t, self.energy].into_iter().chain(bodies).collect()
    }
}

impl<'a> BodySample<'a> {
    fn new(name: &'a str, state: &BodyState) -> Self {
        let columns: [[f64; 3]; 3] = state.pose.rotation.transpose().into();
        let mut rows = [0.0; 9];
        rows.copy_from_slice(columns.as_flattened());
        Self {
            name,
            position_com: state.position_com.into(),
            rotation_body_to_world_rowmajor: rows,
            velocity_com_world: state.velocity_com.into(),
            angular_velocity_body: state.angular_velocity_body().into(),
        }
    }

    /// The attitude as a rotation vector, body to world, rad.
    pub fn rotation_vector(&self) -> [f64; 3] {
        let rotation = Matrix3::from_row_slice(&self.rotation_body_to_world_rowmajor);
        let vector: Vector3<f64> = so3::log(&rotation);
        vector.into()
    }
}
