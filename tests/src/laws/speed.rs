//! Laws of S̄, A and the kernels in minimal velocities.

use super::dual::{constant, moving, slopes, unit};
use super::{At, D1, close};
use hamel::joint::{Joint, Products};
use hamel::nalgebra::{SMatrix, SVector, Vector6};

impl<J: Joint<N, K, S, C>, const N: usize, const K: usize, const S: usize, const C: usize>
    At<'_, J, N, K, S, C>
{
    /// Laws of the constraint and of the speeds.
    pub(super) fn speed_laws(&self, speeds: &SVector<f64, S>, wrench: &Vector6<f64>) {
        let (joint, q) = (self.joint, &self.q);
        let basis = joint.speed_basis(q);
        close(
            "Aᵀ S̄ = 0",
            self.joint.facts().name,
            &joint.constraint(q).tr_mul(&basis),
            &SMatrix::zeros(),
        );
        let gradient = joint.speed_basis_gradient(q);
        for (k, slice) in gradient.iter().enumerate() {
            close(
                "∂S̄/∂ϕ",
                self.joint.facts().name,
                &slopes(&joint.speed_basis(&self.along(&unit(k)))),
                slice,
            );
        }
        let moved = self.along(&(joint.velocity_map_inverse(q) * basis * speeds));
        let rate = slopes(&(joint.twist_map_child(&moved) * joint.speed_basis(&moved)));
        close(
            "c = Ẋ̄^c v̄",
            self.joint.facts().name,
            &joint.bias_acceleration(q, speeds),
            &(rate * speeds),
        );
        close(
            "Ẋ̄^cᵀ h",
            self.joint.facts().name,
            &joint.bias_momentum(q, speeds, wrench),
            &rate.tr_mul(wrench),
        );
        close(
            "Ẋ̄^c",
            self.joint.facts().name,
            &joint.twist_map_rate(q, speeds),
            &rate,
        );
        close(
            "c by products",
            self.joint.facts().name,
            &joint.bias_acceleration_by_products(q, speeds),
            &(rate * speeds),
        );
        close(
            "Ẋ̄^cᵀ h by products",
            self.joint.facts().name,
            &joint.bias_momentum_by_products(q, speeds, wrench),
            &rate.tr_mul(wrench),
        );
        self.gradient_laws(speeds, wrench);
        self.slope_laws(speeds, wrench);
    }

    /// Derivatives along ϕ of X̄^c v̄, of c and of their duals.
    pub(super) fn gradient_laws(&self, speeds: &SVector<f64, S>, wrench: &Vector6<f64>) {
        let (joint, q) = (self.joint, &self.q);
        let local = joint.local_twist_map(q);
        let of_twist = joint.twist_gradient(q, speeds);
        let of_effort = joint.effort_gradient(q, wrench);
        let of_bias = joint.bias_acceleration_gradient(q, speeds);
        let of_momentum = joint.bias_momentum_gradient(q, speeds, wrench);
        let product = joint.twist_map_child(q) * joint.velocity_map(q);
        close("X^c S₀", self.joint.facts().name, &local, &product);
        for k in 0..K {
            let moved = self.along(&unit(k));
            let (v, h) = (constant(speeds), constant(wrench));
            let map = joint.twist_map_child(&moved) * joint.speed_basis(&moved);
            let check = |law: &str, got: &[f64], expected: &[D1]| {
                for (got, expected) in got.iter().zip(expected) {
                    let got = SVector::<f64, 1>::new(*got);
                    close(
                        law,
                        self.joint.facts().name,
                        &got,
                        &SVector::<f64, 1>::new(expected.derivative()),
                    );
                }
            };
            let column = of_twist.column(k);
            check("∂(X̄^c v̄)/∂ϕ", column.as_slice(), (map * v).as_slice());
            let column = of_effort.column(k);
            check("∂(X̄^cᵀ h)/∂ϕ", column.as_slice(), map.tr_mul(&h).as_slice());
            let bias = joint.bias_acceleration(&moved, &v);
            check("∂c/∂ϕ", of_bias.column(k).as_slice(), bias.as_slice());
            let dual = joint.bias_momentum(&moved, &v, &h);
            let column = of_momentum.column(k);
            check("∂(Ẋ̄^cᵀ h)/∂ϕ", column.as_slice(), dual.as_slice());
        }
    }

    /// Derivatives of c and of its dual by the speeds.
    pub(super) fn slope_laws(&self, speeds: &SVector<f64, S>, wrench: &Vector6<f64>) {
        let (joint, q) = (self.joint, constant(&self.q));
        let of_bias = joint.bias_acceleration_slope(&self.q, speeds);
        let of_momentum = joint.bias_momentum_slope(&self.q, wrench);
        for a in 0..S {
            let faster = moving(speeds, &unit(a));
            close(
                "∂c/∂v̄",
                self.joint.facts().name,
                &of_bias.column(a).into_owned(),
                &slopes(&joint.bias_acceleration(&q, &faster)),
            );
            close(
                "∂(Ẋ̄^cᵀ h)/∂v̄",
                self.joint.facts().name,
                &of_momentum.column(a).into_owned(),
                &slopes(&joint.bias_momentum(&q, &faster, &constant(wrench))),
            );
        }
    }
}
