//! Articulated inertia: the apparent inertia of a body and its subtree, with joints free to move, at one frame.

use super::fused::{add_cross, add_scaled, apply, apply_transposed, cross, product};
use super::{SpatialInertia, Symmetric3, join, split};
use crate::scalar::Scalar;
use nalgebra::{Matrix3, Vector3, Vector6};

/// `[I H; Hᵀ M]`: twists to momenta, or twist rates to wrenches. Symmetric and not negative.
///
/// One triangle is stored, so that rounding cannot make it asymmetric: on a chain of 128 ball joints an articulated-body recursion with all
/// 36 entries loses every digit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArticulatedInertia<T> {
    /// I: angular velocity to angular momentum about the frame's origin, kg m².
    pub angular: Symmetric3<T>,
    /// H: linear velocity to angular momentum, kg m.
    pub coupling: Matrix3<T>,
    /// M: linear velocity to linear momentum, kg.
    pub linear: Symmetric3<T>,
}

impl<T: Scalar> ArticulatedInertia<T> {
    /// The inertia of nothing.
    pub fn zero() -> Self {
        Self {
            angular: Symmetric3::zero(),
            coupling: Matrix3::zeros(),
            linear: Symmetric3::zero(),
        }
    }

    /// The momentum of a motion.
    #[inline(always)]
    pub fn apply(&self, twist: &Vector6<T>) -> Vector6<T> {
        let (angular, linear) = split(twist);
        let of_angular = self.apply_angular(&angular);
        let of_linear = self.apply_linear(&linear);
        of_angular + of_linear
    }

    /// The momentum of a rotation about the origin.
    #[inline(always)]
    pub fn apply_angular(&self, angular: &Vector3<T>) -> Vector6<T> {
        join(
            &self.angular.apply(angular),
            &apply_transposed(&self.coupling, angular),
        )
    }

    /// The momentum of a translation.
    #[inline(always)]
    pub fn apply_linear(&self, linear: &Vector3<T>) -> Vector6<T> {
        join(&apply(&self.coupling, linear), &self.linear.apply(linear))
    }

    /// `self + weight y yᵀ`.
    #[inline(always)]
    pub fn add_outer(&mut self, y: &Vector6<T>, weight: T) {
        let (moment, force) = split(y);
        self.angular = self.angular.add_outer(&moment, weight);
        self.linear = self.linear.add_outer(&force, weight);
        let weighted = moment * weight;
        for j in 0..3 {
            let column = &mut self.coupling.data.0[j];
            for i in 0..3 {
                column[i] = weighted[i].mul_add(force[j], column[i]);
            }
        }
    }

    /// The same inertia at a frame whose origin is `−offset` from this one's, axes parallel.
    ///
    /// `H′ = H + r~M`, `I′ = I + r~Hᵀ − H′r~` with r = `offset`.
    #[inline(always)]
    pub fn shifted(&self, offset: &Vector3<T>) -> Self {
        let row =
            |m: &Matrix3<T>, i: usize| Vector3::new(m.data.0[0][i], m.data.0[1][i], m.data.0[2][i]);
        let [mx, my, mz] = self.linear.rows();
        let column = |j: usize, m: &Vector3<T>| {
            let [x, y, z] = self.coupling.data.0[j];
            add_cross(&Vector3::new(x, y, z), offset, m)
        };
        let coupling = Matrix3::from_columns(&[column(0, &mx), column(1, &my), column(2, &mz)]);
        // (r~Hᵀ)_ij = (r × row j of H)_i and −(H′r~)_ij = (r × row i of H′)_j.
        let turned = |m: &Matrix3<T>, i: usize| cross(offset, &row(m, i));
        let own = &self.coupling;
        let before = [turned(own, 0), turned(own, 1), turned(own, 2)];
        let after = [
            turned(&coupling, 0),
            turned(&coupling, 1),
            turned(&coupling, 2),
        ];
        let entry = |own: T, i: usize, j: usize| own + (before[j][i] + after[i][j]);
        let own = &self.angular;
        Self {
            angular: Symmetric3 {
                xx: entry(own.xx, 0, 0),
                xy: entry(own.xy, 0, 1),
                xz: entry(own.xz, 0, 2),
                yy: entry(own.yy, 1, 1),
                yz: entry(own.yz, 1, 2),
                zz: entry(own.zz, 2, 2),
            },
            coupling,
            linear: self.linear,
        }
    }

    /// The same inertia in a frame of the same origin, of which `rotation` holds this frame's axes as columns.
    pub fn rotated(&self, rotation: &Matrix3<T>) -> Self {
        Self {
            angular: self.angular.rotated(rotation),
            coupling: product(&product(rotation, &self.coupling), &rotation.transpose()),
            linear: self.linear.rotated(rotation),
        }
    }

    /// The sum with a rigid body's inertia at the same frame.
    #[inline(always)]
    pub fn with_rigid(&self, rigid: &SpatialInertia<T>) -> Self {
        let mut sum = *self;
        sum.angular += rigid.inertia;
        let [[x, y, z]] = rigid.first_moment.data.0;
        let [a, b, c] = &mut sum.coupling.data.0;
        a[1] += z;
        a[2] -= y;
        b[0] -= z;
        b[2] += x;
        c[0] += y;
        c[1] -= x;
        sum.linear.xx += rigid.mass;
        sum.linear.yy += rigid.mass;
        sum.linear.zz += rigid.mass;
        sum
    }

    /// Adds what another inertia at the same frame weighs.
    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        self.angular += other.angular;
        self.coupling += other.coupling;
        self.linear += other.linear;
    }
}

impl<T: Scalar> From<&SpatialInertia<T>> for ArticulatedInertia<T> {
    #[inline(always)]
    fn from(rigid: &SpatialInertia<T>) -> Self {
        Self {
            angular: rigid.inertia,
            coupling: super::hat(&rigid.first_moment),
            linear: Symmetric3::diagonal(rigid.mass),
        }
    }
}

/// The twist of a frame `offset` away that moves with the same body, axes parallel: `v′ = v + ω × r`.
#[inline(always)]
pub fn shift_twist<T: Scalar>(twist: &Vector6<T>, offset: &Vector3<T>) -> Vector6<T> {
    let (angular, linear) = split(twist);
    join(&angular, &add_cross(&linear, &angular, offset))
}

/// A wrench at a frame `offset` away from this one, read at this one, axes parallel: `moment + r × force`.
#[inline(always)]
pub fn shift_wrench<T: Scalar>(wrench: &Vector6<T>, offset: &Vector3<T>) -> Vector6<T> {
    let (moment, force) = split(wrench);
    join(&add_cross(&moment, offset, &force), &force)
}

/// `sum + weight column`.
#[inline(always)]
pub fn add_weighted<T: Scalar>(sum: &Vector6<T>, column: &Vector6<T>, weight: T) -> Vector6<T> {
    let ((a, b), (c, d)) = (split(sum), split(column));
    join(&add_scaled(&a, &c, weight), &add_scaled(&b, &d, weight))
}
