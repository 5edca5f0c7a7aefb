//! Model-based control: laws that turn the state of a mechanism into efforts, made from its own equations.
//!
//! | law | what it does | what it takes of the model |
//! |---|---|---|
//! | [`ComputedTorque`] | moves holonomic joints along a [`Reference`] | inverse dynamics |
//! | [`Regulator`] | holds an equilibrium, optimally to first order (LQR) | derivatives of forward dynamics |
//! | [`EnergyShaping`] | gives the mechanism another energy, and drains or feeds it | its ports: y = ∂H/∂p against u = τ |
//! | [`PathFollower`] | leads a rolling joint along a [`Curve`] | forward dynamics, for the speeds that it commands |
//! | `PredictiveRegulator` (feature `predictive`) | holds an equilibrium with inputs within limits | the linearised step of an integrator |
//!
//! Deviations are read by each joint's own inverse Φ ([`AnyJoint::local`](hamel_runtime::erased::AnyJoint::local)), so that no angle wraps and no
//! attitude is singular. A law is handed to [`integrate`](hamel_integrate::integrate), or to
//! [`integrate_held`](hamel_integrate::integrate_held) as a digital controller, by [`Feedback`]. After construction nothing allocates, except for
//! `PredictiveRegulator`, whose optimiser does.
#![forbid(unsafe_code)]
#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

mod computed_torque;
mod energy;
mod error;
mod feedback;
mod held;
mod path;
mod port_reference;
#[cfg(feature = "predictive")]
mod predictive;
mod reference;
mod regulator;
pub mod riccati;
mod scales;
mod stabilizability;
mod state;

pub use computed_torque::{ComputedTorque, ErrorDynamics};
pub use energy::{EnergyShaping, Port, PortSpring, Pump};
pub use error::ControlError;
pub use feedback::Feedback;
pub use path::{Curve, PathFollower, PathGains};
pub use port_reference::PortReference;
#[cfg(feature = "predictive")]
pub use predictive::PredictiveRegulator;
pub use reference::Reference;
pub use regulator::{Equilibrium, Regulator, Weights};
pub use stabilizability::Motion;

use alloc::vec::Vec;
use core::fmt::Debug;
use hamel_runtime::dynamics::EffortAtPort;

/// A quantity by which a controller says how well it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Measure {
    /// What it is called, in words.
    pub name: &'static str,
    /// Its unit; of joints that turn and joints that slide together, both.
    pub unit: &'static str,
}

/// A law from time, Q and v̄ to efforts τ.
pub trait Controller: Debug {
    /// τ into `efforts` (one entry per degree of freedom, collocated with v) at `time` (s), `q` and v̄.
    ///
    /// # Errors
    /// A wrong size; a local coordinate that cannot be found; equations of motion or an optimisation that cannot be solved.
    fn efforts(
        &mut self,
        time: f64,
        q: &[f64],
        speeds: &[f64],
        efforts: &mut [f64],
    ) -> Result<(), ControlError>;

    /// Functions of time, Q and v̄ at whose zeros τ bends, pushed onto `bends`: as many at all times, each continuous and of the order of 1 away from its zero, as
    /// `1 − |u|/limit` is. An integration ends its steps there ([`Integration::bending`](hamel_integrate::Integration::bending)).
    ///
    /// # Errors
    /// As those of [`Controller::efforts`].
    fn bends(
        &mut self,
        _time: f64,
        _q: &[f64],
        _speeds: &[f64],
        _bends: &mut Vec<f64>,
    ) -> Result<(), ControlError> {
        Ok(())
    }

    /// What of τ acts at ports of joints, pushed onto `efforts`: what a joint's pins and relations carry depends on it ([`Integration::inputs_at_ports`](hamel_integrate::Integration::inputs_at_ports)).
    ///
    /// # Errors
    /// As those of [`Controller::efforts`].
    fn efforts_at_ports(
        &mut self,
        _time: f64,
        _q: &[f64],
        _speeds: &[f64],
        _efforts: &mut Vec<EffortAtPort>,
    ) -> Result<(), ControlError> {
        Ok(())
    }

    /// What [`Controller::measure`] gives.
    fn measures(&self) -> &'static [Measure];

    /// How far the mechanism is from what the law wants of it, into `values`: one number for each of [`Controller::measures`].
    ///
    /// # Errors
    /// As those of [`Controller::efforts`].
    fn measure(
        &mut self,
        time: f64,
        q: &[f64],
        speeds: &[f64],
        values: &mut [f64],
    ) -> Result<(), ControlError>;
}

/// The measures of laws that hold or follow a configuration: the largest deviations of any degree of freedom and of any speed.
pub(crate) const DEVIATIONS: &[Measure] = &[
    Measure {
        name: "position error",
        unit: "rad or m",
    },
    Measure {
        name: "speed error",
        unit: "rad/s or m/s",
    },
];
