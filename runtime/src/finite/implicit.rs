//! Φ on a manifold that relations alone give, its inverse and its differential.
//!
//! Q lies in a group of dimension G, cut by C relations. `bases` of Q are B and N, G×K and G×C: `Φ(Q, ϕ) = Q exp(B ϕ + N λ)` with the λ for
//! which the relations hold. `displaced` is Q exp(ξ) for a displacement ξ (G).

use super::{inverse, least_squares, norm, unless_apart, with_jacobian};
use crate::scalar::{Dual, Scalar};
use nalgebra::{SMatrix, SVector};

/// Parts of ϕ by which [`retract`] goes from Q to Φ(Q, ϕ), so that it stays on the branch of Q where ϕ is long.
const PARTS: usize = 4;

/// Newton steps after each part: from the third on a part of some tenths is followed to what the next one needs.
const STEPS: usize = 2;

/// Newton steps at the end: two or three reach rounding, and each of the others makes derivatives of one more order exact where the scalars
/// are dual numbers.
const POLISHING: usize = 4;

/// Newton steps of [`retract`].
pub const RETRACT_ITERATIONS: usize = PARTS * STEPS + POLISHING;

/// B and N at a configuration.
type Bases<T, const K: usize, const G: usize, const C: usize> =
    (SMatrix<T, G, K>, SMatrix<T, G, C>);

/// Φ(Q, ϕ) by Newton's method from λ = 0; NaN in every entry where it does not converge within [`RETRACT_ITERATIONS`].
///
/// `moving` is (Q, ϕ).
pub fn retract<T: Scalar, const N: usize, const K: usize, const G: usize, const C: usize>(
    moving: (&SVector<T, N>, &SVector<T, K>),
    bases: impl Fn(&SVector<T, N>) -> Bases<T, K, G, C>,
    displaced: impl Fn(&SVector<Dual<T>, N>, &SVector<Dual<T>, G>) -> SVector<Dual<T>, N>,
    relations: impl Fn(&SVector<Dual<T>, N>) -> SVector<Dual<T>, C>,
) -> SVector<T, N> {
    let (q, phi) = moving;
    let bases = bases(q);
    let xi = displacement((q, phi), &bases, &displaced, relations);
    displaced(&q.map(Dual::constant), &xi.map(Dual::constant)).map(|entry| entry.value)
}

/// ξ = B ϕ + N λ with the λ for which the relations hold; NaN where Newton's method does not converge.
fn displacement<T: Scalar, const N: usize, const K: usize, const G: usize, const C: usize>(
    (q, phi): (&SVector<T, N>, &SVector<T, K>),
    (tangent, normal): &Bases<T, K, G, C>,
    displaced: impl Fn(&SVector<Dual<T>, N>, &SVector<Dual<T>, G>) -> SVector<Dual<T>, N>,
    relations: impl Fn(&SVector<Dual<T>, N>) -> SVector<Dual<T>, C>,
) -> SVector<T, G> {
    let base = q.map(Dual::constant);
    let (straight, back) = (tangent * phi, normal.map(Dual::constant));
    let step_at = |along: &SVector<T, G>, lambda: &SVector<T, C>| {
        let along = along.map(Dual::constant);
        let at =
            |lambda: &SVector<Dual<T>, C>| relations(&displaced(&base, &(along + back * lambda)));
        let (values, slopes) = with_jacobian(at, lambda);
        least_squares(&slopes, &values)
    };
    let mut lambda = SVector::<T, C>::zeros();
    for part in 1..=PARTS {
        let along = straight * T::from_f64(part as f64 / PARTS as f64);
        for _ in 0..STEPS {
            lambda -= step_at(&along, &lambda);
        }
    }
    for _ in 0..POLISHING {
        lambda -= step_at(&straight, &lambda);
    }
    let last = step_at(&straight, &lambda);
    let xi = straight + normal * (lambda - last);
    // The scale of a displacement is that of a turn by one radian, or its own where that is larger.
    unless_apart(&xi, norm(&last), T::one() + norm(&xi))
}

/// The ϕ of a displacement ξ = B ϕ + N λ: the inverse of [`retract`] where ξ leads to a point of the manifold.
///
/// Infinite or NaN where the columns of B and N are dependent.
pub fn along_tangent<T: Scalar, const K: usize, const G: usize, const C: usize>(
    displacement: &SVector<T, G>,
    (tangent, normal): Bases<T, K, G, C>,
) -> SVector<T, K> {
    let whole = SMatrix::<T, G, G>::from_fn(|i, j| match j < K {
        true => tangent[(i, j)],
        false => normal[(i, j - K)],
    });
    let parts = inverse(&whole) * displacement;
    SVector::from_fn(|k, _| parts[k])
}

/// D with `Φ(Q, ϕ + δ) = Φ(Q′, D δ) + O(δ²)` at Q′ = Φ(Q, ϕ), K×K.
pub fn retract_differential<
    T: Scalar,
    const N: usize,
    const K: usize,
    const G: usize,
    const C: usize,
>(
    moving: (&SVector<T, N>, &SVector<T, K>),
    bases: impl Fn(&SVector<T, N>) -> Bases<T, K, G, C>,
    displaced: impl Fn(&SVector<Dual<T>, N>, &SVector<Dual<T>, G>) -> SVector<Dual<T>, N>,
    relations: impl Fn(&SVector<Dual<T>, N>) -> SVector<Dual<T>, C>,
) -> SMatrix<T, K, K> {
    let (tangent, there) = tangents(moving, bases, displaced, relations);
    least_squares(&there, &tangent)
}

/// `D⁻¹ rate` with the D of [`retract_differential`].
pub fn retract_differential_inverse<
    T: Scalar,
    const N: usize,
    const K: usize,
    const G: usize,
    const C: usize,
>(
    (q, phi, rate): (&SVector<T, N>, &SVector<T, K>, &SVector<T, K>),
    bases: impl Fn(&SVector<T, N>) -> Bases<T, K, G, C>,
    displaced: impl Fn(&SVector<Dual<T>, N>, &SVector<Dual<T>, G>) -> SVector<Dual<T>, N>,
    relations: impl Fn(&SVector<Dual<T>, N>) -> SVector<Dual<T>, C>,
) -> SVector<T, K> {
    let (tangent, there) = tangents((q, phi), bases, displaced, relations);
    least_squares(&tangent, &(there * rate))
}

/// ∂Φ/∂ϕ at (Q, ϕ) and at (Q′, 0), both N×K of the stored scalars.
///
/// The derivative of λ is that of an implicit function: `(∂r/∂ξ N) λ′ = −∂r/∂ξ B` for the relations r.
fn tangents<T: Scalar, const N: usize, const K: usize, const G: usize, const C: usize>(
    moving: (&SVector<T, N>, &SVector<T, K>),
    bases: impl Fn(&SVector<T, N>) -> Bases<T, K, G, C>,
    displaced: impl Fn(&SVector<Dual<T>, N>, &SVector<Dual<T>, G>) -> SVector<Dual<T>, N>,
    relations: impl Fn(&SVector<Dual<T>, N>) -> SVector<Dual<T>, C>,
) -> (SMatrix<T, N, K>, SMatrix<T, N, K>) {
    let q = moving.0;
    let (tangent, normal) = bases(q);
    let xi = displacement(moving, &(tangent, normal), &displaced, &relations);
    let motion = |q: &SVector<T, N>, xi: &SVector<T, G>| {
        let base = q.map(Dual::constant);
        with_jacobian(|xi| displaced(&base, xi), xi)
    };
    let base = q.map(Dual::constant);
    let (_, slopes) = with_jacobian(|xi| relations(&displaced(&base, xi)), &xi);
    let back = least_squares(&(slopes * normal), &(slopes * tangent));
    let (moved, by_displacement) = motion(q, &xi);
    let here = by_displacement * (tangent - normal * back);
    let there = motion(&moved, &SVector::zeros()).1 * bases(&moved).0;
    (here, there)
}
