//! Plane rotations as matrices: 4 stored scalars, 1 angle.

use super::parts::{product, squared, transposed_product, unit};
use crate::scalar::Scalar;
use nalgebra::{Matrix2, Vector1, Vector2, Vector3, Vector4};

/// Q exp(ϕ): turned by the angle ϕ.
#[inline]
pub fn times_exp<T: Scalar>(q: &Vector4<T>, phi: &Vector1<T>) -> Vector4<T> {
    let (sin, cos) = phi[0].sin_cos();
    stored(&product(&matrix(q), &rotation(cos, sin)))
}

/// The angle from Q to Q′, in (−π, π].
#[inline]
pub fn log_between<T: Scalar>(q: &Vector4<T>, target: &Vector4<T>) -> Vector1<T> {
    let turned = Vector2::new(target[0], target[2]);
    Vector1::new(angle_to(&matrix(q), &turned))
}

/// Q̇ at the angular velocity `v`.
#[inline]
pub fn rate<T: Scalar>(q: &Vector4<T>, v: &Vector1<T>) -> Vector4<T> {
    Vector4::new(q[1] * v[0], -q[0] * v[0], q[3] * v[0], -q[2] * v[0])
}

/// The rotation nearest to `q`.
#[inline]
pub fn nearest<T: Scalar>(q: &Vector4<T>) -> Vector4<T> {
    stored(&nearest_matrix(&matrix(q)))
}

/// Sum of the squares of `q22 − q11`, `q12 + q21` and `q11² + q21² − 1`.
#[inline]
pub fn residual_squared<T: Scalar>(q: &Vector4<T>) -> T {
    matrix_residual_squared(&matrix(q))
}

/// The rotation by the angle with this cosine and sine.
#[inline]
pub(super) fn rotation<T: Scalar>(cos: T, sin: T) -> Matrix2<T> {
    Matrix2::new(cos, -sin, sin, cos)
}

/// The angle of `Rᵀ x`.
#[inline]
pub(super) fn angle_to<T: Scalar>(rotation: &Matrix2<T>, x: &Vector2<T>) -> T {
    let relative = transposed_product(rotation, x);
    relative[1].atan2(relative[0])
}

/// The rotation nearest to a matrix.
#[inline]
pub(super) fn nearest_matrix<T: Scalar>(m: &Matrix2<T>) -> Matrix2<T> {
    let half = T::from_f64(0.5);
    let cos = (m[(0, 0)] + m[(1, 1)]) * half;
    let sin = (m[(1, 0)] - m[(0, 1)]) * half;
    let turned = unit(&Vector2::new(cos, sin));
    rotation(turned[0], turned[1])
}

/// Sum of the squares of what vanishes for a rotation.
#[inline]
pub(super) fn matrix_residual_squared<T: Scalar>(m: &Matrix2<T>) -> T {
    let column = Vector2::new(m[(0, 0)], m[(1, 0)]);
    squared(&Vector3::new(
        m[(1, 1)] - m[(0, 0)],
        m[(0, 1)] + m[(1, 0)],
        squared(&column) - T::one(),
    ))
}

#[inline]
fn matrix<T: Scalar>(q: &Vector4<T>) -> Matrix2<T> {
    Matrix2::new(q[0], q[1], q[2], q[3])
}

#[inline]
fn stored<T: Scalar>(m: &Matrix2<T>) -> Vector4<T> {
    Vector4::new(m[(0, 0)], m[(0, 1)], m[(1, 0)], m[(1, 1)])
}
