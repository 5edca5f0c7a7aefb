//! Elimination of a joint's freedoms from the inertia and the wrench of what it carries, one freedom after the other.

use super::place::Parts;
use crate::joint::Joint;
use crate::scalar::Scalar;
use crate::spatial::fused::dot;
use crate::spatial::{ArticulatedInertia, Symmetric3, add_weighted, split};
use nalgebra::{Matrix3, Vector6};

/// How many roundings of the inertia's own size a pivot must stand above: those of its products, of the shift and of the
/// update, with a margin of four.
const ROUNDINGS: f64 = 64.0;

/// One eliminated freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pivot<T> {
    /// `Y_j = I X_j`: the momentum of one unit of its speed, with those before it free.
    pub momentum: Vector6<T>,
    /// `1 / d_j`, of the inertia `d_j = X_jᵀ Y_j`.
    pub inverse: T,
}

impl<T: Scalar> Pivot<T> {
    /// Of a freedom not yet eliminated.
    pub fn zero() -> Self {
        Self {
            momentum: Vector6::zeros(),
            inverse: T::zero(),
        }
    }
}

/// A freedom that moves no inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PivotFailure {
    /// Which of the joint's speeds.
    pub speed: usize,
    /// `d_j`.
    pub pivot: f64,
    /// What its rounding amounts to.
    pub limit: f64,
}

/// `X_jᵀ F`, without the parts that the joint type does not have.
#[inline(always)]
pub(super) fn power<J, T, const N: usize, const K: usize, const S: usize, const C: usize>(
    column: &Vector6<T>,
    wrench: &Vector6<T>,
) -> T
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    let ((angular, linear), (moment, force)) = (split(column), split(wrench));
    match Parts::any::<J, N, K, S, C>() {
        (true, true) => dot(&angular, &moment) + dot(&linear, &force),
        (true, false) => dot(&angular, &moment),
        (false, true) => dot(&linear, &force),
        (false, false) => T::zero(),
    }
}

/// `I X_j`, without the parts that the joint type does not have.
#[inline(always)]
fn momentum<J, T, const N: usize, const K: usize, const S: usize, const C: usize>(
    inertia: &ArticulatedInertia<T>,
    column: &Vector6<T>,
) -> Vector6<T>
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    let (angular, linear) = split(column);
    match Parts::any::<J, N, K, S, C>() {
        (true, true) => inertia.apply(column),
        (true, false) => inertia.apply_angular(&angular),
        (false, true) => inertia.apply_linear(&linear),
        (false, false) => Vector6::zeros(),
    }
}

/// What rounding can make of `X_jᵀ I X_j`.
#[inline(always)]
fn rounding(inertia: &ArticulatedInertia<f64>, column: &Vector6<f64>) -> f64 {
    let (angular, linear) = split(column);
    let size = dot(&angular, &angular) * inertia.angular.trace()
        + dot(&linear, &linear) * inertia.linear.trace();
    ROUNDINGS * f64::EPSILON * size
}

/// `I ← I − Σ_j Y_j Y_jᵀ / d_j`, with what it takes to do the same to wrenches.
#[inline(always)]
pub(super) fn inertia<J, T, const N: usize, const K: usize, const S: usize, const C: usize>(
    inertia: &mut ArticulatedInertia<f64>,
    columns: &[Vector6<f64>; S],
    armature: &[f64],
    pivots: &mut [Pivot<f64>; S],
) -> Result<(), PivotFailure>
where
    J: Joint<N, K, S, C>,
{
    let whole = *inertia;
    for j in 0..S {
        let column = &columns[j];
        let y = momentum::<J, f64, N, K, S, C>(inertia, column);
        let own = power::<J, f64, N, K, S, C>(column, &y);
        let pivot = own + armature.get(j).copied().unwrap_or(0.0);
        let limit = rounding(&whole, column);
        if pivot.is_nan() || pivot <= limit {
            return Err(PivotFailure {
                speed: j,
                pivot,
                limit,
            });
        }
        let inverse = 1.0 / pivot;
        pivots[j] = Pivot {
            momentum: y,
            inverse,
        };
        inertia.add_outer(&y, -inverse);
    }
    if armature.is_empty() {
        forget::<J, N, K, S, C>(inertia);
    }
    Ok(())
}

/// What a joint cannot pass on is set to the zero that it is, where elimination leaves rounding.
///
/// `I X̄ = 0` after elimination: a joint that turns in all directions transmits no moment, one that slides in all directions no force.
#[inline(always)]
fn forget<J, const N: usize, const K: usize, const S: usize, const C: usize>(
    inertia: &mut ArticulatedInertia<f64>,
) where
    J: Joint<N, K, S, C>,
{
    match (S, Parts::any::<J, N, K, S, C>()) {
        (3, (true, false)) => {
            inertia.angular = Symmetric3::zero();
            inertia.coupling = Matrix3::zeros();
        }
        (3, (false, true)) => {
            inertia.linear = Symmetric3::zero();
            inertia.coupling = Matrix3::zeros();
        }
        (6, _) => *inertia = ArticulatedInertia::zero(),
        _ => {}
    }
}

/// `F + Σ_j Y_j t_j` with the loads `t_j = (f_j − X_jᵀ F) / d_j`.
#[inline(always)]
pub(super) fn wrench<J, T, const N: usize, const K: usize, const S: usize, const C: usize>(
    wrench: &Vector6<T>,
    columns: &[Vector6<T>; S],
    pivots: &[Pivot<T>; S],
    forces: &[T; S],
    loads: &mut [T; S],
) -> Vector6<T>
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    let mut wrench = *wrench;
    for j in 0..S {
        let carried = power::<J, T, N, K, S, C>(&columns[j], &wrench);
        loads[j] = (forces[j] - carried) * pivots[j].inverse;
        wrench = add_weighted(&wrench, &pivots[j].momentum, loads[j]);
    }
    wrench
}

/// `A + Σ_j X_j x_j` with the rates `x_j = t_j − Y_jᵀ A / d_j`, last freedom first.
#[inline(always)]
pub(super) fn motion<J, T, const N: usize, const K: usize, const S: usize, const C: usize>(
    motion: &Vector6<T>,
    columns: &[Vector6<T>; S],
    pivots: &[Pivot<T>; S],
    loads: &[T; S],
    rates: &mut [T; S],
) -> Vector6<T>
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    let mut motion = *motion;
    for j in (0..S).rev() {
        let ((moment, force), (angular, linear)) = (split(&pivots[j].momentum), split(&motion));
        let carried = dot(&moment, &angular) + dot(&force, &linear);
        rates[j] = loads[j] - carried * pivots[j].inverse;
        motion = add_weighted(&motion, &columns[j], rates[j]);
    }
    motion
}
