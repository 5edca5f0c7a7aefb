//! Vectors and matrices of dual numbers.

use hamel_runtime::scalar::{Dual, Scalar};
use nalgebra::{SMatrix, SVector};

/// `numbers` moved along `direction`, as the first-order part of a dual number.
pub fn along<T: Scalar, const D: usize>(
    numbers: &SVector<T, D>,
    direction: &SVector<T, D>,
) -> SVector<Dual<T>, D> {
    SVector::from_fn(|i, _| Dual::new(numbers[i], direction[i]))
}

pub fn unit<T: Scalar, const D: usize>(k: usize) -> SVector<T, D> {
    SVector::from_fn(|i, _| if i == k { T::one() } else { T::zero() })
}

pub fn constant<T: Scalar, const D: usize>(numbers: &SVector<T, D>) -> SVector<Dual<T>, D> {
    numbers.map(Dual::constant)
}

pub fn slope<T: Scalar, const R: usize, const C: usize>(
    m: &SMatrix<Dual<T>, R, C>,
) -> SMatrix<T, R, C> {
    m.map(|entry| entry.derivative())
}

/// `matrix⁻¹ side` by elimination without pivoting: the matrices here are positive or near the identity.
pub fn solve<T: Scalar, const K: usize, const R: usize>(
    mut matrix: SMatrix<T, K, K>,
    mut side: SMatrix<T, K, R>,
) -> SMatrix<T, K, R> {
    for p in 0..K {
        for i in (0..K).filter(|&i| i != p) {
            let factor = matrix[(i, p)] / matrix[(p, p)];
            for j in 0..K {
                let term = factor * matrix[(p, j)];
                matrix[(i, j)] -= term;
            }
            for j in 0..R {
                let term = factor * side[(p, j)];
                side[(i, j)] -= term;
            }
        }
    }
    SMatrix::from_fn(|i, j| side[(i, j)] / matrix[(i, i)])
}
