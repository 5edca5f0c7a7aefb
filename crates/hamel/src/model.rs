//! A robot or a scene with names, and what is asked of it.

use crate::error::{Error, UnknownName};
use crate::simulation::Simulation;
use hamel_integrate::State;
use hamel_joints::registry;
use hamel_runtime::dynamics::{Dynamics, Frame, FrameReadings, MassMatrix, Recursive};
use hamel_runtime::erased::Layout;
use hamel_runtime::mechanism::{Body, Mechanism, Space, check_size};
use hamel_runtime::registry::JointRegistry;
use hamel_runtime::spatial::Pose;
use hamel_scene::Scene;
use nalgebra::{DMatrix, DVector, Vector3, Vector6};
use std::path::Path;
use std::sync::Arc;

/// The model in a file: a robot in URDF, on a fixed base, or in MJCF or SDF, or a scene in TOML. Joints are those of the library. What a file says and a model does not have
/// (limits, friction, meshes) is listed in the `notices` of [`Model::scene`]; [`scene::robot`](hamel_scene::robot) reads robots in URDF that move freely.
///
/// # Errors
/// A file that cannot be read, and all mistakes of its text.
pub fn load(path: impl AsRef<Path>) -> Result<Model, Error> {
    load_with(path, &registry())
}

/// As [`load`], with the joints of `registry`.
///
/// # Errors
/// Those of [`load`].
pub fn load_with(path: impl AsRef<Path>, registry: &JointRegistry) -> Result<Model, Error> {
    Ok(Model::new(Scene::load(path, registry)?))
}

/// A mechanism with named joints, bodies and frames, its initial state and the room for its dynamics.
///
/// Methods take a [`State`] (Q, v̄) and give vectors and matrices of the right size, for all joints in the order of [`Model::joints`]. v̄ and v̄̇ have one entry
/// per speed; efforts τ one per entry of a joint's velocity v, in N m or N. Both sizes are equal except for nonholonomic joints. Where a scene prescribes the motion of a
/// joint, its entries of τ are accelerations, and those of v̄ are what the state says.
///
/// Each call allocates its result; [`Recursive`] writes into slices and allocates nothing. Clones share the mechanism and have memory of their own: make one
/// for each thread.
#[derive(Clone, Debug)]
pub struct Model {
    scene: Scene,
    dynamics: Recursive,
    mass: MassMatrix,
}

impl Model {
    /// The model of a scene.
    pub fn new(scene: Scene) -> Self {
        Self {
            dynamics: Recursive::new(Arc::clone(&scene.mechanism)),
            mass: MassMatrix::new(&scene.mechanism),
            scene,
        }
    }

    /// What it was made of: initial state, events, shapes, controller, settings, notices.
    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The bodies and their joints.
    pub const fn mechanism(&self) -> &Arc<Mechanism> {
        &self.scene.mechanism
    }

    /// The equations of motion by the recursive algorithms, for what [`Model`] does not offer.
    pub const fn dynamics_mut(&mut self) -> &mut Recursive {
        &mut self.dynamics
    }

    /// Sizes of Q (`configuration`), τ (`freedoms`) and v̄ (`speeds`).
    pub fn sizes(&self) -> &Layout {
        self.mechanism().layout()
    }

    /// Names of the joints, in the order of their entries.
    pub fn joints(&self) -> impl Iterator<Item = &str> + Clone {
        self.mechanism().joints().map(|(_, body)| body.joint_name())
    }

    /// Names of the bodies: one per joint, except for joints that carry several.
    pub fn bodies(&self) -> impl Iterator<Item = &str> + Clone {
        self.mechanism().bodies().iter().map(Body::name)
    }

    /// Names of the frames beside those of the bodies.
    pub fn frames(&self) -> impl Iterator<Item = &str> + Clone {
        self.mechanism().frames().iter().map(|frame| &*frame.name)
    }

    /// The body on the joint of that name, or the body of that name: its joint, and the ranges of its entries ([`Body::ranges`]).
    ///
    /// # Errors
    /// A name that the model does not have.
    pub fn joint(&self, name: &str) -> Result<&Body, UnknownName> {
        Ok(&self.mechanism().bodies()[self.joint_index(name)?])
    }

    pub(crate) fn joint_index(&self, name: &str) -> Result<usize, UnknownName> {
        let mut joints = self.mechanism().joints();
        let found = joints.find(|(_, body)| body.joint_name() == name);
        let found = found.map(|(index, _)| index);
        let found = found.or_else(|| self.mechanism().body_index(name));
        found.ok_or_else(|| {
            UnknownName::new("joint or body", name, self.joints().chain(self.bodies()))
        })
    }

    /// The initial state of the file; a robot is at home and at rest.
    pub fn state(&self) -> State {
        self.scene.start()
    }

    /// Puts a joint where local coordinates `phi` lead from home, Φ(home, ϕ): the angle of a revolute joint, the displacement of a prismatic one, a
    /// rotation vector of a ball, in rad and m.
    ///
    /// # Errors
    /// An unknown joint; not one number per local coordinate; numbers that are not finite.
    pub fn set_position(&self, state: &mut State, joint: &str, phi: &[f64]) -> Result<(), Error> {
        let index = self.joint_index(joint)?;
        let mechanism = self.mechanism();
        let moved = mechanism.configuration_from_local(index, phi)?;
        mechanism.check_room("configuration", Space::Configuration, &state.configuration)?;
        let own = mechanism.bodies()[index].ranges().configuration.clone();
        state.configuration[own].copy_from_slice(&moved);
        Ok(())
    }

    /// Gives a joint its speeds v̄, rad/s and m/s.
    ///
    /// # Errors
    /// An unknown joint; not one number per speed; numbers that are not finite.
    pub fn set_speeds(&self, state: &mut State, joint: &str, speeds: &[f64]) -> Result<(), Error> {
        let body = self.joint(joint)?;
        let own = body.ranges().speeds.clone();
        check_size(body.joint_name(), "speeds", own.len(), speeds.len())?;
        self.mechanism()
            .check_room("speeds", Space::Speeds, &state.speeds)?;
        let mut moved = state.speeds.clone();
        moved[own].copy_from_slice(speeds);
        self.mechanism().check_speeds("speeds", &moved)?;
        state.speeds = moved;
        Ok(())
    }

    /// v̄̇ under the efforts τ, (24), (34): rad/s² and m/s².
    ///
    /// # Errors
    /// A singular mass matrix; a wrong size; numbers that are not finite.
    pub fn forward_dynamics(
        &mut self,
        state: &State,
        efforts: &[f64],
    ) -> Result<DVector<f64>, Error> {
        let mut rates = self.of_speeds();
        let (q, speeds) = (&*state.configuration, &*state.speeds);
        self.dynamics
            .forward_dynamics(q, speeds, efforts, rates.as_mut_slice())?;
        Ok(rates)
    }

    /// The efforts `S̄ᵀτ` (one per speed) that inputs must exert for v̄̇ = `accelerations`.
    ///
    /// # Errors
    /// A wrong size; numbers that are not finite.
    pub fn inverse_dynamics(
        &mut self,
        state: &State,
        accelerations: &[f64],
    ) -> Result<DVector<f64>, Error> {
        let mut efforts = self.of_speeds();
        let (q, speeds) = (&*state.configuration, &*state.speeds);
        self.dynamics
            .inverse_dynamics(q, speeds, accelerations, efforts.as_mut_slice())?;
        Ok(efforts)
    }

    /// M̄(Q), one row and one column per speed.
    ///
    /// # Errors
    /// A wrong size; numbers that are not finite.
    pub fn mass_matrix(&mut self, state: &State) -> Result<DMatrix<f64>, Error> {
        self.dynamics
            .mass_matrix(&state.configuration, &mut self.mass)?;
        Ok(self.mass.matrix())
    }

    /// Inverse dynamics at v̄̇ = 0: Coriolis and centrifugal forces, gravity, springs and dampers; one entry per speed.
    ///
    /// # Errors
    /// A wrong size; numbers that are not finite.
    pub fn bias_forces(&mut self, state: &State) -> Result<DVector<f64>, Error> {
        let mut bias = self.of_speeds();
        let (q, speeds) = (&*state.configuration, &*state.speeds);
        self.dynamics.bias_forces(q, speeds, bias.as_mut_slice())?;
        Ok(bias)
    }

    /// The 6×S matrix (S speeds) that takes v̄ to the twist of a frame or a body: angular velocity in the first three rows, velocity of the frame's origin in the
    /// last three, in **world axes** ([`Frame::WorldAligned`]); one column per speed.
    ///
    /// # Errors
    /// An unknown frame; a wrong size; numbers that are not finite.
    pub fn jacobian(&mut self, state: &State, frame: &str) -> Result<DMatrix<f64>, Error> {
        self.jacobian_in(state, frame, Frame::WorldAligned)
    }

    /// As [`Model::jacobian`], with twists read at the origin and in the axes that `axes` says.
    ///
    /// # Errors
    /// Those of [`Model::jacobian`].
    pub fn jacobian_in(
        &mut self,
        state: &State,
        frame: &str,
        axes: Frame,
    ) -> Result<DMatrix<f64>, Error> {
        let mut jacobian = DMatrix::zeros(6, self.sizes().speeds);
        let read = |at: FrameReadings<'_>| at.jacobian(axes, jacobian.as_mut_slice());
        self.at_frame(state, frame, read)??;
        Ok(jacobian)
    }

    /// Where a frame or a body is: its coordinates to world coordinates.
    ///
    /// # Errors
    /// Those of [`Model::jacobian`].
    pub fn pose(&mut self, state: &State, frame: &str) -> Result<Pose<f64>, Error> {
        self.at_frame(state, frame, |at| at.pose())
    }

    /// The twist of a frame or a body relative to the world, as [`Model::jacobian`] has it: `J v̄`.
    ///
    /// # Errors
    /// Those of [`Model::jacobian`].
    pub fn twist(&mut self, state: &State, frame: &str) -> Result<Vector6<f64>, Error> {
        self.at_frame(state, frame, |at| at.twist(Frame::WorldAligned))
    }

    fn at_frame<R>(
        &mut self,
        state: &State,
        frame: &str,
        read: impl FnOnce(FrameReadings<'_>) -> R,
    ) -> Result<R, Error> {
        let mechanism = Arc::clone(self.mechanism());
        let (named, body) = (mechanism.frame_index(frame), mechanism.body_index(frame));
        let readings = self
            .dynamics
            .readings(&state.configuration, &state.speeds)?;
        let at = match (named, body) {
            (Some(index), _) => readings.frame(index)?,
            (None, Some(body)) => readings.body_frame(body)?,
            (None, None) => {
                let known = self.frames().chain(self.bodies());
                return Err(UnknownName::new("frame or body", frame, known).into());
            }
        };
        Ok(read(at))
    }

    /// Kinetic and potential energy, J; that of gravity is zero at the world's origin.
    ///
    /// # Errors
    /// A wrong size; numbers that are not finite.
    pub fn energy(&self, state: &State) -> Result<f64, Error> {
        let (q, speeds) = (&*state.configuration, &*state.speeds);
        Ok(self.mechanism().kinematics(q, speeds)?.energy())
    }

    /// The centre of mass of all bodies, world axes, m.
    ///
    /// # Errors
    /// A wrong size; numbers that are not finite.
    pub fn center_of_mass(&mut self, state: &State) -> Result<Vector3<f64>, Error> {
        let (q, speeds) = (&*state.configuration, &*state.speeds);
        Ok(self.dynamics.readings(q, speeds)?.center_of_mass())
    }

    /// A motion from the model's initial state, under its controller, with its settings, until said otherwise.
    pub fn simulate(&self) -> Simulation<'_> {
        Simulation::new(&self.scene)
    }

    fn of_speeds(&self) -> DVector<f64> {
        DVector::zeros(self.sizes().speeds)
    }
}
