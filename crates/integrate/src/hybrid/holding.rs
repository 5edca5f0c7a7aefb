//! The efforts that hold joints where they are.

use super::contact::Contact;
use crate::StepFailure;
use crate::flow::Flow;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::{Dynamics, DynamicsError, Recursive};
use hamel_runtime::mechanism::Mechanism;

/// Reads them by inverse dynamics, in O(n) where no constraint couples joints.
pub(super) struct Holding {
    dynamics: Recursive,
    /// τ, with the accelerations of driven joints in `driven`.
    tau: Vec<f64>,
    driven: Vec<f64>,
    rates: Vec<f64>,
    /// What each speed needs beside τ, the elements and the constraints.
    missing: Vec<f64>,
    coupling: Option<Coupling>,
}

/// Where constraints couple joints.
struct Coupling {
    forces: Vec<f64>,
    /// What the joints carry without and with them.
    alone: Vec<f64>,
    coupled: Vec<f64>,
}

impl Holding {
    /// For the mechanism whose held joints are driven.
    pub(super) fn new(mechanism: Arc<Mechanism>) -> Self {
        let layout = *mechanism.layout();
        let constraints = mechanism.constraints().len();
        let coupling = (constraints > 0).then(|| Coupling {
            forces: vec![0.0; constraints],
            alone: vec![0.0; layout.freedoms],
            coupled: vec![0.0; layout.freedoms],
        });
        Self {
            tau: vec![0.0; layout.freedoms],
            driven: vec![0.0; layout.freedoms],
            rates: vec![0.0; layout.speeds],
            missing: vec![0.0; layout.speeds],
            coupling,
            dynamics: Recursive::new(mechanism),
        }
    }

    /// Those at a time, `q` and v̄, of the mechanism as it is in this piece.
    pub(super) fn at(
        flow: &mut Flow<'_>,
        (time, q, speeds): (f64, &[f64], &[f64]),
    ) -> Result<Self, StepFailure> {
        let mut holding = Self::new(Arc::clone(&flow.mechanism));
        holding.find(flow, (time, q, speeds))?;
        Ok(holding)
    }

    /// Finds them for a time, `q` and v̄.
    pub(super) fn find(
        &mut self,
        flow: &mut Flow<'_>,
        (time, q, speeds): (f64, &[f64], &[f64]),
    ) -> Result<(), StepFailure> {
        flow.given_efforts(time, q, speeds, &mut self.tau);
        self.driven.copy_from_slice(&self.tau);
        let mechanism = Arc::clone(self.dynamics.mechanism());
        mechanism.prescribe_accelerations(flow.moment(time), &mut self.driven);
        let dynamics = &mut self.dynamics;
        dynamics.set_moment(flow.moment(time));
        dynamics.forward_dynamics(q, speeds, &self.driven, &mut self.rates)?;
        dynamics
            .inverse_dynamics(q, speeds, &self.rates, &mut self.missing)
            .map_err(StepFailure::State)?;
        self.couple(q, speeds)?;
        for (_, body) in mechanism.joints() {
            let ranges = body.ranges();
            // Only joints with one coordinate are held, and only theirs are read.
            if let [tau] = self.tau[ranges.freedoms.clone()] {
                self.missing[ranges.speeds.start] -= tau;
            }
        }
        Ok(())
    }

    /// Takes what constraints do off what is missing.
    fn couple(&mut self, q: &[f64], speeds: &[f64]) -> Result<(), DynamicsError> {
        let Some(coupling) = &mut self.coupling else {
            return Ok(());
        };
        let dynamics = &mut self.dynamics;
        dynamics.joint_efforts(q, &mut coupling.alone)?;
        dynamics.coupling_force(q, speeds, &self.rates, &self.driven, &mut coupling.forces)?;
        dynamics.joint_efforts(q, &mut coupling.coupled)?;
        for (_, body) in dynamics.mechanism().joints() {
            let ranges = body.ranges();
            if ranges.freedoms.len() == 1 && ranges.speeds.len() == 1 {
                let own = ranges.freedoms.start;
                self.missing[ranges.speeds.start] += coupling.coupled[own] - coupling.alone[own];
            }
        }
        Ok(())
    }

    /// That of one joint, as last found; it is positive where it pushes towards larger coordinates.
    pub(super) fn effort(&self, contact: &Contact) -> f64 {
        self.missing[contact.speed]
    }

    /// Those of all joints by their speeds, as last found.
    pub(super) fn efforts(&self) -> &[f64] {
        &self.missing
    }
}
