//! Small symmetric blocks of the mass matrix, one a joint: factors, and what is left of an inertia once the joint yields.

use super::inverse::MOST_FREEDOMS;
use crate::spatial::ArticulatedInertia;
use crate::steps::PivotFailure;
use nalgebra::Vector6;

/// `I ← I − Y D⁻¹ Yᵀ` for the columns Y and the factors of D in `block`.
pub(super) fn reduce_inertia(
    inertia: &mut ArticulatedInertia<f64>,
    yields: &[Vector6<f64>],
    block: &[f64],
) {
    let size = yields.len();
    let mut reduced = [Vector6::zeros(); MOST_FREEDOMS];
    for i in 0..size {
        let lower = &block[i * size..i * size + i];
        let known = lower.iter().zip(&reduced);
        let own = known.fold(yields[i], |sum, (l, before)| sum - before * *l);
        inertia.add_outer(&own, -1.0 / block[i * size + i]);
        reduced[i] = own;
    }
}

/// LDLᵀ of a symmetric matrix, of which the lower triangle is read, in place: D on the diagonal, L below.
///
/// # Errors
/// The first pivot that does not stand above its limit.
pub(super) fn factorize(
    block: &mut [f64],
    size: usize,
    limit: impl Fn(usize) -> f64,
) -> Result<(), PivotFailure> {
    for i in 0..size {
        for j in 0..=i {
            let known =
                (0..j).map(|k| block[i * size + k] * block[j * size + k] * block[k * size + k]);
            let entry = block[i * size + j] - known.sum::<f64>();
            if i > j {
                block[i * size + j] = entry / block[j * size + j];
            } else if entry > limit(i) {
                block[i * size + i] = entry;
            } else {
                return Err(PivotFailure {
                    speed: i,
                    pivot: entry,
                    limit: limit(i),
                });
            }
        }
    }
    Ok(())
}

/// `(L D Lᵀ)⁻¹ x` in place.
pub(super) fn solve(block: &[f64], x: &mut [f64]) {
    let size = x.len();
    for i in 0..size {
        for j in 0..i {
            x[i] -= block[i * size + j] * x[j];
        }
    }
    for i in (0..size).rev() {
        x[i] /= block[i * size + i];
        for j in i + 1..size {
            x[i] -= block[j * size + i] * x[j];
        }
    }
}
