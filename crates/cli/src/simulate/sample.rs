//! The mechanism at one time, in the quantities that all outputs show.

use hamel::mechanism::{Kinematics, Mechanism, StateError};
use hamel::spatial::Pose;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

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

/// A rotation as unit quaternion x, y, z, w, whose scalar w is not negative.
pub fn quaternion(rotation: &Matrix3<f64>) -> [f64; 4] {
    let rotation = Rotation3::from_matrix_unchecked(*rotation);
    unit_quaternion(
        UnitQuaternion::from_rotation_matrix(&rotation)
            .coords
            .into(),
    )
}

/// Of both quaternions x, y, z, w of one rotation that whose scalar w is not negative, at length 1.
pub fn unit_quaternion(xyzw: [f64; 4]) -> [f64; 4] {
    let norm = xyzw.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
    let factor = if xyzw[3] < 0.0 { -1.0 } else { 1.0 } / norm;
    // A sum with zero has no negative zero.
    xyzw.map(|entry| entry * factor + 0.0)
}

/// A pose as position, m, and unit quaternion x, y, z, w.
pub fn seven(pose: &Pose<f64>) -> [f64; 7] {
    let [x, y, z] = pose.translation.into();
    let [i, j, k, w] = quaternion(&pose.rotation);
    [x, y, z, i, j, k, w]
}
