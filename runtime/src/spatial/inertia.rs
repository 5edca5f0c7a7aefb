//! Spatial inertia of a rigid body.

use super::{MassProperties, Pose, hat, join, split};
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
    pub inertia: Matrix3<T>,
}

impl<T: Scalar> SpatialInertia<T> {
    /// The inertia of no body.
    pub fn zero() -> Self {
        Self {
            mass: T::zero(),
            first_moment: Vector3::zeros(),
            inertia: Matrix3::zeros(),
        }
    }

    /// The 6×6 matrix N.
    pub fn matrix(&self) -> Matrix6<T> {
        let mut matrix = Matrix6::zeros();
        let cross = hat(&self.first_moment);
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&self.inertia);
        matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&cross);
        matrix.fixed_view_mut::<3, 3>(3, 0).copy_from(&-cross);
        matrix
            .fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&(Matrix3::identity() * self.mass));
        matrix
    }

    /// Momentum `N T` of a body that moves with twist `T`, both in this frame.
    pub fn apply(&self, twist: &Vector6<T>) -> Vector6<T> {
        let (angular, linear) = split(twist);
        join(
            &(self.inertia * angular + self.first_moment.cross(&linear)),
            &(linear * self.mass - self.first_moment.cross(&angular)),
        )
    }

    /// The same inertia in the parent frame of `pose`, when `self` is in its child frame: `Ad⁻ᵀ N Ad⁻¹`.
    pub fn transform(&self, pose: &Pose<T>) -> Self {
        let moment = pose.rotation * self.first_moment;
        let (shift, turned) = (hat(&pose.translation), hat(&moment));
        let rotated = pose.rotation * self.inertia * pose.rotation.transpose();
        let steiner = shift * turned + turned * shift + shift * shift * self.mass;
        Self {
            mass: self.mass,
            first_moment: moment + pose.translation * self.mass,
            inertia: rotated - steiner,
        }
    }

    /// Inertia of both bodies fixed to each other, in one frame.
    pub fn combine(&self, other: &Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            first_moment: self.first_moment + other.first_moment,
            inertia: self.inertia + other.inertia,
        }
    }
}

impl From<&MassProperties> for SpatialInertia<f64> {
    /// About the body origin; the symmetric part of the given inertia is taken.
    fn from(properties: &MassProperties) -> Self {
        let symmetric = (properties.inertia_com + properties.inertia_com.transpose()) * 0.5;
        let cross = hat(&properties.com);
        Self {
            mass: properties.mass,
            first_moment: properties.com * properties.mass,
            inertia: symmetric - cross * cross * properties.mass,
        }
    }
}
