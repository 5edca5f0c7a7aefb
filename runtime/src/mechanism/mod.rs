//! A tree of rigid bodies on joints: immutable, shared between threads, free of state.
//!
//! State lives with the caller, as slices: a configuration `q` (all joints' Q, one after the other), and speeds v̄ or
//! momenta p̄. [`Body::ranges`] tells where a joint's share lies.

mod actuation;
mod armature;
mod body;
mod build;
mod check;
mod error;
mod frame;
mod initial;
mod inverse_kinematics;
mod kinematics;
mod port;
mod regressor;
mod rigid;
mod rotor;
mod several;
mod unilateral;

pub use actuation::dependent_columns;
pub use body::{Body, BodySpec, Ranges};
pub use check::CONFIGURATION_TOLERANCE;
pub use check::{Space, WHOLE, check_size};
pub use error::{Loci, MechanismError, MechanismErrors, StateError};
pub use frame::{FrameFault, NamedFrame};
pub use initial::CONSTRAINT_TOLERANCE;
pub use inverse_kinematics::REACH_TOLERANCE;
pub use kinematics::{BodyState, Kinematics};
pub use regressor::EnergyRegressor;
pub use rigid::{RigidBody, check_bodies};
pub use rotor::speed_of_rotor;
pub use several::SeveralFault;

use crate::erased::Layout;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

/// A tree of bodies, its joints and gravity.
#[derive(Clone, Debug)]
pub struct Mechanism {
    gravity: Vector3<f64>,
    bodies: Vec<Body>,
    layout: Layout,
    actuation: actuation::Actuation,
    frames: Vec<NamedFrame>,
}

impl Mechanism {
    /// A mechanism in uniform gravity (world axes, m/s²), from its bodies, parents first.
    ///
    /// # Errors
    /// Everything that is wrong with the bodies, all at once.
    pub fn new(gravity: Vector3<f64>, bodies: Vec<BodySpec>) -> Result<Self, MechanismErrors> {
        MechanismErrors::check(build::check(&gravity, &bodies))?;
        let (bodies, layout) = build::assemble(bodies);
        Ok(Self {
            gravity,
            bodies,
            layout,
            actuation: actuation::Actuation::default(),
            frames: Vec::new(),
        })
    }

    /// Acceleration of free fall, world axes, m/s².
    pub const fn gravity(&self) -> &Vector3<f64> {
        &self.gravity
    }

    /// The bodies, parents before children.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// The body of that index.
    ///
    /// # Errors
    /// When there is none.
    pub fn body(&self, index: usize) -> Result<&Body, StateError> {
        self.bodies.get(index).ok_or(StateError::UnknownBody {
            index,
            count: self.bodies.len(),
        })
    }

    /// Index of the body called `name`.
    pub fn body_index(&self, name: &str) -> Option<usize> {
        self.bodies.iter().position(|body| body.name() == name)
    }

    /// Sizes of q; of v, p and τ; of v̄ and p̄; of λ.
    pub const fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The configuration with every joint at home.
    pub fn home(&self) -> Vec<f64> {
        let mut q = vec![0.0; self.layout.configuration];
        for (_, body) in self.joints() {
            body.joint().home(&mut q[body.ranges.configuration.clone()]);
        }
        q
    }
}
