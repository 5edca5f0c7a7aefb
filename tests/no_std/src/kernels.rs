//! Calls of all kernels. The suite of allocations includes this file too.

use hamel::joint::{Joint, Member, Products};
use hamel::nalgebra::{SMatrix, SVector};
use hamel::scalar::Scalar;

/// The sum over the joints of the library.
pub fn of_library<T: Scalar>(displacement: T) -> T {
    let mut sum = T::zero();
    macro_rules! add {
        ($module:ident, $joint:ty, $example:expr, $n:literal, $k:literal, $s:literal, $c:literal) => {
            sum += of_joint::<T, $joint, $n, $k, $s, $c>(&$example, displacement);
        };
    }
    hamel_joints::for_each_joint!(add);
    macro_rules! add_body {
        ($module:ident, $joint:ty, $example:expr, $b:literal, $n:literal, $k:literal, $s:literal, $c:literal) => {
            let body = Member::<$joint, $b>($example);
            sum += of_joint::<T, Member<$joint, $b>, $n, $k, $s, $c>(&body, displacement);
        };
    }
    hamel_joints::for_each_body!(add_body);
    sum
}

// In one function, all kernels of the library take the compiler minutes.
#[inline(never)]
fn of_joint<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    displacement: T,
) -> T
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    let phi = SVector::<T, K>::from_element(displacement);
    let speeds = SVector::<T, S>::from_element(displacement);
    let wrench = SVector::<T, 6>::from_element(displacement);
    let q = joint.project(&joint.retract(&joint.home(), &phi));
    let pose = joint.pose(&q);
    sum(&pose.rotation)
        + sum(&pose.translation)
        + sum(&joint.twist_map(&q))
        + sum(&joint.twist_map_child(&q))
        + sum_all(&joint.twist_map_child_gradient(&q))
        + sum(&joint.velocity_map(&q))
        + sum(&joint.velocity_map_inverse(&q))
        + sum_all(&joint.velocity_map_gradient(&q))
        + sum(&joint.gamma(&q, &phi))
        + sum(&joint.j22(&q, &phi))
        + sum(&joint.constraint(&q))
        + sum(&joint.speed_basis(&q))
        + sum_all(&joint.speed_basis_gradient(&q))
        + sum(&joint.configuration_rate(&q, &phi))
        + sum(&joint.local(&joint.home(), &q))
        + sum(&joint.retract_differential(&q, &phi))
        + sum(&joint.retract_differential_inverse(&q, &phi, &phi))
        + joint.residual(&q)
        + joint.singularity(&q)
        + sum(&joint.bias_acceleration(&q, &speeds))
        + sum(&joint.bias_momentum(&q, &speeds, &wrench))
        + sum(&joint.local_twist_map(&q))
        + sum(&joint.twist_gradient(&q, &speeds))
        + sum(&joint.effort_gradient(&q, &wrench))
        + sum(&joint.twist_map_rate(&q, &speeds))
        + sum(&joint.bias_acceleration_gradient(&q, &speeds))
        + sum(&joint.bias_acceleration_slope(&q, &speeds))
        + sum(&joint.bias_momentum_gradient(&q, &speeds, &wrench))
        + sum(&joint.bias_momentum_slope(&q, &wrench))
}

fn sum<T: Scalar, const R: usize, const M: usize>(m: &SMatrix<T, R, M>) -> T {
    m.iter().fold(T::zero(), |sum, entry| sum + *entry)
}

fn sum_all<T: Scalar, const R: usize, const M: usize, const K: usize>(
    slices: &[SMatrix<T, R, M>; K],
) -> T {
    slices
        .iter()
        .fold(T::zero(), |total, slice| total + sum(slice))
}
