//! How the efforts of elements at one joint change with its configuration and velocity.
//!
//! Springs on a manifold differentiate Φ twice, and rotors the kernel of γ: dual numbers through the joint's own kernels do it exactly.

use super::directions::{along, columns, constant, derivative};
use crate::erased::nan;
use crate::joint::Joint;
use crate::scalar::{Dual, Scalar};
use crate::spatial::vee;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// `∂τ/∂ϕ` at `q` of a [`JointSpring`](crate::elements::JointSpring) with this `rest` configuration and stiffness, by rows.
pub(crate) fn spring_slope<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    (q, rest): (&SVector<T, N>, &SVector<T, N>),
    stiffness: &[T],
) -> SMatrix<T, K, K>
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    if stiffness.len() != K * K {
        return SMatrix::repeat(nan());
    }
    let rest = constant(rest);
    let stiffness = SMatrix::<T, K, K>::from_row_slice(stiffness).map(Dual::constant);
    slope(joint, q, |q| {
        let phi = joint.local(&rest, q);
        let mut rates = joint.velocity_map_inverse(q);
        for j in 0..K {
            let rate = rates.column(j).into_owned();
            rates.set_column(j, &joint.retract_differential_inverse(&rest, &phi, &rate));
        }
        -rates.tr_mul(&(stiffness * phi))
    })
}

/// `∂τ/∂ϕ` at `q` of a [`RotationSpring`](crate::elements::RotationSpring) with this `rest` rotation and stiffness.
pub(crate) fn turn_slope<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    q: &SVector<T, N>,
    rest: &Matrix3<T>,
    stiffness: T,
) -> SMatrix<T, K, K>
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    let back = rest.transpose().map(Dual::constant);
    slope(joint, q, |q| {
        let turn = joint.pose(q).rotation * back;
        let moment: Vector3<Dual<T>> = vee(&turn) * Dual::constant(-stiffness);
        joint.twist_map(q).fixed_rows::<3>(0).tr_mul(&moment)
    })
}

/// The derivatives in ϕ and in v of `Σ_k γ_k v_k (a v)`, the velocity term of rotors with inertias a.
pub(crate) fn rotor_slopes<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    q: &SVector<T, N>,
    velocity: &SVector<T, K>,
    inertia: &SVector<T, K>,
) -> [SMatrix<T, K, K>; 2]
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    let (velocity, inertia) = (constant(velocity), constant(inertia));
    let force = |q: &SVector<Dual<T>, N>, v: &SVector<Dual<T>, K>| {
        joint.gamma(q, v) * v.component_mul(&inertia)
    };
    let by_local = slope(joint, q, |q| force(q, &velocity));
    let q = constant(q);
    [
        by_local,
        columns(|k| derivative(&force(&q, &(velocity + along(k))))),
    ]
}

/// `∂f/∂ϕ` of a function of the configuration.
fn slope<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    q: &SVector<T, N>,
    f: impl Fn(&SVector<Dual<T>, N>) -> SVector<Dual<T>, K>,
) -> SMatrix<T, K, K>
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    let q = constant(q);
    columns(|k| derivative(&f(&joint.retract(&q, &along(k)))))
}
