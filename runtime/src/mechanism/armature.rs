//! Inertias of rotors, which joints feel beside the bodies that they carry: at degrees of freedom, and at ports.

use super::rotor::speed_of_rotor;
use super::{Body, Mechanism, MechanismError};
use crate::elements::{self, ElementError};
use alloc::format;
use alloc::vec;
use alloc::vec::Vec;

/// The inertias of all rotors; empty where there are none.
#[derive(Clone, Debug, Default)]
pub(super) struct Armature {
    /// One entry a degree of freedom.
    freedoms: Vec<f64>,
    /// The same with one entry a speed, the rate of the rotors.
    speeds: Vec<f64>,
    /// One entry a port, for each body.
    ports: Vec<Vec<f64>>,
}

impl Mechanism {
    /// The mechanism with `inertia` (kg m² or kg, one entry per degree of freedom) added to that which the joint under `body` feels: a rotor behind a
    /// gear. Kinetic energy grows by `½ Σ a v²`, and with γ ≠ 0 the equations by `Σ_k γ_k v_k (a v)`, as (16) has it.
    ///
    /// # Errors
    /// No such body; a wrong size; a negative inertia; at a nonholonomic joint, a degree of freedom whose rate is not one of the speeds at every
    /// configuration, [`speed_of_rotor`].
    pub fn with_armature(mut self, body: usize, inertia: &[f64]) -> Result<Self, MechanismError> {
        let (owner, element) = self.owner("armature", body)?;
        let ranges = owner.ranges.clone();
        elements::values(&element, "inertia", inertia, ranges.freedoms.len(), false)
            .map_err(MechanismError::Element)?;
        let is_holonomic = owner.joint().structures().speed_basis.is_identity();
        let speed = |k: usize| match is_holonomic {
            true => Some(k),
            false => speed_of_rotor(owner.joint(), k),
        };
        let mut felt = vec![0.0; ranges.speeds.len()];
        let mut rotors = inertia.iter().enumerate().filter(|(_, a)| **a > 0.0);
        let is_felt_alike = rotors.all(|(k, a)| {
            let entry = speed(k).and_then(|speed| felt.get_mut(speed));
            entry.map(|entry| *entry += a).is_some()
        });
        if !is_felt_alike {
            return Err(MechanismError::Element(ElementError::Joint {
                element,
                joint: owner.joint_name().into(),
                reason: "is nonholonomic: an armature goes with degrees of freedom whose rate is one of the speeds, or with a port",
            }));
        }
        let armature = &mut self.actuation.armature;
        if armature.freedoms.is_empty() {
            armature.freedoms = vec![0.0; self.layout.freedoms];
            armature.speeds = vec![0.0; self.layout.speeds];
        }
        armature.speeds[ranges.speeds].copy_from_slice(&felt);
        armature.freedoms[ranges.freedoms].copy_from_slice(inertia);
        Ok(self)
    }

    /// The mechanism with `inertia` (kg m² or kg, one entry a port) added to that which the joint under `body` feels: rotors that turn with its ports.
    /// Kinetic energy grows by `½ Σ a w²` with w = P v, and the equations by `Pᵀ a ẇ`.
    ///
    /// # Errors
    /// No such body; a wrong size; a negative inertia.
    pub fn with_port_armature(
        mut self,
        body: usize,
        inertia: &[f64],
    ) -> Result<Self, MechanismError> {
        let (owner, element) = self.owner("armature at ports", body)?;
        let ports = owner.joint().ports().len();
        elements::values(&element, "inertia", inertia, ports, false)
            .map_err(MechanismError::Element)?;
        let (leader, count) = (self.leader(body), self.bodies.len());
        let armature = &mut self.actuation.armature.ports;
        armature.resize(count, Vec::new());
        armature[leader] = inertia.to_vec();
        Ok(self)
    }

    /// A body, and what messages call `what` of its joint.
    fn owner(
        &self,
        what: &str,
        body: usize,
    ) -> Result<(&Body, alloc::string::String), MechanismError> {
        match self.bodies.get(body) {
            Some(owner) => Ok((owner, format!("{what} of joint `{}`", owner.joint_name()))),
            None => Err(MechanismError::Element(ElementError::UnknownBody {
                element: format!("{what} of body {body}"),
                index: body,
                count: self.bodies.len(),
            })),
        }
    }

    /// Rotor inertias of the joint that `body` stands for, one entry per degree of freedom; empty where it has none, for further bodies of a joint, and
    /// where there is no such body.
    pub fn armature(&self, body: usize) -> &[f64] {
        let leader = self.bodies.get(body).filter(|own| own.leads());
        let freedoms = leader.map(|own| own.ranges.freedoms.clone());
        let own = freedoms.and_then(|freedoms| self.actuation.armature.freedoms.get(freedoms));
        felt(own)
    }

    /// The same for each speed, with which rotors turn; empty where there are none.
    pub fn speed_armature(&self, body: usize) -> &[f64] {
        let speeds = self.bodies.get(body).map(|own| own.ranges.speeds.clone());
        let own = speeds.and_then(|speeds| self.actuation.armature.speeds.get(speeds));
        own.filter(|_| !self.armature(body).is_empty())
            .unwrap_or(&[])
    }

    /// Inertias of rotors at the ports of the joint that `body` stands for, one entry a port; empty where it has none, for further bodies of a joint, and
    /// where there is no such body.
    pub fn port_armature(&self, body: usize) -> &[f64] {
        felt(self.actuation.armature.ports.get(body).map(Vec::as_slice))
    }
}

/// Inertias, if any of them is felt.
fn felt(inertias: Option<&[f64]>) -> &[f64] {
    let felt = inertias.filter(|own| own.iter().any(|inertia| *inertia != 0.0));
    felt.unwrap_or(&[])
}
