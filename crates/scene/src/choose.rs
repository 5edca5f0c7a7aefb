//! The method where a scene leaves it open.

use crate::{Control, Scene, Settings};
use hamel_integrate::{Choice, IntegrateError, Method, Sampling, Wanted};

impl Scene {
    /// The method for the first state of the scene under `settings`, with the tolerance of its method, and why. `control` is what will control the
    /// motion.
    ///
    /// # Errors
    /// A first state that the equations of motion cannot be evaluated at.
    pub fn choose_method(
        &self,
        settings: &Settings,
        control: Option<&Control>,
    ) -> Result<(Method, String), IntegrateError> {
        let tolerance = match settings.method {
            Method::Controlled { control, .. } => control.tolerance,
            Method::Fixed { .. } => Settings::DEFAULT_TOL,
        };
        let is_bound = control.is_some()
            || !self.mechanism.drives().is_empty()
            || !self.mechanism.constraints().is_empty()
            || !self.events.is_empty()
            || settings.sampling == Sampling::Dense;
        let wanted = Wanted {
            tolerance,
            span: settings.t_end,
            is_bound,
        };
        let choice = Choice::new(&self.mechanism, &self.start(), wanted)?;
        let reason = match control {
            Some(_) => choice.reason + "; what the controller adds was not looked at",
            None => choice.reason,
        };
        Ok((Method::controlled(choice.scheme, tolerance), reason))
    }
}
