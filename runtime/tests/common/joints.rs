//! Six joints by hand: a path joint, two Lie groups in either velocity frame, a declared X, and two nonholonomic ones.

use super::derived::{Declared, Derived};
use hamel_runtime::erased::{AnyJoint, erase};
use hamel_runtime::joint::{VelocityFrame, from_rows};
use hamel_runtime::scalar::Scalar;
use hamel_runtime::spatial::{Pose, so3};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use std::sync::Arc;

pub fn revolute() -> Arc<dyn AnyJoint> {
    erase(Derived(Revolute))
}

pub fn ball() -> Arc<dyn AnyJoint> {
    erase(Derived(Ball))
}

pub fn planar() -> Arc<dyn AnyJoint> {
    erase(Derived(Planar))
}

pub fn planar_euclidean() -> Arc<dyn AnyJoint> {
    erase(Derived(PlanarEuclidean))
}

pub fn cart() -> Arc<dyn AnyJoint> {
    erase(Derived(Cart))
}

pub fn drift() -> Arc<dyn AnyJoint> {
    erase(Derived(Drift))
}

fn turn<T: Scalar>(angle: T) -> Matrix3<T> {
    so3::exp(&Vector3::new(T::zero(), T::zero(), angle))
}

/// An angle about z.
#[derive(Clone, Debug)]
pub struct Revolute;

impl Declared<1, 1, 1, 0> for Revolute {
    const NAME: &'static str = "revolute";
    const COORDINATES: [&'static str; 1] = ["angle"];
    const FREEDOMS: [&'static str; 1] = ["turn"];
    const SPEEDS: [&'static str; 1] = ["turn"];
    const VELOCITY_FRAME: VelocityFrame = VelocityFrame::Declared;

    fn home<T: Scalar>(&self) -> SVector<T, 1> {
        SVector::zeros()
    }
    fn pose<T: Scalar>(&self, q: &SVector<T, 1>) -> Pose<T> {
        Pose::from_rotation(turn(q[0]))
    }
    fn twist_map<T: Scalar>(&self, _q: &SVector<T, 1>) -> SMatrix<T, 6, 1> {
        SMatrix::from_fn(|i, _| if i == 2 { T::one() } else { T::zero() })
    }
    fn retract<T: Scalar>(&self, q: &SVector<T, 1>, phi: &SVector<T, 1>) -> SVector<T, 1> {
        q + phi
    }
    fn local<T: Scalar>(&self, q: &SVector<T, 1>, target: &SVector<T, 1>) -> SVector<T, 1> {
        target - q
    }
    fn speed_basis<T: Scalar>(&self, _q: &SVector<T, 1>) -> SMatrix<T, 1, 1> {
        SMatrix::identity()
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

/// Example 1: a rotation matrix row by row, velocity in parent axes.
#[derive(Clone, Debug)]
pub struct Ball;

fn matrix_of<T: Scalar>(q: &SVector<T, 9>) -> Matrix3<T> {
    Matrix3::from_fn(|i, j| q[3 * i + j])
}

fn rows_of<T: Scalar>(rotation: &Matrix3<T>) -> SVector<T, 9> {
    SVector::from_fn(|n, _| rotation[(n / 3, n % 3)])
}

/// A Newton step towards the nearest rotation: exact to rounding when the error is already small.
fn orthonormalised<T: Scalar>(rotation: &Matrix3<T>) -> Matrix3<T> {
    let gram = rotation.transpose() * rotation;
    let correction = Matrix3::identity() * T::from_f64(1.5) - gram * T::from_f64(0.5);
    rotation * correction
}

impl Declared<9, 3, 3, 0> for Ball {
    const NAME: &'static str = "ball";
    const COORDINATES: [&'static str; 9] = [
        "q11", "q12", "q13", "q21", "q22", "q23", "q31", "q32", "q33",
    ];
    const FREEDOMS: [&'static str; 3] = ["e1", "e2", "e3"];
    const SPEEDS: [&'static str; 3] = ["e1", "e2", "e3"];
    const VELOCITY_FRAME: VelocityFrame = VelocityFrame::Parent;

    fn home<T: Scalar>(&self) -> SVector<T, 9> {
        rows_of(&Matrix3::identity())
    }
    fn pose<T: Scalar>(&self, q: &SVector<T, 9>) -> Pose<T> {
        Pose::from_rotation(matrix_of(q))
    }
    fn twist_map<T: Scalar>(&self, _q: &SVector<T, 9>) -> SMatrix<T, 6, 3> {
        SMatrix::identity()
    }
    fn retract<T: Scalar>(&self, q: &SVector<T, 9>, phi: &SVector<T, 3>) -> SVector<T, 9> {
        rows_of(&(matrix_of(q) * so3::exp(phi)))
    }
    fn local<T: Scalar>(&self, q: &SVector<T, 9>, target: &SVector<T, 9>) -> SVector<T, 3> {
        so3::log(&(matrix_of(q).transpose() * matrix_of(target)))
    }
    fn speed_basis<T: Scalar>(&self, _q: &SVector<T, 9>) -> SMatrix<T, 3, 3> {
        SMatrix::identity()
    }
    fn constraint<T: Scalar>(&self, _q: &SVector<T, 9>) -> SMatrix<T, 3, 0> {
        SMatrix::zeros()
    }
    fn project<T: Scalar>(&self, q: &SVector<T, 9>) -> SVector<T, 9> {
        rows_of(&orthonormalised(&matrix_of(q)))
    }
    fn residual<T: Scalar>(&self, q: &SVector<T, 9>) -> T {
        let rotation = matrix_of(q);
        let error = rotation.transpose() * rotation - Matrix3::identity();
        error
            .iter()
            .fold(T::zero(), |sum, &entry| sum + entry * entry)
            .sqrt()
    }
}

fn plane_pose<T: Scalar>(q: &SVector<T, 6>) -> Pose<T> {
    let (zero, one) = (T::zero(), T::one());
    Pose::new(
        from_rows([[q[0], q[1], zero], [q[3], q[4], zero], [zero, zero, one]]),
        Vector3::new(q[2], q[5], zero),
    )
}

/// Q exp(Σ bᵢϕᵢ) on SE(2).
fn plane_retract<T: Scalar>(q: &SVector<T, 6>, phi: &SVector<T, 3>) -> SVector<T, 6> {
    let r = Vector3::new(T::zero(), T::zero(), phi[0]);
    let shift = so3::left_jacobian(&r) * Vector3::new(phi[1], phi[2], T::zero());
    let moved = plane_pose(q) * Pose::new(so3::exp(&r), shift);
    let (rotation, origin) = (moved.rotation, moved.translation);
    SVector::from([
        rotation[(0, 0)],
        rotation[(0, 1)],
        origin.x,
        rotation[(1, 0)],
        rotation[(1, 1)],
        origin.y,
    ])
}

fn plane_local<T: Scalar>(q: &SVector<T, 6>, target: &SVector<T, 6>) -> SVector<T, 3> {
    let twist = hamel_runtime::spatial::se3::log(&(plane_pose(q).inverse() * plane_pose(target)));
    Vector3::new(twist[2], twist[3], twist[4])
}

fn plane_twist_map<T: Scalar>(q: &SVector<T, 6>) -> SMatrix<T, 6, 3> {
    let child = SMatrix::from_fn(|i, j| if i == j + 2 { T::one() } else { T::zero() });
    plane_pose(q).act_twist_columns(&child)
}

fn plane_residual<T: Scalar>(q: &SVector<T, 6>) -> T {
    let error = [
        q[0] * q[0] + q[3] * q[3] - T::one(),
        q[0] - q[4],
        q[1] + q[3],
    ];
    error
        .iter()
        .fold(T::zero(), |sum, &entry| sum + entry * entry)
        .sqrt()
}

fn plane_project<T: Scalar>(q: &SVector<T, 6>) -> SVector<T, 6> {
    let (cos, sin) = (q[0] + q[4], q[3] - q[1]);
    let norm = (cos * cos + sin * sin).sqrt();
    let (cos, sin) = (cos / norm, sin / norm);
    SVector::from([cos, -sin, q[2], sin, cos, q[5]])
}

macro_rules! on_se2 {
    ($joint:ident, $name:literal, $speeds:literal, $constraints:literal, $speed_names:expr) => {
        impl Declared<6, 3, $speeds, $constraints> for $joint {
            const NAME: &'static str = $name;
            const COORDINATES: [&'static str; 6] = ["q11", "q12", "q13", "q21", "q22", "q23"];
            const FREEDOMS: [&'static str; 3] = ["turn", "forward", "sideways"];
            const SPEEDS: [&'static str; $speeds] = $speed_names;
            const VELOCITY_FRAME: VelocityFrame = VelocityFrame::Child;

            fn home<T: Scalar>(&self) -> SVector<T, 6> {
                SVector::from([1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(T::from_f64))
            }
            fn pose<T: Scalar>(&self, q: &SVector<T, 6>) -> Pose<T> {
                plane_pose(q)
            }
            fn twist_map<T: Scalar>(&self, q: &SVector<T, 6>) -> SMatrix<T, 6, 3> {
                plane_twist_map(q)
            }
            fn retract<T: Scalar>(&self, q: &SVector<T, 6>, phi: &SVector<T, 3>) -> SVector<T, 6> {
                plane_retract(q, phi)
            }
            fn local<T: Scalar>(&self, q: &SVector<T, 6>, target: &SVector<T, 6>) -> SVector<T, 3> {
                plane_local(q, target)
            }
            fn speed_basis<T: Scalar>(&self, _q: &SVector<T, 6>) -> SMatrix<T, 3, $speeds> {
                SMatrix::identity()
            }
            fn constraint<T: Scalar>(&self, _q: &SVector<T, 6>) -> SMatrix<T, 3, $constraints> {
                SMatrix::from_fn(|i, j| {
                    if i == j + $speeds {
                        T::one()
                    } else {
                        T::zero()
                    }
                })
            }
            fn project<T: Scalar>(&self, q: &SVector<T, 6>) -> SVector<T, 6> {
                plane_project(q)
            }
            fn residual<T: Scalar>(&self, q: &SVector<T, 6>) -> T {
                plane_residual(q)
            }
        }
    };
}

/// Example 2: SE(2), velocity in child axes.
#[derive(Clone, Debug)]
pub struct Planar;

/// Examples 3 and 6: the same without sideways velocity.
#[derive(Clone, Debug)]
pub struct Cart;

on_se2!(Planar, "planar", 3, 0, ["turn", "forward", "sideways"]);
on_se2!(Cart, "cart", 2, 1, ["turn", "forward"]);

fn euclidean_pose<T: Scalar>(q: &SVector<T, 3>) -> Pose<T> {
    Pose::new(turn(q[0]), Vector3::new(q[1], q[2], T::zero()))
}

/// v = (θ̇, ẋ, ẏ): the linear part is that of the moving origin, not of the point at the parent's origin.
fn euclidean_twist_map<T: Scalar>(q: &SVector<T, 3>) -> SMatrix<T, 6, 3> {
    let (zero, one) = (T::zero(), T::one());
    from_rows([
        [zero, zero, zero],
        [zero, zero, zero],
        [one, zero, zero],
        [q[2], one, zero],
        [-q[1], zero, one],
        [zero, zero, zero],
    ])
}

macro_rules! on_angle_and_position {
    ($joint:ident, $name:literal, $speeds:literal, $constraints:literal, $speed_names:expr, $basis:expr, $constraint:expr) => {
        impl Declared<3, 3, $speeds, $constraints> for $joint {
            const NAME: &'static str = $name;
            const COORDINATES: [&'static str; 3] = ["angle", "x", "y"];
            const FREEDOMS: [&'static str; 3] = ["angle", "x", "y"];
            const SPEEDS: [&'static str; $speeds] = $speed_names;
            const VELOCITY_FRAME: VelocityFrame = VelocityFrame::Declared;

            fn home<T: Scalar>(&self) -> SVector<T, 3> {
                SVector::zeros()
            }
            fn pose<T: Scalar>(&self, q: &SVector<T, 3>) -> Pose<T> {
                euclidean_pose(q)
            }
            fn twist_map<T: Scalar>(&self, q: &SVector<T, 3>) -> SMatrix<T, 6, 3> {
                euclidean_twist_map(q)
            }
            fn retract<T: Scalar>(&self, q: &SVector<T, 3>, phi: &SVector<T, 3>) -> SVector<T, 3> {
                q + phi
            }
            fn local<T: Scalar>(&self, q: &SVector<T, 3>, target: &SVector<T, 3>) -> SVector<T, 3> {
                target - q
            }
            fn speed_basis<T: Scalar>(&self, q: &SVector<T, 3>) -> SMatrix<T, 3, $speeds> {
                $basis(q)
            }
            fn constraint<T: Scalar>(&self, q: &SVector<T, 3>) -> SMatrix<T, 3, $constraints> {
                $constraint(q)
            }
            fn project<T: Scalar>(&self, q: &SVector<T, 3>) -> SVector<T, 3> {
                *q
            }
            fn residual<T: Scalar>(&self, _q: &SVector<T, 3>) -> T {
                T::zero()
            }
        }
    };
}

/// The Euclidean set of Example 2's note.
#[derive(Clone, Debug)]
pub struct PlanarEuclidean;

/// The same with `ẏ = x θ̇`: a constraint whose A, S̄ and X S̄ all vary.
#[derive(Clone, Debug)]
pub struct Drift;

on_angle_and_position!(
    PlanarEuclidean,
    "planar_euclidean",
    3,
    0,
    ["angle", "x", "y"],
    |_| SMatrix::identity(),
    |_| SMatrix::zeros()
);
on_angle_and_position!(
    Drift,
    "drift",
    2,
    1,
    ["angle", "x"],
    |q: &SVector<T, 3>| from_rows([
        [T::one(), T::zero()],
        [T::zero(), T::one()],
        [q[1], T::zero()]
    ]),
    |q: &SVector<T, 3>| from_rows([[-q[1]], [T::zero()], [T::one()]])
);
