//! Dual vectors and poses.

use hamel::nalgebra::{Matrix3, SMatrix, SVector, Vector3, Vector6};
use hamel::scalar::{Dual, Scalar};
use hamel::spatial::{Pose, vee};

/// The dual vector `base + ε direction`.
pub(super) fn moving<T: Scalar, const M: usize>(
    base: &SVector<T, M>,
    direction: &SVector<T, M>,
) -> SVector<Dual<T>, M> {
    SVector::from_fn(|i, _| Dual::new(base[i], direction[i]))
}

pub(super) fn constant<T: Scalar, const R: usize, const M: usize>(
    value: &SMatrix<T, R, M>,
) -> SMatrix<Dual<T>, R, M> {
    value.map(Dual::constant)
}

pub(super) fn values<T: Scalar, const R: usize, const M: usize>(
    m: &SMatrix<Dual<T>, R, M>,
) -> SMatrix<T, R, M> {
    m.map(|entry| entry.value)
}

pub(super) fn slopes<T: Scalar, const R: usize, const M: usize>(
    m: &SMatrix<Dual<T>, R, M>,
) -> SMatrix<T, R, M> {
    m.map(|entry| entry.derivative())
}

/// `vee(Ḣ H⁻¹)`: angular part first.
pub(super) fn twist<T: Scalar>(pose: &Pose<Dual<T>>) -> Vector6<T> {
    let (r, dr): (Matrix3<T>, Matrix3<T>) = (values(&pose.rotation), slopes(&pose.rotation));
    let omega = vee(&(dr * r.transpose()));
    let (p, dp): (Vector3<T>, Vector3<T>) = (values(&pose.translation), slopes(&pose.translation));
    let v = dp - omega.cross(&p);
    Vector6::new(omega.x, omega.y, omega.z, v.x, v.y, v.z)
}

pub(super) fn unit<const K: usize>(k: usize) -> SVector<f64, K> {
    SVector::from_fn(|i, _| f64::from(u8::from(i == k)))
}
