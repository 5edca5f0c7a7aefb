//! The mechanism at one time, in the quantities that all outputs show.

use hamel::mechanism::{Body, BodyState, Kinematics, Mechanism, NamedFrame, StateError};
use hamel::spatial::{Pose, so3};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use serde::Serialize;

/// All bodies at one time, and what a controller does then.
#[derive(Clone, Debug, Serialize)]
pub struct Sample<'a> {
    /// Time, s.
    pub t: f64,
    /// Kinetic and potential energy, the latter zero at the world's origin, J.
    pub energy: f64,
    /// The bodies, in the order of the mechanism.
    pub bodies: Vec<BodySample<'a>>,
    /// The named frames, in the order of the mechanism.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub frames: Vec<FrameSample<'a>>,
    /// What the controller exerts, joint by joint; empty where there is none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub efforts: Vec<EffortSample<'a>>,
}

/// One named frame at one time.
#[derive(Clone, Debug, Serialize)]
pub struct FrameSample<'a> {
    /// Name of the frame.
    pub name: &'a str,
    /// Its origin, world axes, m.
    pub position: [f64; 3],
    /// Unit quaternion from frame axes to world axes, scalar first and not negative.
    pub quaternion_frame_to_world_wxyz: [f64; 4],
}

/// A controller's efforts at one joint.
#[derive(Clone, Debug, Serialize)]
pub struct EffortSample<'a> {
    /// Name of the joint.
    pub joint: &'a str,
    /// τ, one entry a freedom, N m or N.
    pub tau: Vec<f64>,
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

/// All bodies in the state (`q`, `speeds`), where outputs have numbers for it.
///
/// # Errors
/// A state of the wrong size; an energy that is not finite.
pub fn kinematics(
    mechanism: &Mechanism,
    (q, speeds): (&[f64], &[f64]),
) -> Result<Kinematics, StateError> {
    let kinematics = mechanism.kinematics(q, speeds)?;
    if !kinematics.energy().is_finite() {
        // Which says whose energy it is.
        mechanism.check_energy(q, speeds)?;
    }
    Ok(kinematics)
}

impl<'a> Sample<'a> {
    /// The mechanism at the time `t` in the state (`q`, `speeds`), under a controller's `efforts` (empty without one).
    ///
    /// # Errors
    /// A state of the wrong size; an energy that is not finite.
    pub fn new(
        mechanism: &'a Mechanism,
        t: f64,
        (q, speeds): (&[f64], &[f64]),
        efforts: &[f64],
    ) -> Result<Self, StateError> {
        let kinematics = kinematics(mechanism, (q, speeds))?;
        Ok(Self::of(mechanism, t, &kinematics, efforts))
    }

    /// The mechanism at the time `t` where its kinematics are known, under a controller's `efforts` (empty without one).
    pub fn of(mechanism: &'a Mechanism, t: f64, kinematics: &Kinematics, efforts: &[f64]) -> Self {
        let bodies = mechanism.bodies().iter().zip(&kinematics.bodies);
        let frames = mechanism.frames().iter();
        let owners = mechanism.bodies().iter().filter(|_| !efforts.is_empty());
        Self {
            t,
            energy: kinematics.energy(),
            bodies: bodies
                .map(|(body, state)| BodySample::new(body.name(), state))
                .collect(),
            frames: frames
                .map(|frame| FrameSample::new(frame, kinematics))
                .collect(),
            efforts: owners
                .map(|owner| EffortSample::new(owner, efforts))
                .collect(),
        }
    }

    /// A row of the trajectory: time, energy, position, attitude and velocities of each body, poses of the frames, efforts.
    pub fn numbers(&self) -> Vec<f64> {
        let bodies = self.bodies.iter().flat_map(|body| {
            let pose = body.position_com.into_iter().chain(body.rotation_vector());
            pose.chain(body.velocity_com_world)
                .chain(body.angular_velocity_body)
        });
        let frames = self.frames.iter().flat_map(|frame| {
            let position = frame.position.into_iter();
            position.chain(frame.quaternion_frame_to_world_wxyz)
        });
        let efforts = self.efforts.iter().flat_map(|efforts| &efforts.tau);
        let head = [self.t, self.energy].into_iter();
        head.chain(bodies)
            .chain(frames)
            .chain(efforts.copied())
            .collect()
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

impl<'a> FrameSample<'a> {
    fn new(frame: &'a NamedFrame, kinematics: &Kinematics) -> Self {
        let pose = match frame.body {
            Some(body) => kinematics.bodies[body].pose * frame.at,
            None => frame.at,
        };
        let [x, y, z, quaternion @ ..] = seven(&pose);
        Self {
            name: &frame.name,
            position: [x, y, z],
            quaternion_frame_to_world_wxyz: quaternion,
        }
    }
}

impl<'a> EffortSample<'a> {
    fn new(owner: &'a Body, efforts: &[f64]) -> Self {
        Self {
            joint: owner.joint_name(),
            tau: efforts[owner.ranges().freedoms.clone()].to_vec(),
        }
    }
}

/// A pose as position, m, and unit quaternion, scalar first and not negative.
pub fn seven(pose: &Pose<f64>) -> [f64; 7] {
    let [x, y, z] = pose.translation.into();
    let rotation = Rotation3::from_matrix_unchecked(pose.rotation);
    let attitude = UnitQuaternion::from_rotation_matrix(&rotation);
    let sign = if attitude.w < 0.0 { -1.0 } else { 1.0 };
    let [i, j, k, w] = (attitude.coords * sign).into();
    [x, y, z, w, i, j, k]
}
