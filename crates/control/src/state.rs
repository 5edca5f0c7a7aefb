//! States as controllers see them: deviations in each joint's own local coordinates.

use super::ControlError;
use super::error::size;
use hamel_runtime::mechanism::{Body, Mechanism, Space, StateError};

/// ϕ of all joints with `Φ(from, ϕ) = to`, into `phi` (one entry per degree of freedom).
pub(super) fn deviation(
    mechanism: &Mechanism,
    from: &[f64],
    to: &[f64],
    phi: &mut [f64],
) -> Result<(), StateError> {
    for (_, body) in mechanism.joints() {
        let own = &mut phi[body.ranges().freedoms.clone()];
        let found = body
            .joint()
            .local(body.configuration(from), body.configuration(to), own);
        found.map_err(|cause| body.finite_map(cause))?;
    }
    Ok(())
}

/// The largest absolute value, 0 of none; NaN where there is one.
pub(super) fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    let larger = |most: f64, value: &f64| match value.is_nan() {
        true => f64::NAN,
        false => most.max(value.abs()),
    };
    values
        .into_iter()
        .fold(0.0, |most, value| match most.is_nan() {
            true => most,
            false => larger(most, value),
        })
}

/// Whether `q` and v̄ have the sizes of the mechanism and are finite, and the room for τ has its size.
pub(super) fn check_state(
    mechanism: &Mechanism,
    q: &[f64],
    speeds: &[f64],
    efforts: &[f64],
) -> Result<(), ControlError> {
    mechanism.check_vector("configuration", Space::Configuration, q)?;
    mechanism.check_vector("speeds", Space::Speeds, speeds)?;
    Ok(mechanism.check_room("efforts", Space::Freedoms, efforts)?)
}

/// Measures into `values`, one entry each.
pub(super) fn store_measures(measured: &[f64], values: &mut [f64]) -> Result<(), ControlError> {
    size("measures", measured.len(), values.len())?;
    values.copy_from_slice(measured);
    Ok(())
}

/// Whether v̄ is v at a joint.
pub(super) fn is_holonomic(body: &Body) -> bool {
    body.joint().structures().speed_basis.is_identity()
}

/// Refuses mechanisms whose joints are coupled, or moved by something else.
pub(super) fn check_free(mechanism: &Mechanism) -> Result<(), ControlError> {
    if !mechanism.constraints().is_empty() {
        let why = "constraints couple its joints, and so their efforts are not their own";
        return Err(ControlError::Mechanism(why));
    }
    match mechanism.drives().first() {
        None => Ok(()),
        Some(drive) => Err(ControlError::Joint {
            joint: mechanism.bodies()[drive.body].joint_name().into(),
            reason: "has a prescribed motion",
        }),
    }
}
