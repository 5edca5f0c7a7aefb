//! Stored scalars of a joint, without those that are idle: [`Joint::idle`].

use super::slices::{Store, array, nan};
use crate::joint::Joint;
use crate::matrix::{filled, of_columns, zeros};
use crate::scalar::Scalar;
use nalgebra::SVector;

/// How many scalars are stored.
#[inline(always)]
pub(super) fn size<
    J: Joint<N, K, S, C>,
    const N: usize,
    const K: usize,
    const S: usize,
    const C: usize,
>(
    joint: &J,
) -> usize {
    N.saturating_sub(joint.idle())
}

/// Those of names that belong to what is used: the last ones may be idle.
pub(super) fn used<
    J: Joint<N, K, S, C>,
    const N: usize,
    const K: usize,
    const S: usize,
    const C: usize,
>(
    joint: &J,
    names: &'static [&'static str],
) -> &'static [&'static str] {
    names
        .get(..names.len().saturating_sub(joint.idle()))
        .unwrap_or(names)
}

/// The slice with zeros for what is idle, if it is of the size of what is stored.
#[inline(always)]
pub(super) fn exactly<
    T: Scalar,
    J: Joint<N, K, S, C>,
    const N: usize,
    const K: usize,
    const S: usize,
    const C: usize,
>(
    joint: &J,
    slice: &[T],
) -> Option<SVector<T, N>> {
    match joint.idle() {
        0 => array(slice).map(|entries| of_columns([*entries])),
        _ if slice.len() != size(joint) => None,
        _ => {
            let mut padded = zeros::<T, N, 1>();
            padded.data.0[0][..slice.len()].copy_from_slice(slice);
            Some(padded)
        }
    }
}

/// The slice with zeros for what is idle; NaN where it is of another size than what is stored.
#[inline(always)]
pub(super) fn stored<
    T: Scalar,
    J: Joint<N, K, S, C>,
    const N: usize,
    const K: usize,
    const S: usize,
    const C: usize,
>(
    joint: &J,
    slice: &[T],
) -> SVector<T, N> {
    match exactly(joint, slice) {
        Some(own) => own,
        None => filled(nan()),
    }
}

/// What is stored of a vector into `out`; NaN where that is of another size.
#[inline(always)]
pub(super) fn store<
    T: Scalar,
    J: Joint<N, K, S, C>,
    const N: usize,
    const K: usize,
    const S: usize,
    const C: usize,
>(
    joint: &J,
    vector: &SVector<T, N>,
    out: &mut [T],
) {
    match joint.idle() {
        0 => vector.store(out),
        _ if out.len() != size(joint) => out.fill(nan()),
        _ => out.copy_from_slice(&vector.data.0[0][..out.len()]),
    }
}
