//! A slider that ends at 1 m: one of its kernels has no value beyond, as where a root, a quotient or an exponential of a spec has none.

use super::derived::{Declared, Derived};
use hamel_runtime::erased::{AnyJoint, erase};
use hamel_runtime::joint::VelocityFrame;
use hamel_runtime::scalar::Scalar;
use hamel_runtime::spatial::Pose;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use std::sync::Arc;

/// Which kernel has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// H, and with it all that is made of its derivatives.
    Pose,
    /// X.
    TwistMap,
    /// Φ.
    Retract,
    /// S̄.
    SpeedBasis,
}

impl Kernel {
    pub const ALL: [Self; 4] = [Self::Pose, Self::TwistMap, Self::Retract, Self::SpeedBasis];
}

/// The slider along x.
pub fn wall(kernel: Kernel) -> Arc<dyn AnyJoint> {
    erase(Derived(Wall { kernel }))
}

#[derive(Clone, Debug)]
struct Wall {
    kernel: Kernel,
}

impl Wall {
    /// 0 up to 1 m, NaN beyond, for the kernel that is asked for.
    fn hole<T: Scalar>(&self, kernel: Kernel, q: T) -> T {
        match self.kernel == kernel {
            true => (T::one() - q).sqrt() * T::zero(),
            false => T::zero(),
        }
    }
}

impl Declared<1, 1, 1, 0> for Wall {
    const NAME: &'static str = "wall";
    const COORDINATES: [&'static str; 1] = ["x"];
    const FREEDOMS: [&'static str; 1] = ["x"];
    const SPEEDS: [&'static str; 1] = ["x"];
    const VELOCITY_FRAME: VelocityFrame = VelocityFrame::Declared;

    fn home<T: Scalar>(&self) -> SVector<T, 1> {
        SVector::zeros()
    }
    fn pose<T: Scalar>(&self, q: &SVector<T, 1>) -> Pose<T> {
        let hole = self.hole(Kernel::Pose, q[0]);
        Pose::new(Matrix3::identity(), Vector3::new(q[0], hole, T::zero()))
    }
    fn twist_map<T: Scalar>(&self, q: &SVector<T, 1>) -> SMatrix<T, 6, 1> {
        let mut map = SMatrix::zeros();
        map[3] = T::one() + self.hole(Kernel::TwistMap, q[0]);
        map
    }
    fn retract<T: Scalar>(&self, q: &SVector<T, 1>, phi: &SVector<T, 1>) -> SVector<T, 1> {
        let moved = q + phi;
        moved.map(|x| x + self.hole(Kernel::Retract, x))
    }
    fn local<T: Scalar>(&self, q: &SVector<T, 1>, target: &SVector<T, 1>) -> SVector<T, 1> {
        target - q
    }
    fn speed_basis<T: Scalar>(&self, q: &SVector<T, 1>) -> SMatrix<T, 1, 1> {
        SMatrix::from_element(T::one() + self.hole(Kernel::SpeedBasis, q[0]))
    }
    fn constraint<T: Scalar>(&self, _q: &SVector<T, 1>) -> SMatrix<T, 1, 0> {
        SMatrix::zeros()
    }
    fn project<T: Scalar>(&self, q: &SVector<T, 1>) -> SVector<T, 1> {
        *q
    }
    fn residual<T: Scalar>(&self, _q: &SVector<T, 1>) -> T {
        T::zero()
    }
}
