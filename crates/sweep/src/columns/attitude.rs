//! Attitudes as unit quaternions, scalar last.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

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
