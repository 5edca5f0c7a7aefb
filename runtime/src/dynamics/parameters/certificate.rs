//! What says that base parameters are as few as can be, and that what was left out does not act: the regressor at random states.

use super::ParameterError;
use super::sample::{Random, configurations};
use crate::dynamics::{JointTorqueRegressor, Recursive};
use crate::mechanism::Mechanism;
use crate::spatial::INERTIAL_PARAMETERS;
use alloc::sync::Arc;
use alloc::vec::Vec;
use nalgebra::{DMatrix, DVector, SVD};
use num_traits::Float;

/// Fewest states, and how many times as many rows as columns.
const STATES: usize = 24;
const ROWS: usize = 3;
/// Largest entries of v̄ and v̄̇: those of a fast robot, so that gravity does not outweigh all else.
const SPEED: f64 = 3.0;
const RATE: f64 = 10.0;
/// Roundings of one entry of the regressor for each joint on the way to the root, of the size of its column.
const ROUNDINGS: f64 = 32.0;
/// The smallest singular value must be this many times the rounding.
const MARGIN: f64 = 1e3;

/// The regressor of the base parameters at random states, one state below the other, its columns scaled to length 1.
///
/// Where its smallest singular value stands far above what rounding can make of 0, its columns are independent: no combination of base parameters is
/// without effect at all of these states. The rounding is an estimate from the number of operations and from what was measured, not an enclosure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certificate {
    /// How many states.
    pub states: usize,
    /// Smallest singular value.
    pub smallest: f64,
    /// Largest singular value.
    pub largest: f64,
    /// What rounding may change a singular value by.
    pub rounding: f64,
    /// The largest effect of a combination that was left out, as a part of that of its terms: rounding.
    pub effect: f64,
}

impl Certificate {
    /// Whether the base parameters are independent: the smallest singular value is a thousand times the rounding, or there are none of them.
    pub fn is_minimal(&self) -> bool {
        // Without base parameters both are 0.
        self.smallest >= MARGIN * self.rounding
    }
}

/// The certificate of the `kept` columns, where the rows of `left_out` have no effect.
pub(super) fn certificate(
    mechanism: &Arc<Mechanism>,
    kept: &[usize],
    left_out: &[DVector<f64>],
    random: &mut Random,
) -> Result<Certificate, ParameterError> {
    let rows = mechanism.layout().speeds.max(1);
    let states = STATES.max((ROWS * kept.len()).div_ceil(rows));
    let regressors = regressors(mechanism, states, random)?;
    let norms: Vec<f64> = regressors.column_iter().map(|own| own.norm()).collect();
    let sizes = sizes(&norms);
    let effect = left_out.iter().map(|row| effect(&regressors, &sizes, row));
    let effect = effect.fold(0.0, f64::max);
    let depth = depth(mechanism) as f64;
    let of_entry = effect.max(ROUNDINGS * depth * f64::EPSILON);
    let scaled = DMatrix::from_fn(regressors.nrows(), kept.len(), |i, j| {
        let place = kept[j];
        // A column of rounding alone must not become one of length 1.
        match norms[place] > MARGIN * of_entry * sizes[place] {
            true => regressors[(i, place)] / norms[place],
            false => 0.0,
        }
    });
    let (smallest, largest) = singular_values(scaled);
    Ok(Certificate {
        states,
        smallest,
        largest,
        // The norm of a matrix whose columns are that long.
        rounding: of_entry * Float::sqrt(kept.len() as f64),
        effect,
    })
}

/// Regressors at so many states, one below the other.
fn regressors(
    mechanism: &Arc<Mechanism>,
    states: usize,
    random: &mut Random,
) -> Result<DMatrix<f64>, ParameterError> {
    let joints = mechanism.joints();
    let drawn = joints.map(|(joint, _)| configurations(mechanism, joint, states, random));
    let drawn: Vec<_> = drawn.collect::<Result<_, _>>()?;
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let mut regressor = JointTorqueRegressor::new(mechanism);
    let (rows, columns) = (regressor.rows(), regressor.columns());
    let mut all = DMatrix::zeros(states * rows, columns);
    for state in 0..states {
        let q: Vec<f64> = drawn.iter().flat_map(|own| own[state].clone()).collect();
        let mut numbers =
            |size: f64| -> Vec<f64> { (0..rows).map(|_| size * random.number()).collect() };
        let (speeds, rates) = (numbers(SPEED), numbers(RATE));
        dynamics.joint_torque_regressor(&q, &speeds, &rates, &mut regressor)?;
        all.rows_mut(state * rows, rows)
            .copy_from(&regressor.matrix());
    }
    Ok(all)
}

/// How much one unit of a mass, a first moment or a moment of inertia does at most, for each parameter: what rounding is measured by, where a
/// parameter has no effect of its own.
fn sizes(norms: &[f64]) -> Vec<f64> {
    let kind = |place: usize| match place % INERTIAL_PARAMETERS {
        0 => 0,
        1..4 => 1,
        _ => 2,
    };
    let mut largest = [0.0; 3];
    for (place, norm) in norms.iter().enumerate() {
        let own: &mut f64 = &mut largest[kind(place)];
        *own = own.max(*norm);
    }
    (0..norms.len()).map(|place| largest[kind(place)]).collect()
}

/// The effect of a combination of parameters, as a part of the largest that its terms can have.
fn effect(regressors: &DMatrix<f64>, sizes: &[f64], row: &DVector<f64>) -> f64 {
    let mut sum = DVector::zeros(regressors.nrows());
    let mut terms = 0.0;
    for (place, weight) in row.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
        sum.axpy(*weight, &regressors.column(place), 1.0);
        terms += weight.abs() * sizes[place];
    }
    match terms > 0.0 {
        true => sum.norm() / terms,
        false => 0.0,
    }
}

/// Smallest and largest; both 0 of a matrix without columns or with fewer rows than columns.
fn singular_values(matrix: DMatrix<f64>) -> (f64, f64) {
    if matrix.ncols() == 0 || matrix.nrows() < matrix.ncols() {
        return (0.0, 0.0);
    }
    let triangle = matrix.qr().r();
    let values = SVD::new(triangle, false, false).singular_values;
    (values.min(), values.max())
}

/// The most joints between a body and the world.
fn depth(mechanism: &Mechanism) -> usize {
    let mut depths: Vec<usize> = Vec::with_capacity(mechanism.bodies().len());
    for body in mechanism.bodies() {
        depths.push(1 + body.parent().map_or(0, |parent| depths[parent]));
    }
    depths.into_iter().max().unwrap_or(0)
}
