//! Rigid displacements.

use super::fused::{add_cross, apply, apply_transposed, product};
use super::{hat, join, split};
use crate::scalar::Scalar;
use core::ops::Mul;
use nalgebra::{Matrix3, Matrix4, Matrix6, SMatrix, Vector3, Vector6};

/// `H = [R p; 0 1]`: takes coordinates in the child frame to coordinates in the parent frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<T> {
    /// R: the axes of the child frame, in parent axes, as columns.
    pub rotation: Matrix3<T>,
    /// p: the origin of the child frame, in parent axes, m.
    pub translation: Vector3<T>,
}

impl<T: Scalar> Pose<T> {
    /// The pose of a given rotation matrix and origin.
    pub const fn new(rotation: Matrix3<T>, translation: Vector3<T>) -> Self {
        Self {
            rotation,
            translation,
        }
    }

    /// The frame itself.
    pub fn identity() -> Self {
        Self::new(Matrix3::identity(), Vector3::zeros())
    }

    /// A translation without rotation.
    pub fn from_translation(translation: Vector3<T>) -> Self {
        Self::new(Matrix3::identity(), translation)
    }

    /// A rotation about the origin.
    pub fn from_rotation(rotation: Matrix3<T>) -> Self {
        Self::new(rotation, Vector3::zeros())
    }

    /// `self · other`: the pose of `other`'s child in `self`'s parent.
    pub fn compose(&self, other: &Self) -> Self {
        Self::new(
            product(&self.rotation, &other.rotation),
            apply(&self.rotation, &other.translation) + self.translation,
        )
    }

    /// `H⁻¹ = [Rᵀ −Rᵀp; 0 1]`.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self::new(rotation, -(rotation * self.translation))
    }

    /// Parent coordinates of a point given in child coordinates.
    pub fn transform_point(&self, point: &Vector3<T>) -> Vector3<T> {
        self.rotation * point + self.translation
    }

    /// The 4×4 matrix H.
    pub fn matrix(&self) -> Matrix4<T> {
        let mut matrix = Matrix4::identity();
        matrix
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&self.rotation);
        matrix
            .fixed_view_mut::<3, 1>(0, 3)
            .copy_from(&self.translation);
        matrix
    }

    /// `Ad_H = [R 0; p~R R]`, 6×6: child coordinates of a twist to parent coordinates. Wrenches go with `Ad_H⁻ᵀ`.
    pub fn adjoint(&self) -> Matrix6<T> {
        let mut matrix = Matrix6::zeros();
        let lower = hat(&self.translation) * self.rotation;
        matrix
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&self.rotation);
        matrix.fixed_view_mut::<3, 3>(3, 0).copy_from(&lower);
        matrix
            .fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&self.rotation);
        matrix
    }

    /// `Ad_H T`: child coordinates of a twist to parent coordinates.
    pub fn act_twist(&self, twist: &Vector6<T>) -> Vector6<T> {
        let (angular, linear) = split(twist);
        let angular = apply(&self.rotation, &angular);
        let linear = apply(&self.rotation, &linear);
        join(&angular, &add_cross(&linear, &self.translation, &angular))
    }

    /// `Ad_H⁻¹ T`: parent coordinates of a twist to child coordinates.
    pub fn act_twist_inverse(&self, twist: &Vector6<T>) -> Vector6<T> {
        let (angular, linear) = split(twist);
        let linear = add_cross(&linear, &angular, &self.translation);
        join(
            &apply_transposed(&self.rotation, &angular),
            &apply_transposed(&self.rotation, &linear),
        )
    }

    /// `Ad_H⁻ᵀ W`: child coordinates of a wrench or momentum to parent coordinates.
    pub fn act_wrench(&self, wrench: &Vector6<T>) -> Vector6<T> {
        let (moment, force) = split(wrench);
        let force = apply(&self.rotation, &force);
        let moment = apply(&self.rotation, &moment);
        join(&add_cross(&moment, &self.translation, &force), &force)
    }

    /// `Ad_Hᵀ W`: parent coordinates of a wrench or momentum to child coordinates.
    pub fn act_wrench_inverse(&self, wrench: &Vector6<T>) -> Vector6<T> {
        let (moment, force) = split(wrench);
        let moment = add_cross(&moment, &force, &self.translation);
        join(
            &apply_transposed(&self.rotation, &moment),
            &apply_transposed(&self.rotation, &force),
        )
    }

    /// [`Pose::act_twist`] on each column.
    pub fn act_twist_columns<const C: usize>(
        &self,
        columns: &SMatrix<T, 6, C>,
    ) -> SMatrix<T, 6, C> {
        map_columns(columns, |column| self.act_twist(column))
    }

    /// [`Pose::act_twist_inverse`] on each column.
    pub fn act_twist_inverse_columns<const C: usize>(
        &self,
        columns: &SMatrix<T, 6, C>,
    ) -> SMatrix<T, 6, C> {
        map_columns(columns, |column| self.act_twist_inverse(column))
    }

    /// [`Pose::act_wrench`] on each column.
    pub fn act_wrench_columns<const C: usize>(
        &self,
        columns: &SMatrix<T, 6, C>,
    ) -> SMatrix<T, 6, C> {
        map_columns(columns, |column| self.act_wrench(column))
    }
}

impl Pose<f64> {
    /// Whether all of its numbers are finite.
    pub fn is_finite(&self) -> bool {
        let (rotation, translation) = (&self.rotation, &self.translation);
        (rotation.iter().chain(translation)).all(|entry| entry.is_finite())
    }
}

fn map_columns<T: Scalar, const C: usize>(
    columns: &SMatrix<T, 6, C>,
    map: impl Fn(&Vector6<T>) -> Vector6<T>,
) -> SMatrix<T, 6, C> {
    let mut mapped = *columns;
    for j in 0..C {
        mapped.set_column(j, &map(&columns.column(j).into_owned()));
    }
    mapped
}

impl<T: Scalar> Mul for Pose<T> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.compose(&other)
    }
}
