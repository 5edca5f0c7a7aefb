//! Slices and vectors or matrices of fixed sizes; a slice of another size reads as NaN, and is filled with NaN.

use crate::matrix::{filled, of_columns};
use crate::scalar::Scalar;
use nalgebra::{SMatrix, SVector};

/// Not a number.
#[inline]
pub(crate) fn nan<T: Scalar>() -> T {
    T::from_f64(f64::NAN)
}

/// The slice as a vector.
#[inline]
pub(crate) fn vector<T: Scalar, const D: usize>(slice: &[T]) -> SVector<T, D> {
    // Entry by entry: nalgebra's own way copies a number of bytes that is not known when it is compiled, by a call.
    match array(slice) {
        Some(entries) => of_columns([*entries]),
        None => filled(nan()),
    }
}

/// The slice as an array, if it is of that size.
#[inline(always)]
pub(crate) fn array<E, const D: usize>(slice: &[E]) -> Option<&[E; D]> {
    slice.try_into().ok()
}

/// The slice as an array, if it is of that size.
#[inline(always)]
pub(crate) fn array_mut<E, const D: usize>(slice: &mut [E]) -> Option<&mut [E; D]> {
    slice.try_into().ok()
}

/// What is stored column by column in a slice.
pub(crate) trait Store<T> {
    /// The entries into `out`; NaN where that is of another size.
    fn store(&self, out: &mut [T]);
}

impl<T: Scalar, const R: usize, const C: usize> Store<T> for SMatrix<T, R, C> {
    fn store(&self, out: &mut [T]) {
        match out.len() == R * C {
            true => out.copy_from_slice(self.as_slice()),
            false => out.fill(nan()),
        }
    }
}

/// One matrix after the other.
impl<T: Scalar, const R: usize, const C: usize, const K: usize> Store<T> for [SMatrix<T, R, C>; K] {
    fn store(&self, out: &mut [T]) {
        if out.len() != R * C * K {
            return out.fill(nan());
        }
        // A chunk size of 0, which a joint without constraints can ask for, is refused.
        for (slice, chunk) in self.iter().zip(out.chunks_exact_mut((R * C).max(1))) {
            slice.store(chunk);
        }
    }
}
