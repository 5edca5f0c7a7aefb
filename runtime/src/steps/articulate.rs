//! Elimination of a joint's degrees of freedom from the inertia and the wrench of what it carries, one degree of freedom after the other.

use super::Steps;
use crate::erased::nan;
use crate::joint::Joint;
use crate::scalar::Scalar;
use crate::spatial::fused::{add_scaled, cross, dot};
use crate::spatial::{ArticulatedInertia, SpatialInertia, Symmetric3, add_weighted, join, split};
use nalgebra::{Matrix3, Vector3, Vector6};

/// How many roundings of the inertia's own size a pivot must stand above: those of its products, of the shift and of the
/// update, with a margin of four.
const ROUNDINGS: f64 = 64.0;

/// One eliminated degree of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pivot<T> {
    /// `Y_j = I X_j`: the momentum of one unit of its speed, with those before it free.
    pub momentum: Vector6<T>,
    /// `1 / d_j`, of the inertia `d_j = X_jᵀ Y_j`.
    pub inverse: T,
}

impl<T: Scalar> Pivot<T> {
    /// Of a degree of freedom not yet eliminated.
    pub fn zero() -> Self {
        Self {
            momentum: Vector6::zeros(),
            inverse: T::zero(),
        }
    }
}

/// A degree of freedom that moves no inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PivotFailure<T = f64> {
    /// Which of the joint's speeds.
    pub speed: usize,
    /// `d_j`.
    pub pivot: T,
    /// What its rounding amounts to.
    pub limit: T,
}

impl<T: Scalar> PivotFailure<T> {
    /// Of a pivot that is not known.
    pub(crate) fn unknown() -> Self {
        Self {
            speed: 0,
            pivot: nan(),
            limit: nan(),
        }
    }
}

/// An inertia, rigid or articulated, that can be applied to half a twist at less than the whole cost.
pub(crate) trait Inertia<T> {
    /// The momentum of a twist.
    fn of(&self, twist: &Vector6<T>) -> Vector6<T>;
    /// The momentum of a rotation about the origin.
    fn of_angular(&self, angular: &Vector3<T>) -> Vector6<T>;
    /// The momentum of a translation.
    fn of_linear(&self, linear: &Vector3<T>) -> Vector6<T>;
}

impl<T: Scalar> Inertia<T> for ArticulatedInertia<T> {
    #[inline(always)]
    fn of(&self, twist: &Vector6<T>) -> Vector6<T> {
        self.apply(twist)
    }
    #[inline(always)]
    fn of_angular(&self, angular: &Vector3<T>) -> Vector6<T> {
        self.apply_angular(angular)
    }
    #[inline(always)]
    fn of_linear(&self, linear: &Vector3<T>) -> Vector6<T> {
        self.apply_linear(linear)
    }
}

impl<T: Scalar> Inertia<T> for SpatialInertia<T> {
    #[inline(always)]
    fn of(&self, twist: &Vector6<T>) -> Vector6<T> {
        self.apply(twist)
    }
    #[inline(always)]
    fn of_angular(&self, angular: &Vector3<T>) -> Vector6<T> {
        self.apply_angular(angular)
    }
    #[inline(always)]
    fn of_linear(&self, linear: &Vector3<T>) -> Vector6<T> {
        join(&cross(&self.first_moment, linear), &(linear * self.mass))
    }
}

/// What rounding can make of `Xᵀ I X`.
pub(crate) fn rounding<T: Scalar>(inertia: &ArticulatedInertia<T>, column: &Vector6<T>) -> T {
    let (angular, linear) = split(column);
    let size = dot(&angular, &angular) * inertia.angular.trace()
        + dot(&linear, &linear) * inertia.linear.trace();
    T::from_f64(ROUNDINGS) * T::epsilon() * size
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Steps<'_, J, N, K, S, C>
where
    J: Joint<N, K, S, C>,
{
    /// `X_jᵀ F`, without the part that this column does not have.
    #[inline(always)]
    pub(crate) fn power<T: Scalar>(j: usize, column: &Vector6<T>, wrench: &Vector6<T>) -> T {
        let ((angular, linear), (moment, force)) = (split(column), split(wrench));
        match Self::column_parts(j) {
            (true, true) => dot(&angular, &moment) + dot(&linear, &force),
            (true, false) => dot(&angular, &moment),
            (false, true) => dot(&linear, &force),
            (false, false) => T::zero(),
        }
    }

    /// `I X_j`, without the part that this column does not have.
    #[inline(always)]
    pub(crate) fn momentum<T: Scalar>(
        inertia: &impl Inertia<T>,
        j: usize,
        column: &Vector6<T>,
    ) -> Vector6<T> {
        let (angular, linear) = split(column);
        match Self::column_parts(j) {
            (true, true) => inertia.of(column),
            (true, false) => inertia.of_angular(&angular),
            (false, true) => inertia.of_linear(&linear),
            (false, false) => Vector6::zeros(),
        }
    }

    /// What rounding can make of `X_jᵀ I X_j`, from the traces of the angular and of the linear part of I.
    #[inline(always)]
    fn rounding<T: Scalar>((moments, masses): (T, T), j: usize, column: &Vector6<T>) -> T {
        let (angular, linear) = split(column);
        let (turns, slides) = Self::column_parts(j);
        let mut size = T::zero();
        if turns {
            size += dot(&angular, &angular) * moments;
        }
        if slides {
            size += dot(&linear, &linear) * masses;
        }
        T::from_f64(ROUNDINGS) * T::epsilon() * size
    }

    /// `I ← I − Σ_j Y_j Y_jᵀ / d_j`, with what it takes to do the same to wrenches.
    #[inline(always)]
    pub(crate) fn inertia<T: Scalar<Mask = bool>>(
        inertia: &mut ArticulatedInertia<T>,
        columns: &[Vector6<T>; S],
        armature: &[T],
        pivots: &mut [Pivot<T>; S],
    ) -> Result<(), PivotFailure<T>> {
        if armature.is_empty() {
            let mut rest = *inertia;
            Self::freedoms(&mut rest, columns, &[T::zero(); S], pivots)?;
            Self::forget(&mut rest);
            *inertia = rest;
            return Ok(());
        }
        let Ok(armature) = armature.try_into() else {
            return Err(PivotFailure::unknown());
        };
        Self::freedoms(inertia, columns, armature, pivots)
    }

    #[inline(always)]
    fn freedoms<T: Scalar<Mask = bool>>(
        inertia: &mut ArticulatedInertia<T>,
        columns: &[Vector6<T>; S],
        armature: &[T; S],
        pivots: &mut [Pivot<T>; S],
    ) -> Result<(), PivotFailure<T>> {
        let whole = (inertia.angular.trace(), inertia.linear.trace());
        for j in 0..S {
            let column = &columns[j];
            let y = Self::momentum(inertia, j, column);
            let pivot = Self::power(j, column, &y) + armature[j];
            let limit = Self::rounding(whole, j, column);
            // Nor does NaN stand above anything.
            if !limit.less(pivot) {
                return Err(PivotFailure {
                    speed: j,
                    pivot,
                    limit,
                });
            }
            let inverse = T::one() / pivot;
            pivots[j] = Pivot {
                momentum: y,
                inverse,
            };
            inertia.add_outer(&y, -inverse);
        }
        Ok(())
    }

    /// What a joint cannot pass on is set to the zero that it is, where elimination leaves rounding.
    ///
    /// `I X̄ = 0` after elimination: a joint that turns in all directions transmits no moment, one that slides in all directions no force.
    #[inline(always)]
    fn forget<T: Scalar>(inertia: &mut ArticulatedInertia<T>) {
        match (S, Self::parts()) {
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
    pub(crate) fn wrench<T: Scalar>(
        wrench: &Vector6<T>,
        columns: &[Vector6<T>; S],
        pivots: &[Pivot<T>; S],
        forces: &[T; S],
        loads: &mut [T; S],
    ) -> Vector6<T> {
        let mut wrench = *wrench;
        for j in 0..S {
            let carried = Self::power(j, &columns[j], &wrench);
            loads[j] = (forces[j] - carried) * pivots[j].inverse;
            wrench = add_weighted(&wrench, &pivots[j].momentum, loads[j]);
        }
        wrench
    }

    /// `A + Σ_j X_j x_j` with the rates `x_j = t_j − Y_jᵀ A / d_j`, last degree of freedom first.
    #[inline(always)]
    pub(crate) fn motion<T: Scalar>(
        motion: &Vector6<T>,
        columns: &[Vector6<T>; S],
        pivots: &[Pivot<T>; S],
        loads: &[T; S],
        rates: &mut [T; S],
    ) -> Vector6<T> {
        let mut motion = *motion;
        for j in (0..S).rev() {
            let ((moment, force), (angular, linear)) = (split(&pivots[j].momentum), split(&motion));
            let carried = dot(&moment, &angular) + dot(&force, &linear);
            rates[j] = loads[j] - carried * pivots[j].inverse;
            let (turn, slide) = split(&columns[j]);
            let (turns, slides) = Self::column_parts(j);
            let turned = if turns {
                add_scaled(&angular, &turn, rates[j])
            } else {
                angular
            };
            let slid = if slides {
                add_scaled(&linear, &slide, rates[j])
            } else {
                linear
            };
            motion = join(&turned, &slid);
        }
        motion
    }
}
