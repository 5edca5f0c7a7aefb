//! A point in the plane in polar coordinates (r, θ): a joint that loses a degree of freedom where r = 0.

use super::derived::{Declared, Derived};
use hamel_runtime::erased::{AnyJoint, erase};
use hamel_runtime::finite::least_absolute;
use hamel_runtime::joint::{VelocityFrame, from_rows};
use hamel_runtime::scalar::Scalar;
use hamel_runtime::spatial::Pose;
use nalgebra::{Matrix3, SMatrix, SVector, Vector2, Vector3};
use std::sync::Arc;

/// The joint with home at the given radius on the x axis.
pub fn polar(home: f64) -> Arc<dyn AnyJoint> {
    erase(Derived(Polar { home }))
}

#[derive(Clone, Debug)]
pub struct Polar {
    home: f64,
}

impl Declared<2, 2, 2, 0> for Polar {
    const NAME: &'static str = "polar";
    const COORDINATES: [&'static str; 2] = ["r", "theta"];
    const FREEDOMS: [&'static str; 2] = ["r", "theta"];
    const SPEEDS: [&'static str; 2] = ["r", "theta"];
    const VELOCITY_FRAME: VelocityFrame = VelocityFrame::Declared;
    const SINGULARITIES: &'static [&'static str] = &["r"];

    fn home<T: Scalar>(&self) -> Vector2<T> {
        Vector2::new(T::from_f64(self.home), T::zero())
    }
    fn pose<T: Scalar>(&self, q: &Vector2<T>) -> Pose<T> {
        let (sin, cos) = q[1].sin_cos();
        let origin = Vector3::new(q[0] * cos, q[0] * sin, T::zero());
        Pose::new(Matrix3::identity(), origin)
    }
    fn twist_map<T: Scalar>(&self, q: &Vector2<T>) -> SMatrix<T, 6, 2> {
        let (zero, (sin, cos)) = (T::zero(), q[1].sin_cos());
        from_rows([
            [zero, zero],
            [zero, zero],
            [zero, zero],
            [cos, -q[0] * sin],
            [sin, q[0] * cos],
            [zero, zero],
        ])
    }
    fn retract<T: Scalar>(&self, q: &Vector2<T>, phi: &Vector2<T>) -> Vector2<T> {
        q + phi
    }
    fn local<T: Scalar>(&self, q: &Vector2<T>, target: &Vector2<T>) -> Vector2<T> {
        target - q
    }
    fn speed_basis<T: Scalar>(&self, _q: &Vector2<T>) -> SMatrix<T, 2, 2> {
        SMatrix::identity()
    }
    fn constraint<T: Scalar>(&self, _q: &Vector2<T>) -> SMatrix<T, 2, 0> {
        SMatrix::zeros()
    }
    fn project<T: Scalar>(&self, q: &SVector<T, 2>) -> SVector<T, 2> {
        *q
    }
    fn residual<T: Scalar>(&self, _q: &Vector2<T>) -> T {
        T::zero()
    }
    fn singularity<T: Scalar>(&self, q: &Vector2<T>) -> T {
        least_absolute([q[0]])
    }
}
