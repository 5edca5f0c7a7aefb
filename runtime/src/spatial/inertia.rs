//! Spatial inertia of a rigid body.

use super::fused::{add_cross, apply, cross};
use super::{MassProperties, Pose, Symmetric3, hat, join, split};
use crate::scalar::Scalar;
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

/// `N = [I mc~; −mc~ m1]` about the origin of a frame: twists to momenta (angular about that origin; linear).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialInertia<T> {
    /// m, kg.
    pub mass: T,
    /// mc: mass times the position of the centre of mass, kg m.
    pub first_moment: Vector3<T>,
    /// I about the **origin of the frame**, not about the centre of mass, kg m².
    pub inertia: Symmetric3<T>,
}

impl<T: Scalar> SpatialInertia<T> {
    /// The inertia of no body.
    pub fn zero() -> Self {
        Self {
            mass: T::zero(),
            first_moment: Vector3::zeros(),
            inertia: Symmetric3::zero(),
        }
    }

    /// The 6×6 matrix N.
    pub fn matrix(&self) -> Matrix6<T> {
        let mut matrix = Matrix6::zeros();
        let cross = hat(&self.first_moment);
        matrix
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&self.inertia.matrix());
        matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&cross);
        matrix.fixed_view_mut::<3, 3>(3, 0).copy_from(&-cross);
        matrix
            .fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&(Matrix3::identity() * self.mass));
        matrix
    }

    /// Momentum `N T` of a body that moves with twist `T`, both in this frame.
    #[inline(always)]
    pub fn apply(&self, twist: &Vector6<T>) -> Vector6<T> {
        let (angular, linear) = split(twist);
        join(
            &add_cross(&self.inertia.apply(&angular), &self.first_moment, &linear),
            &add_cross(&(linear * self.mass), &angular, &self.first_moment),
        )
    }

    /// Momentum of a body that turns about the frame's origin.
    #[inline(always)]
    pub fn apply_angular(&self, angular: &Vector3<T>) -> Vector6<T> {
        join(
            &self.inertia.apply(angular),
            &cross(angular, &self.first_moment),
        )
    }

    /// The same inertia in a frame of the same origin, of which `rotation` holds this frame's axes as columns.
    #[inline(always)]
    pub fn rotated(&self, rotation: &Matrix3<T>) -> Self {
        Self {
            mass: self.mass,
            first_moment: apply(rotation, &self.first_moment),
            inertia: self.inertia.rotated(rotation),
        }
    }

    /// The same inertia at a frame whose origin is `−offset` from this one's, axes parallel.
    ///
    /// Steiner's terms: `I′ = I + 2 (r·mc) 1 − r mcᵀ − mc rᵀ + m (r·r 1 − r rᵀ)` with r = `offset`.
    #[inline(always)]
    pub fn shifted(&self, offset: &Vector3<T>) -> Self {
        // With s = mc + ½ m r both groups of terms become one: 2 (r·s) 1 − r sᵀ − s rᵀ.
        let half = offset * (self.mass * T::from_f64(0.5));
        let middle = self.first_moment + half;
        Self {
            mass: self.mass,
            first_moment: middle + half,
            inertia: self.inertia.add_steiner(offset, &middle),
        }
    }

    /// The same inertia in the parent frame of `pose`, when `self` is in its child frame: `Ad⁻ᵀ N Ad⁻¹`.
    pub fn transform(&self, pose: &Pose<T>) -> Self {
        self.rotated(&pose.rotation).shifted(&pose.translation)
    }

    /// Inertia of both bodies fixed to each other, in one frame.
    #[inline(always)]
    pub fn combine(&self, other: &Self) -> Self {
        let mut inertia = self.inertia;
        inertia += other.inertia;
        Self {
            mass: self.mass + other.mass,
            first_moment: self.first_moment + other.first_moment,
            inertia,
        }
    }

    /// The wrench of a uniform `gravity` on the body, all in this frame.
    #[inline(always)]
    pub fn weight(&self, gravity: &Vector3<T>) -> Vector6<T> {
        join(&cross(&self.first_moment, gravity), &(gravity * self.mass))
    }

    /// The wrench `N V̇ − ad_Vᵀ N V` that moves the body with twist V and twist rate V̇, all in this frame.
    #[inline(always)]
    pub fn wrench(&self, twist: &Vector6<T>, rate: &Vector6<T>) -> Vector6<T> {
        let (angular, linear) = split(twist);
        let (moment, momentum) = split(&self.apply(twist));
        let (rate_moment, rate_force) = split(&self.apply(rate));
        let turned = add_cross(&rate_moment, &angular, &moment);
        join(
            &add_cross(&turned, &linear, &momentum),
            &add_cross(&rate_force, &angular, &momentum),
        )
    }
}

impl SpatialInertia<f64> {
    /// Whether all of its numbers are finite.
    pub fn is_finite(&self) -> bool {
        let moments = self.inertia.matrix();
        let numbers = self.first_moment.iter().chain(&moments);
        self.mass.is_finite() && numbers.into_iter().all(|entry| entry.is_finite())
    }
}

impl From<&MassProperties> for SpatialInertia<f64> {
    /// About the body origin; the symmetric part of the given inertia is taken.
    fn from(properties: &MassProperties) -> Self {
        let central = Self {
            mass: properties.mass,
            first_moment: Vector3::zeros(),
            inertia: Symmetric3::from_matrix(&properties.inertia_com),
        };
        central.shifted(&properties.com)
    }
}
