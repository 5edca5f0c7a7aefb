//! Rotations as unit quaternions (w, x, y, z): 4 stored scalars; ϕ is a rotation vector in child axes.

use super::parts::{squared, unit, unit_residual_squared};
pub use super::so3::{differential, differential_inverse};
use crate::scalar::Scalar;
use nalgebra::{Vector3, Vector4};

/// Q exp(ϕ): the product with `(c₀, ½ c₁ ϕ)` of ϕ²/4.
#[inline]
pub fn times_exp<T: Scalar>(q: &Vector4<T>, phi: &Vector3<T>) -> Vector4<T> {
    let square = squared(phi) * T::from_f64(0.25);
    let half = square.stumpff(1) * T::from_f64(0.5);
    let vector = phi.map(|entry| entry * half);
    times(q, &vector.insert_row(0, square.stumpff(0)))
}

/// The ϕ with Q exp(ϕ) = ±Q′, |ϕ| ≤ π.
#[inline]
pub fn log_between<T: Scalar>(q: &Vector4<T>, target: &Vector4<T>) -> Vector3<T> {
    let inverse = Vector4::new(q[0], -q[1], -q[2], -q[3]);
    T::quaternion_vector(times(&inverse, target).into())
}

/// Q̇ at the angular velocity `v` in child axes: the product with `(0, ½ v)`.
#[inline]
pub fn rate<T: Scalar>(q: &Vector4<T>, v: &Vector3<T>) -> Vector4<T> {
    let half = T::from_f64(0.5);
    let ([w, x, y, z], [a, b, c]): ([T; 4], [T; 3]) = ((*q).into(), (*v).into());
    Vector4::new(
        -half * x.mul_add(a, y.mul_add(b, z * c)),
        half * w.mul_add(a, y * c - z * b),
        half * w.mul_add(b, z * a - x * c),
        half * w.mul_add(c, x * b - y * a),
    )
}

/// The unit quaternion nearest to `q`.
#[inline]
pub fn nearest<T: Scalar>(q: &Vector4<T>) -> Vector4<T> {
    unit(q)
}

/// `(|q|² − 1)²`.
#[inline]
pub fn residual_squared<T: Scalar>(q: &Vector4<T>) -> T {
    unit_residual_squared(q)
}

/// Product of quaternions.
#[inline]
fn times<T: Scalar>(a: &Vector4<T>, b: &Vector4<T>) -> Vector4<T> {
    let ([aw, ax, ay, az], [bw, bx, by, bz]): ([T; 4], [T; 4]) = ((*a).into(), (*b).into());
    Vector4::new(
        ax.mul_add(-bx, ay.mul_add(-by, az.mul_add(-bz, aw * bw))),
        aw.mul_add(bx, ax.mul_add(bw, az.mul_add(-by, ay * bz))),
        aw.mul_add(by, ax.mul_add(-bz, ay.mul_add(bw, az * bx))),
        aw.mul_add(bz, ax.mul_add(by, ay.mul_add(-bx, az * bw))),
    )
}
