//! Products of 3-vectors and 3×3 matrices through [`Scalar::mul_add`]: fused where the target has the instruction.

use crate::scalar::Scalar;
use nalgebra::{Matrix3, Vector3};

/// `aᵀ b`.
#[inline(always)]
pub fn dot<T: Scalar>(a: &Vector3<T>, b: &Vector3<T>) -> T {
    a.x.mul_add(b.x, a.y.mul_add(b.y, a.z * b.z))
}

/// `a × b`.
#[inline(always)]
pub fn cross<T: Scalar>(a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(
        a.y.mul_add(b.z, -(a.z * b.y)),
        a.z.mul_add(b.x, -(a.x * b.z)),
        a.x.mul_add(b.y, -(a.y * b.x)),
    )
}

/// `sum + a × b`.
#[inline(always)]
pub fn add_cross<T: Scalar>(sum: &Vector3<T>, a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(
        a.y.mul_add(b.z, (-a.z).mul_add(b.y, sum.x)),
        a.z.mul_add(b.x, (-a.x).mul_add(b.z, sum.y)),
        a.x.mul_add(b.y, (-a.y).mul_add(b.x, sum.z)),
    )
}

/// `sum + weight v`.
#[inline(always)]
pub fn add_scaled<T: Scalar>(sum: &Vector3<T>, v: &Vector3<T>, weight: T) -> Vector3<T> {
    Vector3::new(
        v.x.mul_add(weight, sum.x),
        v.y.mul_add(weight, sum.y),
        v.z.mul_add(weight, sum.z),
    )
}

/// `M v`.
#[inline(always)]
pub fn apply<T: Scalar>(m: &Matrix3<T>, v: &Vector3<T>) -> Vector3<T> {
    let [a, b, c] = m.data.0;
    let row = |i: usize| a[i].mul_add(v.x, b[i].mul_add(v.y, c[i] * v.z));
    Vector3::new(row(0), row(1), row(2))
}

/// `Mᵀ v`.
#[inline(always)]
pub fn apply_transposed<T: Scalar>(m: &Matrix3<T>, v: &Vector3<T>) -> Vector3<T> {
    let row = |[x, y, z]: [T; 3]| x.mul_add(v.x, y.mul_add(v.y, z * v.z));
    let [a, b, c] = m.data.0;
    Vector3::new(row(a), row(b), row(c))
}

/// `L M`.
#[inline(always)]
pub fn product<T: Scalar>(l: &Matrix3<T>, m: &Matrix3<T>) -> Matrix3<T> {
    let column = |j: usize| {
        let [x, y, z] = m.data.0[j];
        apply(l, &Vector3::new(x, y, z))
    };
    Matrix3::from_columns(&[column(0), column(1), column(2)])
}
