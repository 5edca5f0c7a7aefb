//! Rotation vector of a rotation matrix or a quaternion, for any scalar that is not a series.

use super::Scalar;
use nalgebra::{Matrix3, Vector3};

/// Below this square of tan(θ/2), atan(x)/x is 1 to the last place, and the norm of the axis may underflow.
const SMALL: f64 = 1e-17;

/// Logarithm by unit quaternion: see [`Scalar::rotation_vector`].
///
/// Of the four rows of the matrix `4 q qᵀ`, each linear in R, the one with the largest diagonal entry is taken; it needs
/// no normalisation, since the angle is that of a point in the plane.
pub(super) fn rotation_vector<T: Scalar>(r: &Matrix3<T>) -> Vector3<T> {
    quaternion_vector(largest_quaternion_row(r))
}

/// See [`Scalar::quaternion_vector`].
pub(super) fn quaternion_vector<T: Scalar>([w, x, y, z]: [T; 4]) -> Vector3<T> {
    let zero = T::zero();
    let flip = w.less(zero);
    let [w, x, y, z] = [w, x, y, z].map(|entry| T::select(flip, -entry, entry));
    let square = x * x + y * y + z * z;
    let norm = square.sqrt();
    let two = T::from_f64(2.0);
    let small = square.less(w * w * T::from_f64(SMALL));
    // Both branches are evaluated in every lane: keep the one that is not taken finite.
    let divisor = T::select(small, w, norm);
    let angle = T::select(small, two, two * norm.atan2(w));
    let factor = angle / divisor;
    Vector3::new(x * factor, y * factor, z * factor)
}

fn largest_quaternion_row<T: Scalar>(r: &Matrix3<T>) -> [T; 4] {
    let one = T::one();
    let (wx, wy, wz) = (
        r[(2, 1)] - r[(1, 2)],
        r[(0, 2)] - r[(2, 0)],
        r[(1, 0)] - r[(0, 1)],
    );
    let (xy, xz, yz) = (
        r[(0, 1)] + r[(1, 0)],
        r[(0, 2)] + r[(2, 0)],
        r[(1, 2)] + r[(2, 1)],
    );
    let (xx, yy, zz) = (r[(0, 0)], r[(1, 1)], r[(2, 2)]);
    let rows = [
        [one + (xx + yy + zz), wx, wy, wz],
        [wx, one + (xx - yy - zz), xy, xz],
        [wy, xy, one + (yy - xx - zz), yz],
        [wz, xz, yz, one + (zz - xx - yy)],
    ];
    let mut best = rows[0];
    let mut diagonal = rows[0][0];
    for (i, row) in rows.iter().enumerate().skip(1) {
        let larger = diagonal.less(row[i]);
        best = core::array::from_fn(|j| T::select(larger, row[j], best[j]));
        diagonal = T::select(larger, row[i], diagonal);
    }
    best
}
