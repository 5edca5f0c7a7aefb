//! Rotations: exponential, logarithm and their differentials.

use crate::scalar::Scalar;
use nalgebra::{Matrix3, Vector3};

/// `exp(r~)`: the rotation by |r| radians about r.
pub fn exp<T: Scalar>(r: &Vector3<T>) -> Matrix3<T> {
    let square = r.dot(r);
    quadratic(r, square.stumpff(1), square.stumpff(2))
}

/// The rotation vector of `rotation`, |r| ≤ π: inverse of [`exp`].
pub fn log<T: Scalar>(rotation: &Matrix3<T>) -> Vector3<T> {
    T::rotation_vector(rotation)
}

/// Left differential `J = I + c₂ r~ + c₃ r~²`: `d/dt exp(r~) = hat(J ṙ) exp(r~)`. Its transpose is the right one.
pub fn left_jacobian<T: Scalar>(r: &Vector3<T>) -> Matrix3<T> {
    let square = r.dot(r);
    quadratic(r, square.stumpff(2), square.stumpff(3))
}

/// Inverse of [`left_jacobian`], for |r| < 2π: `I − ½ r~ + G(r²) r~²`.
pub fn left_jacobian_inverse<T: Scalar>(r: &Vector3<T>) -> Matrix3<T> {
    quadratic(r, T::from_f64(-0.5), r.dot(r).dexp_inverse(0))
}

/// The rotation nearest to a matrix that is off SO(3) by rounding or by up to 1e-4.
///
/// Two steps `R ← R + ½ R (I − RᵀR)` of the polar iteration: each squares the distance, and as a correction that is small
/// itself it leaves R accurate to the last place.
pub fn nearest<T: Scalar>(matrix: &Matrix3<T>) -> Matrix3<T> {
    let half = T::from_f64(0.5);
    let step = |r: Matrix3<T>| {
        let excess = Matrix3::identity() - r.tr_mul(&r);
        r + r * excess * half
    };
    step(step(*matrix))
}

/// `I + a r~ + b r~²`.
#[inline]
pub(crate) fn quadratic<T: Scalar>(r: &Vector3<T>, a: T, b: T) -> Matrix3<T> {
    let mut sum = powers(r, a, b);
    (0..3).for_each(|i| sum[(i, i)] += T::one());
    sum
}

/// `a r~ + b r~²`, entry by entry.
#[inline]
pub(crate) fn powers<T: Scalar>(r: &Vector3<T>, a: T, b: T) -> Matrix3<T> {
    let (ax, ay, az) = (a * r.x, a * r.y, a * r.z);
    let (xx, yy, zz) = (r.x * r.x, r.y * r.y, r.z * r.z);
    let (bx, by) = (b * r.x, b * r.y);
    let (xy, xz, yz) = (bx * r.y, bx * r.z, by * r.z);
    Matrix3::from_row_slice(&[
        -b * (yy + zz),
        xy - az,
        xz + ay,
        xy + az,
        -b * (xx + zz),
        yz - ax,
        xz - ay,
        yz + ax,
        -b * (xx + yy),
    ])
}
