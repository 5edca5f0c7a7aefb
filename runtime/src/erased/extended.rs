//! [`ExtendedJoint`]: one joint's share in inverse dynamics in numbers of 106 bits, which iterative refinement takes its residuals from.

use super::slices::{Store, array, array_mut, nan};
use super::stored::{self, stored};
use super::{FiniteMapError, Sizes};
use crate::joint::Joint;
use crate::matrix::of_columns;
use crate::scalar::{Extended, Scalar};
use crate::spatial::Pose;
use crate::steps::{Motion, Steps};
use core::fmt::Debug;
use nalgebra::Vector6;

/// A joint of any type in numbers of 106 bits, as far as inverse dynamics goes; shapes and frames are as in [`AnyJoint`](super::AnyJoint).
///
/// It holds little code of its own: what does not depend on the joint is compiled once.
pub trait ExtendedJoint: Debug + Send + Sync {
    /// [`Joint::project`] in place.
    ///
    /// # Errors
    /// When the result is not finite: Newton's method did not converge, or the configuration is not finite or of another size.
    fn project(&self, q: &mut [Extended]) -> Result<(), FiniteMapError>;
    /// [`AnyJoint::advance`](super::AnyJoint::advance) at the `state` (q, v̄) and v̄̇ = 0.
    fn advance(
        &self,
        state: (&[Extended], &[Extended]),
        joint_frame: &Pose<Extended>,
        parent: &Motion<Extended>,
        own: &mut Motion<Extended>,
        columns: &mut [Vector6<Extended>],
    );
    /// The row `P S̄` of one port into `out`, one entry per speed; NaN of a port that is not there.
    fn port_speed_row(&self, q: &[Extended], port: usize, out: &mut [Extended]);
}

/// The error of a finite map unless there are `size` values, all finite.
pub(super) fn check_finite<T: Scalar<Mask = bool>>(
    joint: &'static str,
    map: &'static str,
    values: &[T],
    size: usize,
) -> Result<(), FiniteMapError> {
    let infinity = T::from_f64(f64::INFINITY);
    let is_finite = |value: &T| (-infinity).less(*value) && value.less(infinity);
    match values.len() == size && values.iter().all(is_finite) {
        true => Ok(()),
        false => Err(FiniteMapError { joint, map }),
    }
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> ExtendedJoint
    for (J, Sizes<N, K, S, C>)
where
    J: Joint<N, K, S, C>,
{
    fn project(&self, q: &mut [Extended]) -> Result<(), FiniteMapError> {
        let found = self.0.project(&stored(&self.0, q));
        stored::store(&self.0, &found, q);
        check_finite(self.0.facts().name, "projection", q, stored::size(&self.0))
    }

    fn advance(
        &self,
        (q, speeds): (&[Extended], &[Extended]),
        joint_frame: &Pose<Extended>,
        parent: &Motion<Extended>,
        own: &mut Motion<Extended>,
        columns: &mut [Vector6<Extended>],
    ) {
        let q = stored::exactly(&self.0, q);
        let arrays = (q, array(speeds), array_mut(columns));
        let (Some(q), Some(speeds), Some(own_columns)) = arrays else {
            *own = Motion::unknown();
            return columns.fill(Vector6::repeat(nan()));
        };
        let state = (&q, &of_columns([*speeds]));
        *own = Steps(&self.0).advance_shared(state, joint_frame, parent, own_columns);
    }

    fn port_speed_row(&self, q: &[Extended], port: usize, out: &mut [Extended]) {
        Steps(&self.0)
            .speed_row(&stored(&self.0, q), port)
            .store(out);
    }
}
