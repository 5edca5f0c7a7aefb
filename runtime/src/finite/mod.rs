//! Finite maps of joints that have no closed form: the inverse of Φ, its differential, Φ and projection on manifolds of relations.
//!
//! Generated joints call these functions with their own Φ and relations as functions of dual numbers, which give the values and
//! the derivatives. Everything is generic over [`Scalar`], allocates nothing, and does the same operations whatever the data:
//! iteration counts are fixed, choices go through [`Scalar::select`]. What fails comes back as NaN in every entry of the lane that
//! fails.

mod implicit;
mod invert;
mod project;
mod solve;
#[cfg(test)]
mod tests;

#[cfg(feature = "alloc")]
pub(crate) use implicit::along_branch;
pub use implicit::{RETRACT_ITERATIONS, along_tangent, retract};
pub use invert::{LOCAL_ITERATIONS, differential, differential_inverse, local};
#[cfg(feature = "alloc")]
pub(crate) use project::by_shortest;
pub use project::{PROJECT_ITERATIONS, assemble, project, project_by_displacements};
#[cfg(feature = "alloc")]
pub(crate) use solve::{determinant, orientation, solve, substitute_back, triangulate};
pub use solve::{inverse, least_squares};

use crate::matrix::{map, zeros};
use crate::scalar::{Dual, Scalar};
use nalgebra::{SMatrix, SVector};

/// A map's value at `x` and its Jacobian there, N×K: one evaluation a column.
fn with_jacobian<T: Scalar, const N: usize, const K: usize>(
    function: impl Fn(&SVector<Dual<T>, K>) -> SVector<Dual<T>, N>,
    x: &SVector<T, K>,
) -> (SVector<T, N>, SMatrix<T, N, K>) {
    let still = map(x, Dual::constant);
    let (mut value, mut jacobian) = (zeros::<T, N, 1>(), zeros::<T, N, K>());
    // A loop, so that what the function does is compiled once; with nothing to vary it is evaluated all the same.
    for k in 0..K.max(1) {
        let mut moving = still;
        if k < K {
            moving.data.0[0][k] = Dual::variable(x.data.0[0][k]);
        }
        let moved = function(&moving);
        for i in 0..N {
            let entry = moved.data.0[0][i];
            value.data.0[0][i] = entry.value;
            if k < K {
                jacobian.data.0[k][i] = entry.derivative();
            }
        }
    }
    (value, jacobian)
}

/// |x|.
fn absolute<T: Scalar>(x: T) -> T {
    T::select(x.less(T::zero()), -x, x)
}

/// Least absolute value of the numbers: +∞ of none, NaN where one of them is not finite.
///
/// This is how emitted kernels tell the distance to a set that a joint must stay away from.
pub fn least_absolute<T: Scalar, const R: usize>(numbers: [T; R]) -> T {
    let infinity = T::from_f64(f64::INFINITY);
    let least = numbers.into_iter().fold(infinity, |least, number| {
        let size = absolute(number);
        T::select(size.less(least), size, least)
    });
    // A comparison with NaN is false and would pass over it: 0 · x is 0 or NaN.
    numbers
        .into_iter()
        .fold(least, |least, number| least + number * T::zero())
}

/// [`least_absolute`] where all of `positive` are positive, 0 where one of them is not or is NaN.
///
/// Beyond such a set a root or logarithm of the joint may have no value: there is no configuration on that side.
pub fn least_absolute_beside<T: Scalar, const R: usize, const P: usize>(
    numbers: [T; R],
    positive: [T; P],
) -> T {
    let least = least_absolute(numbers);
    positive.into_iter().fold(least, |value, number| {
        T::select(T::zero().less(number), value, T::zero())
    })
}

/// Euclidean norm, free of overflow and underflow: ϕ and residuals go down to 1e-300.
fn norm<T: Scalar, const D: usize>(vector: &SVector<T, D>) -> T {
    let zero = T::zero();
    let mut largest = zero;
    for i in 0..D {
        let size = absolute(vector.data.0[0][i]);
        largest = T::select(size.less(largest), largest, size);
    }
    // The divisor of a zero vector is 1, so that its norm is 0 and has a derivative.
    let divisor = T::select(zero.less(largest), largest, T::one());
    let mut square = zero;
    for i in 0..D {
        let ratio = vector.data.0[0][i] / divisor;
        square += ratio * ratio;
    }
    let positive = zero.less(square);
    let root = T::select(positive, square, T::one()).sqrt();
    divisor * T::select(zero.less(largest), root, largest)
}

/// `value` where `error` is no more than √ε of `scale`, NaN elsewhere.
///
/// Newton's method squares its error: a last step of √ε leaves an error of about ε, while a method that has not
/// converged takes steps far above √ε. The smallest normal `f32` stands for zero.
fn unless_apart<T: Scalar, const D: usize>(
    value: &SVector<T, D>,
    error: T,
    scale: T,
) -> SVector<T, D> {
    let limit = T::epsilon().sqrt() * scale + T::from_f64(f32::MIN_POSITIVE.into());
    let close = error.less(limit);
    map(value, |entry| {
        T::select(close, entry, T::from_f64(f64::NAN))
    })
}

/// `value` where two signs are the same, NaN elsewhere.
fn unless_turned<T: Scalar, const D: usize>(
    value: &SVector<T, D>,
    sign: T,
    other: T,
) -> SVector<T, D> {
    let same = T::zero().less(sign * other);
    map(value, |entry| T::select(same, entry, T::from_f64(f64::NAN)))
}
