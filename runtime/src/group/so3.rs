//! Rotations as matrices: 9 stored scalars; ϕ is a rotation vector in child axes.

use super::parts::{product, squared, transposed_product};
use crate::scalar::Scalar;
use crate::spatial::so3;
use nalgebra::{Matrix3, SVector, Vector3};

/// Q exp(ϕ): `R (I + c₁ ϕ~ + c₂ ϕ~²)`.
#[inline]
pub fn times_exp<T: Scalar>(q: &SVector<T, 9>, phi: &Vector3<T>) -> SVector<T, 9> {
    stored(&product(&matrix(q), &so3::exp(phi)))
}

/// The ϕ with Q exp(ϕ) = Q′, |ϕ| ≤ π: the rotation vector of `RᵀR′`.
#[inline]
pub fn log_between<T: Scalar>(q: &SVector<T, 9>, target: &SVector<T, 9>) -> Vector3<T> {
    so3::log(&transposed_product(&matrix(q), &matrix(target)))
}

/// Q̇ at the angular velocity `v` in child axes: `R v~`, by rows `(row of R) × v`.
#[inline]
pub fn rate<T: Scalar>(q: &SVector<T, 9>, v: &Vector3<T>) -> SVector<T, 9> {
    stored(&turned(&matrix(q), v))
}

/// `R v~`.
#[inline]
pub(super) fn turned<T: Scalar>(rotation: &Matrix3<T>, v: &Vector3<T>) -> Matrix3<T> {
    let row = |i: usize| rotation.row(i).transpose().cross(v).transpose();
    Matrix3::from_rows(&[row(0), row(1), row(2)])
}

/// D at ϕ: `I − c₂ ϕ~ + c₃ ϕ~²`.
#[inline]
pub fn differential<T: Scalar>(phi: &Vector3<T>) -> Matrix3<T> {
    so3::left_jacobian(phi).transpose()
}

/// `D⁻¹ rate = rate + ½ ϕ × rate + G(ϕ²) ϕ × (ϕ × rate)`, for |ϕ| < 2π.
#[inline]
pub fn differential_inverse<T: Scalar>(phi: &Vector3<T>, rate: &Vector3<T>) -> Vector3<T> {
    let g = squared(phi).dexp_inverse(0);
    let once = phi.cross(rate);
    let twice = phi.cross(&once);
    once * T::from_f64(0.5) + (twice * g + rate)
}

/// The rotation nearest to `q`, up to 1e-4 off.
#[inline]
pub fn nearest<T: Scalar>(q: &SVector<T, 9>) -> SVector<T, 9> {
    stored(&so3::nearest(&matrix(q)))
}

/// Sum of the squares of `RᵀR − I`, each entry once, and `det R − 1`.
#[inline]
pub fn residual_squared<T: Scalar>(q: &SVector<T, 9>) -> T {
    matrix_residual_squared(&matrix(q))
}

/// The same for a matrix.
#[inline]
pub(super) fn matrix_residual_squared<T: Scalar>(r: &Matrix3<T>) -> T {
    let one = T::one();
    let column = |j: usize| r.column(j).into_owned();
    let (x, y, z) = (column(0), column(1), column(2));
    let dot = |a: &Vector3<T>, b: &Vector3<T>| transposed_product(a, b)[0];
    let diagonal = Vector3::new(dot(&x, &x) - one, dot(&y, &y) - one, dot(&z, &z) - one);
    let above = Vector3::new(dot(&x, &y), dot(&x, &z), dot(&y, &z));
    let determinant = dot(&x, &y.cross(&z)) - one;
    squared(&diagonal) + squared(&above) + determinant * determinant
}

#[inline]
fn matrix<T: Scalar>(q: &SVector<T, 9>) -> Matrix3<T> {
    Matrix3::from_row_slice(q.as_slice())
}

#[inline]
fn stored<T: Scalar>(r: &Matrix3<T>) -> SVector<T, 9> {
    SVector::from_column_slice(r.transpose().as_slice())
}
