//! Inverse and differential of any Φ; its derivative ∂Φ/∂ϕ of the stored scalars comes from dual numbers.

use super::{least_squares, norm, unless_apart, with_jacobian};
use crate::matrix::{entries, map, product, zeros};
use crate::scalar::{Dual, Scalar};
use nalgebra::{SMatrix, SVector};

/// Steps of [`local`] that are taken only where they bring Φ nearer to its target.
const GUARDED: usize = 40;

/// Steps of [`local`] after them, taken whatever the residual: at the solution they move ϕ by rounding alone, but each
/// makes the derivatives of one more order exact where the scalars are dual numbers.
const POLISHING: usize = 3;

/// Bound on the iterations of [`local`].
pub const LOCAL_ITERATIONS: usize = GUARDED + POLISHING;

/// The ϕ with Φ(Q, ϕ) = `target`, by the Gauss–Newton method from ϕ = 0; NaN in every entry where it does not converge.
///
/// `retract` is Φ. A step is at most `1 + |ϕ|` long, so that it does not leave the branch of ϕ = 0; one that does not bring Φ
/// nearer is halved, at most [`LOCAL_ITERATIONS`] times in all. The result is accepted where the last step and the distance that
/// remains are below √ε of |Q| + |Q′|: a target may be that far off the manifold, a local minimum of the distance is not.
pub fn local<T: Scalar, const N: usize, const K: usize>(
    q: &SVector<T, N>,
    target: &SVector<T, N>,
    retract: impl Fn(&SVector<Dual<T>, N>, &SVector<Dual<T>, K>) -> SVector<Dual<T>, N>,
) -> SVector<T, K> {
    let base = map(q, Dual::constant);
    let linear_at = |phi: &SVector<T, K>| {
        let (moved, tangent) = with_jacobian(|phi| retract(&base, phi), phi);
        let gap = target - moved;
        (gap, tangent, least_squares(&tangent, &gap))
    };
    let mut phi = guarded_descent(|phi| {
        let (gap, _, step) = linear_at(phi);
        (gap, bounded(phi, &step))
    });
    for _ in 0..POLISHING {
        phi += linear_at(&phi).2;
    }
    let (gap, tangent, step) = linear_at(&phi);
    let missing = product(&tangent, &step);
    unless_apart(&phi, norm(&gap) + norm(&missing), norm(target) + norm(q))
}

/// Descent from 0 with steps halved; `at` gives the gap that remains at ϕ and the step from there.
fn guarded_descent<T: Scalar, const N: usize, const K: usize>(
    at: impl Fn(&SVector<T, K>) -> (SVector<T, N>, SVector<T, K>),
) -> SVector<T, K> {
    let (one, half) = (T::one(), T::from_f64(0.5));
    let mut phi = zeros::<T, K, 1>();
    let (mut gap, mut direction) = at(&phi);
    let mut share = one;
    for _ in 0..GUARDED {
        let next = phi + direction * share;
        let (next_gap, next_direction) = at(&next);
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
    entries(|i| T::select(mask, if_true.data.0[0][i], if_false.data.0[0][i]))
}

/// D with `Φ(Q, ϕ + δ) = Φ(Q′, D δ) + O(δ²)` at Q′ = Φ(Q, ϕ), K×K; `retract` is Φ.
pub fn differential<T: Scalar, const N: usize, const K: usize>(
    q: &SVector<T, N>,
    phi: &SVector<T, K>,
    retract: impl Fn(&SVector<Dual<T>, N>, &SVector<Dual<T>, K>) -> SVector<Dual<T>, N>,
) -> SMatrix<T, K, K> {
    let (tangent, there) = tangents(q, phi, retract);
    least_squares(&there, &tangent)
}

/// `D⁻¹ rate` with the D of [`differential`]; infinite or NaN where D is singular.
pub fn differential_inverse<T: Scalar, const N: usize, const K: usize>(
    q: &SVector<T, N>,
    phi: &SVector<T, K>,
    rate: &SVector<T, K>,
    retract: impl Fn(&SVector<Dual<T>, N>, &SVector<Dual<T>, K>) -> SVector<Dual<T>, N>,
) -> SVector<T, K> {
    let (tangent, there) = tangents(q, phi, retract);
    least_squares(&tangent, &product(&there, rate))
}

/// ∂Φ/∂ϕ at (Q, ϕ) and at (Q′, 0), both N×K of the stored scalars.
///
/// Their columns span the same space, that of the motions of Q′, so that the first is the second times D for one D.
fn tangents<T: Scalar, const N: usize, const K: usize>(
    q: &SVector<T, N>,
    phi: &SVector<T, K>,
    retract: impl Fn(&SVector<Dual<T>, N>, &SVector<Dual<T>, K>) -> SVector<Dual<T>, N>,
) -> (SMatrix<T, N, K>, SMatrix<T, N, K>) {
    let at = |q: &SVector<T, N>, phi: &SVector<T, K>| {
        let base = map(q, Dual::constant);
        with_jacobian(|phi| retract(&base, phi), phi)
    };
    let (moved, tangent) = at(q, phi);
    (tangent, at(&moved, &zeros()).1)
}
