//! The method where a scene leaves it open.

use crate::{Scene, Settings};
use hamel_integrate::{Choice, IntegrateError, Method, Sampling, State, Wanted};

/// What a motion has beside its scene, which the exponential method does not go with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Company {
    /// Whether efforts follow the state: a controller, or inputs of the caller.
    pub has_inputs: bool,
    /// Whether there are events beside those of the scene.
    pub has_events: bool,
}

impl Scene {
    /// The method for a motion from `start` under `settings`: the one named, or else one that suits the scene and the tolerance, and why.
    ///
    /// # Errors
    /// A first state that the equations of motion cannot be evaluated at.
    pub fn choose_method(
        &self,
        settings: &Settings,
        start: &State,
        company: Company,
    ) -> Result<(Method, Option<String>), IntegrateError> {
        let tolerance = match settings.method {
            Method::Controlled { control, .. } if settings.chooses => control.tolerance,
            named => return Ok((named, None)),
        };
        let is_bound = company.has_inputs
            || company.has_events
            || !self.mechanism.drives().is_empty()
            || !self.mechanism.constraints().is_empty()
            || !self.mechanism.frictions().is_empty()
            || !self.mechanism.stops().is_empty()
            || !self.events.is_empty()
            || settings.sampling == Sampling::Dense;
        let wanted = Wanted {
            tolerance,
            span: settings.t_end - start.time,
            is_bound,
        };
        let choice = Choice::new(&self.mechanism, start, wanted)?;
        let reason = match company.has_inputs {
            true => choice.reason + "; what the controller adds was not looked at",
            false => choice.reason,
        };
        Ok((Method::controlled(choice.scheme, tolerance), Some(reason)))
    }
}
