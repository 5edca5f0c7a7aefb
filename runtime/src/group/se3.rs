//! Spatial motions as 3×4 matrices [R p]: 12 stored scalars; ϕ = (rotation vector; displacement) in child axes, 6 numbers.

use super::parts::{moved, product, squared, transposed_product};
use super::so3::{matrix_residual_squared, turned};
use crate::scalar::Scalar;
use crate::spatial::{hat, join, so3, split};
use nalgebra::{Matrix3, Matrix6, SVector, Vector3, Vector6};

/// Q exp(ϕ): `R exp(ω~)` and `p + R (ρ + c₂ ω × ρ + c₃ ω × (ω × ρ))` for ϕ = (ω; ρ).
#[inline]
pub fn times_exp<T: Scalar>(q: &SVector<T, 12>, phi: &Vector6<T>) -> SVector<T, 12> {
    let (rotation, translation) = matrices(q);
    let (omega, rho) = split(phi);
    let square = squared(&omega);
    let (c2, c3) = (square.stumpff(2), square.stumpff(3));
    let c1 = T::one() - c3 * square;
    let once = omega.cross(&rho);
    let displaced = rho + once * c2 + omega.cross(&once) * c3;
    stored(
        &product(&rotation, &so3::quadratic(&omega, c1, c2)),
        &moved(&rotation, &displaced, &translation),
    )
}

/// The ϕ with Q exp(ϕ) = Q′, |ω| ≤ π: ω of `RᵀR′`, and `ρ = t − ½ ω × t + G(ω²) ω × (ω × t)` with `t = Rᵀ (p′ − p)`.
#[inline]
pub fn log_between<T: Scalar>(q: &SVector<T, 12>, target: &SVector<T, 12>) -> Vector6<T> {
    let (rotation, translation) = matrices(q);
    let (turned, displaced) = matrices(target);
    let omega = so3::log(&transposed_product(&rotation, &turned));
    let t = transposed_product(&rotation, &(displaced - translation));
    let g = squared(&omega).dexp_inverse(0);
    let once = omega.cross(&t);
    let rho = t - once * T::from_f64(0.5) + omega.cross(&once) * g;
    join(&omega, &rho)
}

/// Q̇ at the velocity `v` = (ω; u) in child axes: `R ω~` and `R u`.
#[inline]
pub fn rate<T: Scalar>(q: &SVector<T, 12>, v: &Vector6<T>) -> SVector<T, 12> {
    let (rotation, _) = matrices(q);
    let (omega, linear) = split(v);
    stored(&turned(&rotation, &omega), &product(&rotation, &linear))
}

/// D at ϕ = (ω; ρ): `I − c₂ ad + c₃ ad²` and the change of c₂, c₃ with ω along ρ:
///
/// ```text
/// D = [J 0; L J],  J = I − c₂ ω~ + c₃ ω~²
/// L = −c₂ ρ~ + c₃ (ω~ρ~ + ρ~ω~) − 2 (ω·ρ) (c₂′ ω~ − c₃′ ω~²),  c₂′ = c₄ − ½ c₃,  c₃′ = ½ (3 c₅ − c₄)
/// ```
#[inline]
pub fn differential<T: Scalar>(phi: &Vector6<T>) -> Matrix6<T> {
    let (omega, rho) = split(phi);
    let square = squared(&omega);
    let [c2, c3, c4, c5] = [2, 3, 4, 5].map(|order| square.stumpff(order));
    let half = T::from_f64(0.5);
    let twice = (omega.dot(&rho)) * T::from_f64(2.0);
    let odd_slope = (c4 - c3 * half) * twice;
    let even_slope = (c5 * T::from_f64(1.5) - c4 * half) * twice;
    let own = so3::quadratic(&omega, -c2, c3);
    let along = so3::powers(&omega, -odd_slope, even_slope);
    let lower = mixed(&omega, &rho) * c3 - hat(&rho) * c2 + along;
    let mut whole = Matrix6::zeros();
    whole.fixed_view_mut::<3, 3>(0, 0).copy_from(&own);
    whole.fixed_view_mut::<3, 3>(3, 0).copy_from(&lower);
    whole.fixed_view_mut::<3, 3>(3, 3).copy_from(&own);
    whole
}

/// `ω~ρ~ + ρ~ω~`, without the product ω·ρ that cancels on the diagonal.
#[inline]
fn mixed<T: Scalar>(omega: &Vector3<T>, rho: &Vector3<T>) -> Matrix3<T> {
    let two = T::from_f64(2.0);
    let [x, y, z] = [0, 1, 2].map(|i| omega[i] * rho[i]);
    let of_pair = |i: usize, j: usize| omega[i].mul_add(rho[j], omega[j] * rho[i]);
    let (xy, xz, yz) = (of_pair(0, 1), of_pair(0, 2), of_pair(1, 2));
    let diagonal = [y + z, x + z, x + y].map(|sum| -two * sum);
    Matrix3::new(
        diagonal[0],
        xy,
        xz,
        xy,
        diagonal[1],
        yz,
        xz,
        yz,
        diagonal[2],
    )
}

/// `D⁻¹ rate = rate + ½ [ϕ, rate] + G [ϕ, [ϕ, rate]] + (0; 2 (ω·ρ) G′ ω × (ω × rate_ω))`, G and G′ at ω², for |ω| < 2π.
#[inline]
pub fn differential_inverse<T: Scalar>(phi: &Vector6<T>, rate: &Vector6<T>) -> Vector6<T> {
    let ((omega, rho), (turning, moving)) = (split(phi), split(rate));
    let square = squared(&omega);
    let (half, g) = (T::from_f64(0.5), square.dexp_inverse(0));
    let slope = square.dexp_inverse(1) * (omega.dot(&rho) * T::from_f64(2.0));
    let once = omega.cross(&turning);
    let twice = omega.cross(&once);
    let linear_once = omega.cross(&moving) + rho.cross(&turning);
    let linear_twice = omega.cross(&linear_once) + rho.cross(&once);
    join(
        &(turning + once * half + twice * g),
        &(moving + linear_once * half + linear_twice * g + twice * slope),
    )
}

/// The motion nearest to `q`, whose rotation is up to 1e-4 off.
#[inline]
pub fn nearest<T: Scalar>(q: &SVector<T, 12>) -> SVector<T, 12> {
    let (rotation, translation) = matrices(q);
    stored(&so3::nearest(&rotation), &translation)
}

/// Sum of the squares of the relations of [`so3`](super::so3::residual_squared).
#[inline]
pub fn residual_squared<T: Scalar>(q: &SVector<T, 12>) -> T {
    matrix_residual_squared(&matrices(q).0)
}

#[inline]
fn matrices<T: Scalar>(q: &SVector<T, 12>) -> (Matrix3<T>, Vector3<T>) {
    let rotation = Matrix3::from_fn(|i, j| q[4 * i + j]);
    (rotation, Vector3::new(q[3], q[7], q[11]))
}

#[inline]
fn stored<T: Scalar>(r: &Matrix3<T>, p: &Vector3<T>) -> SVector<T, 12> {
    SVector::from_fn(|n, _| match n % 4 {
        3 => p[n / 4],
        j => r[(n / 4, j)],
    })
}
