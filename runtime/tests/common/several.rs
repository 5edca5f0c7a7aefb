//! Joints that carry two bodies each, by hand: a linkage of two degrees of freedom, a wheel that rolls beside its carriage, and two pairs of joints in
//! series.

use super::derived::{Declared, DeclaredSecond, Derived, twists_of_rates};
use hamel_runtime::erased::{AnyJoint, Shared, erase};
use hamel_runtime::joint::{Link, LinkMotion, Member, Port, VelocityFrame, coupled, from_rows};
use hamel_runtime::scalar::Scalar;
use hamel_runtime::spatial::{Pose, so3};
use nalgebra::{SMatrix, SVector, Vector3};
use std::sync::Arc;

pub fn linkage() -> Arc<dyn AnyJoint> {
    erase(Derived(Linkage))
}

pub fn carriage() -> Arc<dyn AnyJoint> {
    erase(Derived(Carriage))
}

/// Two turns in series.
pub fn arms() -> Arc<dyn AnyJoint> {
    erase(Derived(Arms))
}

/// [`joints::drift`](super::joints::drift), and a turn in series with it.
pub fn drifter() -> Arc<dyn AnyJoint> {
    erase(Derived(Drifter))
}

/// [`Arms`] as links of a coupling that both move by themselves.
pub fn links() -> Arc<dyn AnyJoint> {
    let link = |number: usize| Link {
        before: number.checked_sub(1),
        frame: if number == 0 {
            Pose::identity()
        } else {
            between()
        },
        motion: LinkMotion::Turn,
        coordinate: number,
        ratio: 1.0,
        offset: 0.0,
    };
    const PORTS: [Port; 2] = [port("first"), port("second")];
    coupled(&[link(0), link(1)], &PORTS).expect("links of a joint")
}

const fn port(name: &'static str) -> Port {
    Port {
        name,
        unit: "rad",
        wraps: false,
    }
}

/// Where the second joint of a pair stands in the child frame of the first.
pub fn between<T: Scalar>() -> Pose<T> {
    let number = T::from_f64;
    Pose::new(
        rotation(number(0.4), number(-0.2), number(0.1)),
        Vector3::new(number(0.7), number(0.2), number(-0.3)),
    )
}

fn rotation<T: Scalar>(x: T, y: T, z: T) -> nalgebra::Matrix3<T> {
    so3::exp(&Vector3::new(x, y, z))
}

/// Two turns in series.
#[derive(Clone, Debug)]
pub struct Arms;

/// A drifting body, and another that turns on it.
#[derive(Clone, Debug)]
pub struct Drifter;

/// Two bodies, both of which move with both coordinates, neither in all the ways of the other.
#[derive(Clone, Debug)]
pub struct Linkage;

/// A carriage in a plane, and a wheel of radius 0.3 at its side that rolls without slip.
#[derive(Clone, Debug)]
pub struct Carriage;

const RADIUS: f64 = 0.3;

macro_rules! by_rates {
    ($joint:ident, $name:literal, $k:literal, $s:literal, $c:literal, $coordinates:expr, $speeds:expr, $bodies:expr, $basis:expr, $constraint:expr, $first:expr, $second:expr) => {
        impl Declared<$k, $k, $s, $c> for $joint {
            const NAME: &'static str = $name;
            const COORDINATES: [&'static str; $k] = $coordinates;
            const FREEDOMS: [&'static str; $k] = $coordinates;
            const SPEEDS: [&'static str; $s] = $speeds;
            const VELOCITY_FRAME: VelocityFrame = VelocityFrame::Declared;
            const BODIES: &'static [&'static str] = &$bodies;

            fn more(&self, visit: &mut dyn FnMut(Shared)) {
                visit(erase(Member::<_, 1>(Derived(self.clone()))));
            }
            fn velocity_map_at<T: Scalar>(
                &self,
                _q: &SVector<T, $k>,
                _phi: &SVector<T, $k>,
            ) -> SMatrix<T, $k, $k> {
                SMatrix::identity()
            }
            fn home<T: Scalar>(&self) -> SVector<T, $k> {
                SVector::zeros()
            }
            fn pose<T: Scalar>(&self, q: &SVector<T, $k>) -> Pose<T> {
                $first(q)
            }
            fn twist_map<T: Scalar>(&self, q: &SVector<T, $k>) -> SMatrix<T, 6, $k> {
                twists_of_rates(q, |q| $first(q))
            }
            fn retract<T: Scalar>(
                &self,
                q: &SVector<T, $k>,
                phi: &SVector<T, $k>,
            ) -> SVector<T, $k> {
                q + phi
            }
            fn local<T: Scalar>(
                &self,
                q: &SVector<T, $k>,
                target: &SVector<T, $k>,
            ) -> SVector<T, $k> {
                target - q
            }
            fn speed_basis<T: Scalar>(&self, q: &SVector<T, $k>) -> SMatrix<T, $k, $s> {
                $basis(q)
            }
            fn constraint<T: Scalar>(&self, q: &SVector<T, $k>) -> SMatrix<T, $k, $c> {
                $constraint(q)
            }
            fn project<T: Scalar>(&self, q: &SVector<T, $k>) -> SVector<T, $k> {
                *q
            }
            fn residual<T: Scalar>(&self, _q: &SVector<T, $k>) -> T {
                T::zero()
            }
        }

        impl DeclaredSecond<$k, $k, $s, $c> for $joint {
            fn second_pose<T: Scalar>(&self, q: &SVector<T, $k>) -> Pose<T> {
                $second(q)
            }
            fn second_twist_map<T: Scalar>(&self, q: &SVector<T, $k>) -> SMatrix<T, 6, $k> {
                twists_of_rates(q, |q| $second(q))
            }
        }
    };
}

fn linkage_first<T: Scalar>(q: &SVector<T, 2>) -> Pose<T> {
    let half = T::from_f64(0.5);
    Pose::new(
        rotation(T::zero(), half * q[1], q[0]),
        Vector3::new(q[0].sin_cos().0, half * q[1], q[0] * q[1] * half),
    )
}

fn linkage_second<T: Scalar>(q: &SVector<T, 2>) -> Pose<T> {
    Pose::new(
        rotation(q[0] * q[1], T::zero(), q[1] - q[0]),
        Vector3::new(T::one(), q[1].sin_cos().1, q[0]),
    )
}

by_rates!(
    Linkage,
    "linkage",
    2,
    2,
    0,
    ["a", "b"],
    ["a", "b"],
    ["first", "second"],
    |_: &SVector<T, 2>| SMatrix::identity(),
    |_: &SVector<T, 2>| SMatrix::zeros(),
    linkage_first,
    linkage_second
);

fn carriage_pose<T: Scalar>(q: &SVector<T, 4>) -> Pose<T> {
    Pose::new(
        rotation(T::zero(), T::zero(), q[0]),
        Vector3::new(q[1], q[2], T::zero()),
    )
}

fn wheel_pose<T: Scalar>(q: &SVector<T, 4>) -> Pose<T> {
    let side = Vector3::new(T::zero(), T::from_f64(0.4), T::from_f64(RADIUS));
    carriage_pose(q) * Pose::new(rotation(T::zero(), q[3], T::zero()), side)
}

by_rates!(
    Carriage,
    "carriage",
    4,
    2,
    2,
    ["turn", "x", "y", "wheel"],
    ["turning", "forward"],
    ["frame", "wheel"],
    |q: &SVector<T, 4>| {
        let (zero, one) = (T::zero(), T::one());
        let (s, c) = q[0].sin_cos();
        let inverse = T::from_f64(1.0 / RADIUS);
        from_rows([
            [one, zero],
            [zero, c],
            [zero, s],
            [T::from_f64(-0.4) * inverse, inverse],
        ])
    },
    |q: &SVector<T, 4>| {
        let (zero, one) = (T::zero(), T::one());
        let (s, c) = q[0].sin_cos();
        from_rows([
            [zero, T::from_f64(-0.4)],
            [-s, c],
            [c, s],
            [zero, T::from_f64(-RADIUS) * one],
        ])
    },
    carriage_pose,
    wheel_pose
);

fn turned<T: Scalar>(angle: T) -> Pose<T> {
    Pose::from_rotation(rotation(T::zero(), T::zero(), angle))
}

by_rates!(
    Arms,
    "arms",
    2,
    2,
    0,
    ["upper", "lower"],
    ["upper", "lower"],
    ["upper", "lower"],
    |_: &SVector<T, 2>| SMatrix::identity(),
    |_: &SVector<T, 2>| SMatrix::zeros(),
    |q: &SVector<_, 2>| turned(q[0]),
    |q: &SVector<_, 2>| turned(q[0]) * between() * turned(q[1])
);

by_rates!(
    Drifter,
    "drifter",
    4,
    3,
    1,
    ["angle", "x", "y", "arm"],
    ["angle", "x", "arm"],
    ["drifter", "arm"],
    |q: &SVector<T, 4>| {
        let (zero, one) = (T::zero(), T::one());
        from_rows([
            [one, zero, zero],
            [zero, one, zero],
            [q[1], zero, zero],
            [zero, zero, one],
        ])
    },
    |q: &SVector<T, 4>| from_rows([[-q[1]], [T::zero()], [T::one()], [T::zero()]]),
    carriage_pose,
    |q: &SVector<_, 4>| carriage_pose(q) * between() * turned(q[3])
);
