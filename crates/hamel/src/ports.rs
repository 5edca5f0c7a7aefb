//! What is reported of a joint beside its own coordinates: its ports, the forces that hold its relations, and those at its pins.

use crate::{Error, Model, UnknownName};
use hamel_integrate::State;
use hamel_runtime::dynamics::PinForce;

/// A port at one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PortReading {
    /// rad or m; an angle up to whole turns is between −π and π.
    pub value: f64,
    /// rad/s or m/s.
    pub rate: f64,
}

impl Model {
    /// The value and the rate of a port of a joint.
    ///
    /// # Errors
    /// An unknown joint or port; a wrong size; numbers that are not finite; a configuration off the joint's manifold.
    pub fn port(&self, state: &State, joint: &str, port: &str) -> Result<PortReading, Error> {
        let index = self.joint_index(joint)?;
        let (mechanism, body) = (self.mechanism(), self.joint(joint)?);
        let place = mechanism.port_index(index, port).ok_or_else(|| {
            let known = body.joint().ports().iter().map(|port| port.name);
            UnknownName::new("port", port, known)
        })?;
        let (q, speeds) = (&*state.configuration, &*state.speeds);
        let rates = mechanism.port_rates(index, q, speeds)?;
        let values = mechanism.port_values(index, body.configuration(q))?;
        Ok(PortReading {
            value: values[place],
            rate: rates[place],
        })
    }

    /// The multipliers of the relations by which a joint closes its loops, where it accelerates with v̄̇ = `accelerations`: the forces that hold them, in N for
    /// relations in m and N·m for relations between numbers, in the order of the joint's spec. Empty for other joints. Constraints that couple joints
    /// exert nothing here.
    ///
    /// # Errors
    /// An unknown joint; a wrong size; numbers that are not finite.
    pub fn relation_forces(
        &mut self,
        state: &State,
        accelerations: &[f64],
        joint: &str,
    ) -> Result<Vec<f64>, Error> {
        let index = self.joint_index(joint)?;
        self.inverse_dynamics(state, accelerations)?;
        let (q, speeds) = (&*state.configuration, &*state.speeds);
        Ok(self.dynamics_mut().relation_forces(index, q, speeds)?)
    }

    /// What bodies of a joint exert on each other at its pins, where it accelerates with v̄̇ = `accelerations`: each with the name of its pin, in the order of the
    /// joint's spec. Empty for joints without pins. A component that the equations of motion do not determine is NaN. Constraints that couple joints
    /// exert nothing here.
    ///
    /// # Errors
    /// An unknown joint; a wrong size; numbers that are not finite; an effort that is the rate of no pin; pins that do not hold the bodies.
    pub fn pin_forces(
        &mut self,
        state: &State,
        accelerations: &[f64],
        joint: &str,
    ) -> Result<Vec<(&'static str, PinForce)>, Error> {
        let index = self.joint_index(joint)?;
        self.inverse_dynamics(state, accelerations)?;
        let (q, speeds) = (&*state.configuration, &*state.speeds);
        let pins = self.joint(joint)?.joint().pins().iter();
        let forces = self.dynamics_mut().pin_forces(index, q, speeds)?;
        Ok(pins.map(|pin| pin.name).zip(forces).collect())
    }
}
