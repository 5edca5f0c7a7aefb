//! Where the bodies of a mechanism are, how they move, and what that amounts to.

use super::check::Space;
use super::{Body, Mechanism, StateError};
use crate::elements::{MotionList, View};
use crate::erased::AnyJoint;
use crate::spatial::{Pose, SpatialInertia, join, split};
use crate::steps::Placement;
use alloc::vec::Vec;
use nalgebra::{DMatrixView, DVectorView, DVectorViewMut, MatrixView6xX, Vector3, Vector6};

/// Position and velocity of one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState {
    /// The body frame in the world.
    pub pose: Pose<f64>,
    /// Twist relative to the world, in body axes, linear part of the point at the body's origin.
    pub twist: Vector6<f64>,
    /// Centre of mass, world axes, m.
    pub position_com: Vector3<f64>,
    /// Velocity of the centre of mass, world axes, m/s.
    pub velocity_com: Vector3<f64>,
    /// Kinetic energy, J.
    pub kinetic_energy: f64,
    /// Potential energy in gravity, zero at the world's origin, J.
    pub potential_energy: f64,
    /// Momentum about the world's origin, world axes: (angular, kg m²/s; linear, kg m/s).
    pub momentum: Vector6<f64>,
}

impl BodyState {
    /// Angular velocity in body axes, `vee(Rᵀ Ṙ)`, rad/s.
    pub fn angular_velocity_body(&self) -> Vector3<f64> {
        split(&self.twist).0
    }

    /// Angular velocity in world axes, rad/s.
    pub fn angular_velocity_world(&self) -> Vector3<f64> {
        self.pose.rotation * self.angular_velocity_body()
    }

    fn new(body: &Body, gravity: &Vector3<f64>, pose: Pose<f64>, twist: Vector6<f64>) -> Self {
        let mass = body.mass();
        let (angular, linear) = split(&twist);
        let momentum = SpatialInertia::from(mass).apply(&twist);
        let position_com = pose.transform_point(&mass.com);
        Self {
            pose,
            twist,
            position_com,
            velocity_com: pose.rotation * (linear + angular.cross(&mass.com)),
            kinetic_energy: 0.5 * twist.dot(&momentum),
            potential_energy: -mass.mass * gravity.dot(&position_com),
            momentum: pose.act_wrench(&momentum),
        }
    }
}

/// The joint-child frames behind the states of bodies, as elements see them.
fn joint_frames(bodies: &[Body], states: &[BodyState]) -> MotionList {
    let frames = bodies.iter().zip(states).map(|(body, state)| {
        let pose = state.pose.compose(&body.child_placement().inverse());
        let placement = Placement {
            rotation: pose.rotation,
            origin: pose.translation,
            // Elements see no parents.
            offset: Vector3::zeros(),
        };
        let twist = body.child_placement().act_twist(&state.twist);
        let (angular, linear) = split(&twist);
        let turned = join(&(pose.rotation * angular), &(pose.rotation * linear));
        (placement, turned)
    });
    MotionList(frames.collect())
}

/// All bodies at one state of a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Kinematics {
    /// In the order of [`Mechanism::bodies`].
    pub bodies: Vec<BodyState>,
    /// Total mass, kg.
    pub mass: f64,
    /// Centre of mass of all bodies, world axes, m; the origin when nothing has mass.
    pub center_of_mass: Vector3<f64>,
    /// Energy stored in springs and other elements, J.
    pub element_energy: f64,
    /// Kinetic energy of rotors, `½ Σ a v²` and at ports `½ Σ a w²`, J.
    pub rotor_energy: f64,
}

impl Kinematics {
    /// Kinetic energy of bodies and rotors, J.
    pub fn kinetic_energy(&self) -> f64 {
        let bodies = self.bodies.iter().map(|body| body.kinetic_energy);
        bodies.sum::<f64>() + self.rotor_energy
    }

    /// Potential energy in gravity, zero at the world's origin, and in elements, J.
    pub fn potential_energy(&self) -> f64 {
        let bodies = self.bodies.iter().map(|body| body.potential_energy);
        bodies.sum::<f64>() + self.element_energy
    }

    /// Kinetic and potential energy, J.
    pub fn energy(&self) -> f64 {
        self.kinetic_energy() + self.potential_energy()
    }

    /// Momentum about the world's origin, world axes: (angular; linear).
    pub fn momentum(&self) -> Vector6<f64> {
        self.bodies.iter().map(|body| body.momentum).sum()
    }

    /// Momentum about the centre of mass of all bodies, world axes: (angular; linear).
    pub fn momentum_com(&self) -> Vector6<f64> {
        Pose::from_translation(self.center_of_mass).act_wrench_inverse(&self.momentum())
    }
}

impl Mechanism {
    /// Pose and twist of every body, with energies and momenta.
    ///
    /// # Errors
    /// When a vector has the wrong size, or is not finite.
    pub fn kinematics(&self, q: &[f64], speeds: &[f64]) -> Result<Kinematics, StateError> {
        self.check_vector("configuration", Space::Configuration, q)?;
        self.check_vector("speeds", Space::Speeds, speeds)?;
        let bodies = self.body_states(q, speeds);
        let mass: f64 = self.bodies.iter().map(|body| body.mass().mass).sum();
        let moment: Vector3<f64> = bodies
            .iter()
            .zip(&self.bodies)
            .map(|(state, body)| state.position_com * body.mass().mass)
            .sum();
        let center_of_mass = if mass > 0.0 { moment / mass } else { moment };
        Ok(Kinematics {
            mass,
            center_of_mass,
            element_energy: self.element_energy(q, speeds, &bodies),
            rotor_energy: self.rotor_energy(q, speeds),
            bodies,
        })
    }

    /// Whether the energy at (q, v̄) is finite: squares of speeds are beyond the range of numbers where speeds are far within it.
    ///
    /// # Errors
    /// When it is not, with the joint that has no value or the body whose energy it is; those of [`Mechanism::kinematics`].
    pub fn check_energy(&self, q: &[f64], speeds: &[f64]) -> Result<(), StateError> {
        match self.kinematics(q, speeds)?.energy().is_finite() {
            true => Ok(()),
            false => Err(self.infinite_energy((q, speeds))),
        }
    }

    /// Why the energy at (q, v̄) is not finite: a kernel of a joint, or else where the energy of a body is not.
    pub fn infinite_energy(&self, (q, speeds): (&[f64], &[f64])) -> StateError {
        let of_kernel = self.no_value(q, speeds);
        of_kernel.unwrap_or_else(|| {
            let states = self.body_states(q, speeds);
            let is_finite = |state: &BodyState| {
                state.kinetic_energy.is_finite() && state.potential_energy.is_finite()
            };
            let place = states.iter().position(|state| !is_finite(state));
            let body = place.and_then(|place| self.bodies.get(place));
            StateError::Energy {
                of: body.map(|body| body.name().into()),
            }
        })
    }

    fn rotor_energy(&self, q: &[f64], speeds: &[f64]) -> f64 {
        let joints = self.joints().map(|(index, body)| {
            let own = &speeds[body.ranges.speeds.clone()];
            let terms = self.speed_armature(index).iter().zip(own);
            let at_speeds: f64 = terms.map(|(a, v)| 0.5 * a * v * v).sum();
            at_speeds + body.port_rotor_energy(self.port_armature(index), q, own)
        });
        joints.sum()
    }

    fn element_energy(&self, q: &[f64], speeds: &[f64], bodies: &[BodyState]) -> f64 {
        let motions = joint_frames(&self.bodies, bodies);
        let view = View::new(self, q, speeds, &motions);
        let elements = self.elements().iter();
        elements.map(|element| element.energy(&view)).sum()
    }

    fn body_states(&self, q: &[f64], speeds: &[f64]) -> Vec<BodyState> {
        let mut states: Vec<BodyState> = Vec::with_capacity(self.bodies.len());
        let mut scratch = Scratch::default();
        for body in &self.bodies {
            let (own, relative) = body.relative_motion(q, speeds, &mut scratch);
            let (pose, twist) = match body.parent().map(|parent| &states[parent]) {
                Some(parent) => (
                    parent.pose.compose(&own),
                    own.act_twist_inverse(&parent.twist) + relative,
                ),
                None => (own, relative),
            };
            states.push(BodyState::new(body, &self.gravity, pose, twist));
        }
        states
    }
}

impl Body {
    fn port_rotor_energy(&self, inertias: &[f64], q: &[f64], speeds: &[f64]) -> f64 {
        if inertias.is_empty() {
            return 0.0;
        }
        let q = self.configuration(q);
        let rates = self.port_map(q)
            * (self.speed_basis(q) * DVectorView::from_slice(speeds, speeds.len()));
        let terms = inertias.iter().zip(&rates);
        terms.map(|(a, w)| 0.5 * a * w * w).sum()
    }

    /// Pose of the body frame in the parent's body frame, and twist relative to the parent in body axes.
    fn relative_motion(
        &self,
        q: &[f64],
        speeds: &[f64],
        scratch: &mut Scratch,
    ) -> (Pose<f64>, Vector6<f64>) {
        let q = self.configuration(q);
        let own = &speeds[self.ranges.speeds.clone()];
        let twist = scratch.twist(self.joint(), q, own);
        let pose = *self.placement() * self.joint().pose(q) * *self.child_placement();
        (pose, self.child_placement().act_twist_inverse(&twist))
    }
}

/// Room for S̄, X^c and v of one joint after another.
#[derive(Default)]
struct Scratch {
    speed_basis: Vec<f64>,
    twist_map: Vec<f64>,
    velocity: Vec<f64>,
}

impl Scratch {
    /// X^c S̄ v̄ at a joint's Q.
    fn twist(&mut self, joint: &dyn AnyJoint, q: &[f64], speeds: &[f64]) -> Vector6<f64> {
        let (freedoms, count) = (joint.layout().freedoms, speeds.len());
        let basis = zeros(&mut self.speed_basis, freedoms * count);
        joint.speed_basis(q, basis);
        let basis = DMatrixView::from_slice(basis, freedoms, count);
        let map = zeros(&mut self.twist_map, 6 * freedoms);
        joint.twist_map_child(q, map);
        let map = MatrixView6xX::from_slice(map, freedoms);
        let velocity = zeros(&mut self.velocity, freedoms);
        let mut velocity = DVectorViewMut::from_slice(velocity, freedoms);
        velocity.gemv(1.0, &basis, &DVectorView::from_slice(speeds, count), 0.0);
        let mut twist = Vector6::zeros();
        twist.gemv(1.0, &map, &velocity, 0.0);
        twist
    }
}

/// So many zeros.
fn zeros(room: &mut Vec<f64>, count: usize) -> &mut [f64] {
    room.clear();
    room.resize(count, 0.0);
    room
}
