//! Plane motions as 2×3 matrices [R p]: 6 stored scalars; ϕ = (turn; displacement) in child axes, 3 numbers.

use super::parts::{moved, product, transposed_product};
use super::so2;
use crate::scalar::Scalar;
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3, Vector6};

/// Q exp(ϕ): `R exp(θ)` and `p + R (c₁ ρ + c₂ θ J ρ)` for ϕ = (θ; ρ), with J the quarter turn.
#[inline]
pub fn times_exp<T: Scalar>(q: &Vector6<T>, phi: &Vector3<T>) -> Vector6<T> {
    let (rotation, translation) = matrices(q);
    let (theta, rho) = (phi[0], Vector2::new(phi[1], phi[2]));
    let square = theta * theta;
    let c1 = square.stumpff(1);
    let theta_c2 = theta * square.stumpff(2);
    let turned = so2::rotation(T::one() - theta * theta_c2, theta * c1);
    let displaced = product(&so2::rotation(c1, theta_c2), &rho);
    stored(
        &product(&rotation, &turned),
        &moved(&rotation, &displaced, &translation),
    )
}

/// The ϕ with Q exp(ϕ) = Q′, turned by at most π: `ρ = (θ/2) cot(θ/2) t − (θ/2) J t` with `t = Rᵀ (p′ − p)`.
#[inline]
pub fn log_between<T: Scalar>(q: &Vector6<T>, target: &Vector6<T>) -> Vector3<T> {
    let (rotation, translation) = matrices(q);
    let (turned, displaced) = matrices(target);
    let theta = so2::angle_to(&rotation, &turned.column(0).into_owned());
    let t = transposed_product(&rotation, &(displaced - translation));
    let square = theta * theta;
    let half_cotangent = T::one() - square * square.dexp_inverse(0);
    let half_angle = theta * T::from_f64(0.5);
    let rho = product(&so2::rotation(half_cotangent, -half_angle), &t);
    Vector3::new(theta, rho[0], rho[1])
}

/// Q̇ at the velocity `v` = (ω; u): `R ω^` and `R u`.
#[inline]
pub fn rate<T: Scalar>(q: &Vector6<T>, v: &Vector3<T>) -> Vector6<T> {
    let (rotation, _) = matrices(q);
    let moved = product(&rotation, &Vector2::new(v[1], v[2]));
    let turned = rotation * v[0];
    let columns = [turned.column(1).into_owned(), -turned.column(0)];
    stored(&Matrix2::from_columns(&columns), &moved)
}

/// D at ϕ = (θ; ρ): `I − c₂ ad + c₃ ad²`.
#[inline]
pub fn differential<T: Scalar>(phi: &Vector3<T>) -> Matrix3<T> {
    let (theta, x, y) = (phi[0], phi[1], phi[2]);
    let (zero, one) = (T::zero(), T::one());
    let square = theta * theta;
    let (c2, theta_c3) = (square.stumpff(2), theta * square.stumpff(3));
    let (diagonal, theta_c2) = (one - theta * theta_c3, theta * c2);
    let first = Vector2::new(x * theta_c3 - y * c2, x * c2 + y * theta_c3);
    Matrix3::new(
        one, zero, zero, first[0], diagonal, theta_c2, first[1], -theta_c2, diagonal,
    )
}

/// `D⁻¹ rate = rate + ½ [ϕ, rate] + G(θ²) [ϕ, [ϕ, rate]]`, for |θ| < 2π.
#[inline]
pub fn differential_inverse<T: Scalar>(phi: &Vector3<T>, rate: &Vector3<T>) -> Vector3<T> {
    let (theta, half) = (phi[0], T::from_f64(0.5));
    let g = (theta * theta).dexp_inverse(0);
    let bracket = Vector2::new(
        phi[2] * rate[0] - theta * rate[2],
        theta * rate[1] - phi[1] * rate[0],
    );
    Vector3::new(
        rate[0],
        half.mul_add(bracket[0], g.mul_add(-theta * bracket[1], rate[1])),
        half.mul_add(bracket[1], g.mul_add(theta * bracket[0], rate[2])),
    )
}

/// The motion nearest to `q`.
#[inline]
pub fn nearest<T: Scalar>(q: &Vector6<T>) -> Vector6<T> {
    let (rotation, translation) = matrices(q);
    stored(&so2::nearest_matrix(&rotation), &translation)
}

/// Sum of the squares of the relations of [`so2`](super::so2::residual_squared).
#[inline]
pub fn residual_squared<T: Scalar>(q: &Vector6<T>) -> T {
    so2::matrix_residual_squared(&matrices(q).0)
}

#[inline]
fn matrices<T: Scalar>(q: &Vector6<T>) -> (Matrix2<T>, Vector2<T>) {
    let rotation = Matrix2::new(q[0], q[1], q[3], q[4]);
    (rotation, Vector2::new(q[2], q[5]))
}

#[inline]
fn stored<T: Scalar>(r: &Matrix2<T>, p: &Vector2<T>) -> Vector6<T> {
    Vector6::new(r[(0, 0)], r[(0, 1)], p[0], r[(1, 0)], r[(1, 1)], p[1])
}
