//! Where a joint puts its child, and how it moves it.

use super::pattern::{Kernels, Pattern};
use super::{Motion, Steps};
use crate::erased::nan;
use crate::joint::Joint;
use crate::matrix::{product, zeros};
use crate::scalar::Scalar;
use crate::spatial::Pose;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3, Vector6};

/// The child frame of a joint in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement<T> {
    /// Its axes, in world axes, as columns.
    pub rotation: Matrix3<T>,
    /// Its origin, in world axes, m.
    pub origin: Vector3<T>,
    /// Its origin seen from that of the parent's child frame, in world axes, m.
    ///
    /// Kept beside [`Placement::origin`], whose difference would lose digits far from the world's origin.
    pub offset: Vector3<T>,
}

impl<T: Scalar> Placement<T> {
    /// The world itself.
    pub fn world() -> Self {
        Self {
            rotation: Matrix3::identity(),
            origin: Vector3::zeros(),
            offset: Vector3::zeros(),
        }
    }

    /// NaN.
    pub(crate) fn unknown() -> Self {
        Self {
            rotation: Matrix3::repeat(nan()),
            origin: Vector3::repeat(nan()),
            offset: Vector3::repeat(nan()),
        }
    }

    /// As a pose: child coordinates to world coordinates.
    pub fn pose(&self) -> Pose<T> {
        Pose::new(self.rotation, self.origin)
    }
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Steps<'_, J, N, K, S, C>
where
    J: Joint<N, K, S, C>,
{
    /// What is known of its motion before it moves.
    const PATTERN: Pattern<S> = Pattern {
        rotation: J::PATTERNS.rotation,
        translation: J::PATTERNS.translation,
        columns: J::PATTERNS.speed_columns(),
    };

    /// The child frame of the joint at `q`.
    #[inline(always)]
    pub(crate) fn child<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        joint_frame: &Pose<T>,
        parent: &Placement<T>,
    ) -> Placement<T> {
        const { Self::PATTERN }.child(&self.0.pose(q), joint_frame, parent)
    }

    /// Whether column `j` of X̄ can have an angular, and whether it can have a linear part.
    #[inline(always)]
    pub(crate) const fn column_parts(j: usize) -> (bool, bool) {
        const { Self::PATTERN }.column_parts(j)
    }

    /// The same of any column.
    #[inline(always)]
    pub(crate) fn parts() -> (bool, bool) {
        const { Self::PATTERN }.parts()
    }

    /// The columns of `X̄ = X^c S̄`, turned into world axes.
    #[inline(always)]
    pub(crate) fn columns<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        rotation: &Matrix3<T>,
    ) -> [Vector6<T>; S] {
        const { Self::PATTERN }.columns(&self.speed_map(q), rotation)
    }

    /// `X̄ = X^c S̄` in child axes.
    #[inline(always)]
    fn speed_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, S> {
        let map = self.0.twist_map_child(q);
        if const { J::STRUCTURES.speed_basis.is_identity() } {
            let mut same = zeros();
            for j in 0..S {
                same.data.0[j] = map.data.0[j];
            }
            return same;
        }
        product(&map, &self.0.speed_basis(q))
    }

    /// The kernels that its motion is made of, at `q` and `speeds`.
    #[inline(always)]
    fn kernels<T: Scalar>(&self, q: &SVector<T, N>, speeds: &SVector<T, S>) -> Kernels<T, S> {
        Kernels {
            pose: self.0.pose(q),
            speed_map: self.speed_map(q),
            bias: match const { J::STRUCTURES.bias_acceleration.is_zero() } {
                true => None,
                false => Some(self.0.bias_acceleration(q, speeds)),
            },
        }
    }

    /// The child's motion at v̄̇ = 0, and the columns of X̄.
    #[inline(always)]
    pub(crate) fn advance<T: Scalar>(
        &self,
        (q, speeds): (&SVector<T, N>, &SVector<T, S>),
        joint_frame: &Pose<T>,
        parent: &Motion<T>,
        columns: &mut [Vector6<T>; S],
    ) -> Motion<T> {
        let kernels = self.kernels(q, speeds);
        const { Self::PATTERN }.advance(&kernels, speeds, (joint_frame, parent), columns)
    }

    /// [`Steps::advance`] by code that all joints of so many speeds share, for numbers of which each operation is many.
    pub(crate) fn advance_shared<T: Scalar>(
        &self,
        (q, speeds): (&SVector<T, N>, &SVector<T, S>),
        joint_frame: &Pose<T>,
        parent: &Motion<T>,
        columns: &mut [Vector6<T>; S],
    ) -> Motion<T> {
        let kernels = self.kernels(q, speeds);
        let pattern = const { &Self::PATTERN };
        pattern.advance_shared(&kernels, speeds, (joint_frame, parent), columns)
    }

    /// `start + X̄ weights`, without the parts that the joint type does not have.
    #[inline(always)]
    pub(crate) fn add_columns<T: Scalar>(
        start: &Vector6<T>,
        columns: &[Vector6<T>; S],
        weights: &SVector<T, S>,
    ) -> Vector6<T> {
        const { Self::PATTERN }.add_columns(start, columns, weights)
    }
}
