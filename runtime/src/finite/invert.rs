//! Inverse and differential of a Φ that is given by its value and its derivative ∂Φ/∂ϕ of the stored scalars.

use super::solve::solve;
use super::{least_squares, norm, unless_apart};
use crate::scalar::Scalar;
use nalgebra::{SMatrix, SVector};

/// Steps of [`local`] that are taken only where they bring Φ nearer to its target.
const GUARDED: usize = 40;

/// Steps of [`local`] after them, taken whatever the residual: at the solution they move ϕ by rounding alone, but each
/// makes the derivatives of one more order exact where the scalars are dual numbers.
const POLISHING: usize = 3;

/// Bound on the iterations of [`local`].
pub const LOCAL_ITERATIONS: usize = GUARDED + POLISHING;

/// The ϕ with Φ(ϕ) = `target`, by the Gauss–Newton method from ϕ = 0; NaN in every entry where it does not converge.
///
/// `retract` is ϕ ↦ Φ(Q, ϕ), `tangent` is ϕ ↦ ∂Φ/∂ϕ (N×K). A step is at most `1 + |ϕ|` long, so that it does not leave the
/// branch of ϕ = 0; one that does not bring Φ nearer is halved, at most [`LOCAL_ITERATIONS`] times in all. The result is
/// accepted where the last step and the distance that remains are below √ε of |Q| + |Q′|: a target may be that far off the
/// manifold, a local minimum of the distance is not.
pub fn local<T: Scalar, const N: usize, const K: usize>(
    target: &SVector<T, N>,
    retract: impl Fn(&SVector<T, K>) -> SVector<T, N>,
    tangent: impl Fn(&SVector<T, K>) -> SMatrix<T, N, K>,
) -> SVector<T, K> {
    let step = |phi: &SVector<T, K>, gap: &SVector<T, N>| least_squares(&tangent(phi), gap);
    let gap_at = |phi: &SVector<T, K>| target - retract(phi);
    let mut phi = guarded_descent(&gap_at, &step);
    for _ in 0..POLISHING {
        phi += step(&phi, &gap_at(&phi));
    }
    let gap = gap_at(&phi);
    let missing = tangent(&phi) * step(&phi, &gap);
    let scale = norm(target) + norm(&retract(&SVector::zeros()));
    unless_apart(&phi, norm(&gap) + norm(&missing), scale)
}

/// Gauss–Newton from 0 with steps bounded and halved.
fn guarded_descent<T: Scalar, const N: usize, const K: usize>(
    gap_at: &impl Fn(&SVector<T, K>) -> SVector<T, N>,
    step: &impl Fn(&SVector<T, K>, &SVector<T, N>) -> SVector<T, K>,
) -> SVector<T, K> {
    let (one, half) = (T::one(), T::from_f64(0.5));
    let mut phi = SVector::<T, K>::zeros();
    let mut gap = gap_at(&phi);
    let mut direction = bounded(&phi, &step(&phi, &gap));
    let mut share = one;
    for _ in 0..GUARDED {
        let next = phi + direction * share;
        let next_gap = gap_at(&next);
        let next_direction = bounded(&next, &step(&next, &next_gap));
        let nearer = norm(&next_gap).less(norm(&gap));
        phi = either(nearer, &next, &phi);
        gap = either(nearer, &next_gap, &gap);
        direction = either(nearer, &next_direction, &direction);
        share = T::select(nearer, one, share * half);
    }
    phi
}

fn bounded<T: Scalar, const K: usize>(phi: &SVector<T, K>, step: &SVector<T, K>) -> SVector<T, K> {
    let (most, length) = (T::one() + norm(phi), norm(step));
    let long = most.less(length);
    let factor = T::select(long, most, T::one()) / T::select(long, length, T::one());
    step * factor
}

fn either<T: Scalar, const D: usize>(
    mask: T::Mask,
    if_true: &SVector<T, D>,
    if_false: &SVector<T, D>,
) -> SVector<T, D> {
    SVector::from_fn(|i, _| T::select(mask, if_true[i], if_false[i]))
}

/// D with `Φ(Q, ϕ + δ) = Φ(Q′, D δ) + O(δ²)` at Q′ = Φ(Q, ϕ), K×K.
///
/// `tangent` is ∂Φ/∂ϕ at (Q, ϕ), `tangent_there` at (Q′, 0), both N×K of the stored scalars. Their columns span the same
/// space, that of the motions of Q′, so that `tangent = tangent_there · D` has one solution.
pub fn differential<T: Scalar, const N: usize, const K: usize>(
    tangent: &SMatrix<T, N, K>,
    tangent_there: &SMatrix<T, N, K>,
) -> SMatrix<T, K, K> {
    solve(tangent_there, tangent)
}

/// `D⁻¹ rate` with the D of [`differential`]; infinite or NaN where D is singular.
pub fn differential_inverse<T: Scalar, const N: usize, const K: usize>(
    tangent: &SMatrix<T, N, K>,
    tangent_there: &SMatrix<T, N, K>,
    rate: &SVector<T, K>,
) -> SVector<T, K> {
    least_squares(tangent, &(tangent_there * rate))
}
