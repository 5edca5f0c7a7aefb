//! Φ on a manifold that relations alone give, and the inverse of Φ.
//!
//! Q lies in a group of dimension G, cut by C relations φ. The columns of B and N at Q, G×K and G×C, span its algebra:
//! `Φ(Q, ϕ) = Q exp(B ϕ + N λ)` with the λ for which the relations hold. Along `Q′ = Q exp(ξ)` the relations have the rates
//! `∂φ(Q′) dexp(ξ) ξ̇`, both factors in closed form.

#[cfg(test)]
mod tests;

use super::solve::{orientation, substitute_back, triangulate};
use super::{least_squares, norm, unless_apart, unless_turned};
use crate::matrix::{by_entry, product, zeros};
use crate::scalar::Scalar;
use nalgebra::{SMatrix, SVector};

/// Parts of ϕ by which [`retract`] goes from Q to Φ(Q, ϕ), so that it stays on the branch of Q where ϕ is long.
const PARTS: usize = 4;

/// Newton steps at the end: from an error of some hundredths three or four reach rounding. Each squares the error, and so makes derivatives
/// of more orders exact where the scalars are dual numbers.
const STEPS: usize = 5;

/// Newton steps of [`retract`]: one after each part but the last, which goes on along the tangent to the end of the next, and those at the end.
pub const RETRACT_ITERATIONS: usize = PARTS - 1 + STEPS;

/// Φ(Q, ϕ) by Newton's method from λ = 0; NaN in every entry where it does not converge within [`RETRACT_ITERATIONS`], and where it comes to
/// another branch than that of Q: between two branches ∂φ N is singular, and its determinant has another sign beyond.
///
/// `bases` are B and N at Q, `displaced` is Q exp(ξ); `relations` has their values at a configuration Q exp(ξ), C, and their derivatives
/// along ξ, C×G.
pub fn retract<T: Scalar, const N: usize, const K: usize, const G: usize, const C: usize>(
    phi: &SVector<T, K>,
    (tangent, normal): (SMatrix<T, G, K>, SMatrix<T, G, C>),
    displaced: impl Fn(&SVector<T, G>) -> SVector<T, N>,
    relations: impl Fn(&SVector<T, N>, &SVector<T, G>) -> (SVector<T, C>, SMatrix<T, C, G>),
) -> SVector<T, N> {
    along_branch(
        &product(&tangent, phi),
        |lambda| product(&normal, lambda),
        &displaced,
        |xi, ahead| {
            let (values, slopes) = relations(&displaced(xi), xi);
            let (mut triangle, mut side) =
                (product(&slopes, &normal), values + product(&slopes, ahead));
            triangulate(C, triangle.as_mut_slice(), side.as_mut_slice());
            let sign = orientation(C, triangle.as_slice());
            substitute_back(C, triangle.as_slice(), side.as_mut_slice());
            (-side, sign)
        },
    )
}

/// What [`retract`] does, `whole` being B ϕ, `normal` N λ, and `step` the λ that the relations ask for, less that at ξ, to first order, after ξ is led on by `ahead`; with the sign
/// of the determinant of ∂φ N.
#[inline]
pub(crate) fn along_branch<T: Scalar, const N: usize, const G: usize, const C: usize>(
    whole: &SVector<T, G>,
    normal: impl Fn(&SVector<T, C>) -> SVector<T, G>,
    displaced: impl Fn(&SVector<T, G>) -> SVector<T, N>,
    step: impl Fn(&SVector<T, G>, &SVector<T, G>) -> (SVector<T, C>, T),
) -> SVector<T, N> {
    let here = zeros();
    let (_, own_sign) = step(&here, &here);
    let part = whole * T::from_f64(1.0 / PARTS as f64);
    let mut lambda = zeros::<T, C, 1>();
    for n in 1..PARTS {
        let along = part * T::from_f64(n as f64);
        lambda += step(&(along + normal(&lambda)), &part).0;
    }
    let (mut last, mut sign) = (zeros(), own_sign);
    for _ in 0..STEPS {
        (last, sign) = step(&(whole + normal(&lambda)), &here);
        lambda += last;
    }
    let xi = whole + normal(&lambda);
    // The scale of a displacement is that of a turn by one radian, or its own where that is larger.
    let found = unless_apart(&xi, norm(&last), T::one() + norm(&xi));
    displaced(&unless_turned(&found, own_sign, sign))
}

/// The ϕ of displacements ξ = B ϕ + N λ, M of them: the inverse of [`retract`] where ξ leads to a point of the manifold.
///
/// Infinite or NaN where the columns of B and N are dependent.
pub fn along_tangent<T: Scalar, const K: usize, const G: usize, const C: usize, const M: usize>(
    displacements: &SMatrix<T, G, M>,
    (tangent, normal): (SMatrix<T, G, K>, SMatrix<T, G, C>),
) -> SMatrix<T, K, M> {
    let whole = by_entry::<T, G, G>(|i, j| match j < K {
        true => tangent.data.0[j][i],
        false => normal.data.0[j - K][i],
    });
    let parts = least_squares(&whole, displacements);
    by_entry(|k, j| parts.data.0[j][k])
}
