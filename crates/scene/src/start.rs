//! Whether a scene can start: what every command that goes on from a scene asks first.

use crate::arithmetic::Arithmetic;
use crate::control::Control;
use crate::scene::Scene;
use crate::settings::Settings;
use hamel_control::{ControlError, Feedback};
use hamel_integrate::{IntegrateError, Integration, Options};
use std::cell::RefCell;

/// Why a scene cannot start.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StartError {
    /// The first state, or the method, is refused.
    #[error(transparent)]
    Integrate(#[from] IntegrateError),
    /// The controller cannot be made, or has no efforts for the first state.
    #[error("controller: {0}")]
    Control(#[from] ControlError),
}

impl Scene {
    /// Whether the scene can start under `settings`, with `control` if there is any: the method, the first state, the rates that the equations
    /// of motion give it, the efforts of the controller and the events there.
    ///
    /// # Errors
    /// The first of these that is refused.
    pub fn check_start(
        &self,
        settings: &Settings,
        control: Option<&Control>,
    ) -> Result<(), StartError> {
        let checked = self.check_start_in(settings.arithmetic, settings, control);
        match (settings.arithmetic, checked) {
            // What doubles cannot solve, the other may.
            (Arithmetic::Auto, Err(_)) => {
                self.check_start_in(Arithmetic::Refined, settings, control)
            }
            (_, checked) => checked,
        }
    }

    fn check_start_in(
        &self,
        arithmetic: Arithmetic,
        settings: &Settings,
        control: Option<&Control>,
    ) -> Result<(), StartError> {
        let mut dynamics = arithmetic.dynamics(&self.mechanism);
        let start = self.start();
        let options = Options {
            form: settings.form,
            method: settings.method,
            t_end: settings.t_end,
            samples: Vec::new(),
        };
        let mut controller = control
            .map(|control| control.controller(&self.mechanism, settings.t_end))
            .transpose()?;
        let feedback = controller
            .as_mut()
            .map(|controller| RefCell::new(Feedback::new(&mut **controller)));
        let mut integration =
            Integration::new(&mut *dynamics, &start, &options).sampling(settings.sampling);
        for event in &self.events {
            integration = integration.event(event.event(&self.mechanism));
        }
        if let Some(feedback) = &feedback {
            integration = integration.inputs(|time, q, speeds, efforts| {
                feedback.borrow_mut().fill(time, q, speeds, efforts);
            });
        }
        if let Some(period) = control.and_then(|control| control.period) {
            integration = integration.held(period);
        }
        let checked = integration.check();
        let failure = feedback.and_then(|feedback| feedback.into_inner().failure().cloned());
        match (checked, failure) {
            (Err(_), Some((_, cause))) => Err(cause.into()),
            (checked, _) => Ok(checked?),
        }
    }
}
