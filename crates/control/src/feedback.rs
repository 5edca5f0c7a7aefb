//! A controller between an integrator and a mechanism.

use super::{ControlError, Controller};
use alloc::vec::Vec;
use hamel_runtime::dynamics::EffortAtPort;

/// Hands a controller to an integrator as [`Inputs`](hamel_integrate::Inputs), and keeps what it could not do.
///
/// Inputs have no way to say that they fail. Where the controller does, efforts are NaN, which ends the integration, and
/// [`Feedback::failure`] says why.
#[derive(Debug)]
pub struct Feedback<'a> {
    controller: &'a mut dyn Controller,
    failure: Option<(f64, ControlError)>,
}

impl<'a> Feedback<'a> {
    /// Feedback by `controller`.
    pub fn new(controller: &'a mut dyn Controller) -> Self {
        Self {
            controller,
            failure: None,
        }
    }

    /// τ into `efforts` at `time`, `q` and v̄.
    pub fn fill(&mut self, time: f64, q: &[f64], speeds: &[f64], efforts: &mut [f64]) {
        if let Err(cause) = self.controller.efforts(time, q, speeds, efforts) {
            efforts.fill(f64::NAN);
            self.failure.get_or_insert((time, cause));
        }
    }

    /// Where τ bends, as [`Controller::bends`]; nothing where the controller fails, which its efforts tell as well.
    pub fn bends(&mut self, time: f64, q: &[f64], speeds: &[f64], bends: &mut Vec<f64>) {
        if let Err(cause) = self.controller.bends(time, q, speeds, bends) {
            self.failure.get_or_insert((time, cause));
        }
    }

    /// What of τ acts at ports, as [`Controller::efforts_at_ports`]; nothing where the controller fails, which its efforts tell as well.
    pub fn efforts_at_ports(
        &mut self,
        time: f64,
        q: &[f64],
        speeds: &[f64],
        efforts: &mut Vec<EffortAtPort>,
    ) {
        let found = self.controller.efforts_at_ports(time, q, speeds, efforts);
        if let Err(cause) = found {
            self.failure.get_or_insert((time, cause));
        }
    }

    /// Takes a step that was accepted: step control has gone round what failed before.
    pub fn accepted(&mut self) {
        self.failure = None;
    }

    /// The controller itself.
    pub fn controller(&mut self) -> &mut dyn Controller {
        self.controller
    }

    /// The first failure since the last accepted step ([`Feedback::accepted`]), and its time, s.
    pub const fn failure(&self) -> Option<&(f64, ControlError)> {
        self.failure.as_ref()
    }
}
