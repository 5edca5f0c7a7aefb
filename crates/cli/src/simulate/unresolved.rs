//! The oscillations that the steps of a method pass over.

use super::plan::Plan;
use hamel::integrate::{IntegrateError, Scheme, Spectrum};
use hamel_console::output::Failure;

/// Steps that turn the phase of an oscillation by more than this do not follow it, rad: some six of them a period.
const FOLLOWED: f64 = 1.0;

/// What an implicit method has passed over in `steps` steps to the time `until`, s, by the oscillations about the first state.
///
/// # Errors
/// A first state that the equations of motion cannot be evaluated at.
pub fn unresolved(plan: &Plan, steps: usize, until: f64) -> Result<Option<String>, Failure> {
    let does = match plan.settings.method.scheme() {
        Scheme::Midpoint | Scheme::Gauss2 | Scheme::Gauss3 => "its energy stays bounded",
        Scheme::DiscreteGradient => "its energy is kept",
        Scheme::Radau5 => "it is damped away",
        _ => return Ok(None),
    };
    if plan.scene.mechanism.elements().is_empty() || steps == 0 {
        return Ok(None);
    }
    let step = until / steps as f64;
    let spectrum = Spectrum::at(&plan.scene.mechanism, &plan.scene.start()).map_err(failed)?;
    Ok(spectrum.and_then(|spectrum| {
        let mut modes = spectrum.modes().iter();
        let mode = modes.find(|mode| !mode.is_damped() && mode.rate() * step > FOLLOWED)?;
        let (rate, joint) = (mode.rate(), spectrum.joint(mode));
        let period = std::f64::consts::TAU / rate;
        Some(format!(
            "an oscillation at joint `{joint}` has a period of {period:.2e} s, the mean step is {step:.2e} s: {does}, its phase is not followed"
        ))
    }))
}

fn failed(error: IntegrateError) -> Failure {
    Failure::Simulation(error.to_string())
}
