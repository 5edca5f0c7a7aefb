//! How the efforts of elements at one joint change with its configuration and velocity.
//!
//! Springs on a manifold differentiate Φ twice, and rotors the kernel of γ: dual numbers through the joint's own kernels do it exactly.

use crate::erased::Sizes;
use crate::joint::Joint;
use crate::scalar::{Dual, Scalar};
use crate::spatial::vee;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

type D = Dual<f64>;

/// The joint's part in the derivatives of elements; slices have the joint's own sizes, results are K×K column by column.
pub trait ElementKernels {
    /// `∂τ/∂ϕ` at `q` of a [`JointSpring`](super::JointSpring) with this rest configuration and stiffness.
    fn spring_slope(&self, q: &[f64], rest: &[f64], stiffness: &[f64], out: &mut [f64]);

    /// `∂τ/∂ϕ` at `q` of a [`RotationSpring`](super::RotationSpring) with this rest rotation and stiffness.
    fn turn_slope(&self, q: &[f64], rest: &Matrix3<f64>, stiffness: f64, out: &mut [f64]);

    /// The derivatives in ϕ and in v of `Σ_k γ_k v_k (a v)`, the velocity term of rotors with inertias a.
    fn rotor_slopes(
        &self,
        q: &[f64],
        velocity: &[f64],
        inertia: &[f64],
        by_local: &mut [f64],
        by_velocity: &mut [f64],
    );
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> ElementKernels
    for (J, Sizes<N, K, S, C>)
where
    J: Joint<N, K, S, C>,
{
    fn spring_slope(&self, q: &[f64], rest: &[f64], stiffness: &[f64], out: &mut [f64]) {
        let joint = &self.0;
        let rest: SVector<D, N> = lift(rest);
        let stiffness = SMatrix::<f64, K, K>::from_row_slice(stiffness).map(Dual::constant);
        let slope: SMatrix<f64, K, K> = along(joint, q, |q| {
            let phi = joint.local(&rest, q);
            let mut rates = joint.velocity_map_inverse(q);
            for j in 0..K {
                let rate = rates.column(j).into_owned();
                rates.set_column(j, &joint.retract_differential_inverse(&rest, &phi, &rate));
            }
            -rates.tr_mul(&(stiffness * phi))
        });
        out.copy_from_slice(slope.as_slice());
    }

    fn turn_slope(&self, q: &[f64], rest: &Matrix3<f64>, stiffness: f64, out: &mut [f64]) {
        let joint = &self.0;
        let back = rest.transpose().map(Dual::constant);
        let slope: SMatrix<f64, K, K> = along(joint, q, |q| {
            let turn = joint.pose(q).rotation * back;
            let moment: Vector3<D> = vee(&turn) * D::from_f64(-stiffness);
            let map = joint.twist_map(q);
            map.fixed_rows::<3>(0).tr_mul(&moment)
        });
        out.copy_from_slice(slope.as_slice());
    }

    fn rotor_slopes(
        &self,
        q: &[f64],
        velocity: &[f64],
        inertia: &[f64],
        by_local: &mut [f64],
        by_velocity: &mut [f64],
    ) {
        let joint = &self.0;
        let velocity: SVector<D, K> = lift(velocity);
        let inertia: SVector<D, K> = lift(inertia);
        let force =
            |q: &SVector<D, N>, v: &SVector<D, K>| joint.gamma(q, v) * v.component_mul(&inertia);
        let slope: SMatrix<f64, K, K> = along(joint, q, |q| force(q, &velocity));
        by_local.copy_from_slice(slope.as_slice());
        let q: SVector<D, N> = lift(q);
        let slope = columns(|k| derivative(&force(&q, &(velocity + unit::<K>(k)))));
        by_velocity.copy_from_slice(slope.as_slice());
    }
}

fn lift<const R: usize>(values: &[f64]) -> SVector<D, R> {
    SVector::from_fn(|i, _| Dual::constant(values[i]))
}

/// The infinitesimal along axis `k`.
fn unit<const K: usize>(k: usize) -> SVector<D, K> {
    SVector::from_fn(|i, _| Dual::new(0.0, f64::from(u8::from(i == k))))
}

fn derivative<const R: usize>(vector: &SVector<D, R>) -> SVector<f64, R> {
    vector.map(|entry| entry.derivative)
}

fn columns<const K: usize>(column: impl FnMut(usize) -> SVector<f64, K>) -> SMatrix<f64, K, K> {
    let columns: [_; K] = core::array::from_fn(column);
    SMatrix::from_columns(&columns)
}

/// `∂f/∂ϕ` of a function of the configuration.
fn along<J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    q: &[f64],
    f: impl Fn(&SVector<D, N>) -> SVector<D, K>,
) -> SMatrix<f64, K, K>
where
    J: Joint<N, K, S, C>,
{
    let q = lift(q);
    columns(|k| derivative(&f(&joint.retract(&q, &unit(k)))))
}
