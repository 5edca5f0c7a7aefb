//! What the joints carry at samples: inverse dynamics at the accelerations that the motion has there.

use super::StepFailure;
use super::flow::Flow;
use super::hybrid::Hybrid;
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::{Dynamics, Recursive};
use hamel_runtime::mechanism::Mechanism;

/// Equations of motion of their own, so that those of the integration are left as they are.
#[derive(Default)]
pub(super) struct Carried {
    work: Option<Work>,
}

struct Work {
    /// Finds accelerations.
    dynamics: Box<dyn Dynamics>,
    /// Holds the wrenches.
    recursive: Recursive,
    /// τ, one entry per degree of freedom.
    efforts: Vec<f64>,
    accelerations: Vec<f64>,
    /// S̄ᵀτ, one entry per speed.
    needed: Vec<f64>,
    /// λ of the constraints that couple joints.
    forces: Vec<f64>,
}

impl Work {
    /// For the mechanism as it is now: joints that friction or a stop holds are driven.
    fn new(flow: &mut Flow<'_>) -> Self {
        let mechanism = Arc::clone(&flow.mechanism);
        let layout = *mechanism.layout();
        Self {
            dynamics: flow.dynamics().of(Arc::clone(&mechanism)),
            efforts: vec![0.0; layout.freedoms],
            accelerations: vec![0.0; layout.speeds],
            needed: vec![0.0; layout.speeds],
            forces: vec![0.0; mechanism.constraints().len()],
            recursive: Recursive::new(mechanism),
        }
    }

    fn is_of(&self, mechanism: &Arc<Mechanism>) -> bool {
        Arc::ptr_eq(Dynamics::mechanism(&self.recursive), mechanism)
    }
}

impl Carried {
    /// Inverse dynamics at time `time`, `q` and v̄, with all that acts there.
    pub(super) fn at(
        &mut self,
        (flow, hybrid): (&mut Flow<'_>, Option<&Hybrid<'_>>),
        time: f64,
        (q, speeds): (&[f64], &[f64]),
    ) -> Result<&Recursive, StepFailure> {
        let known = self.work.take();
        let known = known.filter(|work| work.is_of(&flow.mechanism));
        let work = self.work.insert(known.unwrap_or_else(|| Work::new(flow)));
        let moment = flow.moment(time);
        flow.efforts(time, q, speeds, &mut work.efforts);
        let (efforts, rates) = (&work.efforts, &mut work.accelerations);
        work.dynamics.set_moment(moment);
        work.dynamics.forward_dynamics(q, speeds, efforts, rates)?;
        let (recursive, rates) = (&mut work.recursive, &work.accelerations);
        recursive.set_moment(moment);
        let mut at_ports = flow.inputs_at_ports(time, q, speeds);
        if let Some(hybrid) = hybrid {
            at_ports.extend(hybrid.efforts_at_ports(flow, (time, q, speeds))?);
        }
        recursive.set_port_efforts(at_ports);
        match work.forces.as_mut_slice() {
            [] => recursive.inverse_dynamics(q, speeds, rates, &mut work.needed)?,
            forces => recursive.coupling_force(q, speeds, rates, efforts, forces)?,
        }
        Ok(recursive)
    }
}
