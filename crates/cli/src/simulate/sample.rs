//! The mechanism at one time, in the quantities that all outputs show.

use hamel::mechanism::{Kinematics, Mechanism, StateError};

/// All bodies in the state (`q`, `speeds`), where outputs have numbers for it.
///
/// # Errors
/// A state of the wrong size; an energy that is not finite.
pub fn kinematics(
    mechanism: &Mechanism,
    (q, speeds): (&[f64], &[f64]),
) -> Result<Kinematics, StateError> {
    let kinematics = mechanism.kinematics(q, speeds)?;
    if !kinematics.energy().is_finite() {
        // Which says whose energy it is.
        mechanism.check_energy(q, speeds)?;
    }
    Ok(kinematics)
}
