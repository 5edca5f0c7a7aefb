//! One joint's share in what is done with a mechanism: each step written once, generic in the joint and the scalar, on arrays of the joint's own sizes.
//!
//! [`AnyJoint`](crate::erased::AnyJoint) hands them slices.
//!
//! **Frames.** Every spatial vector of body i is read at the origin of its joint's child frame, in **world axes**. Going from one
//! body to the next is then a shift by [`Placement::offset`] without a rotation.
//!
//! **Freedoms one by one.** A joint with S speeds is eliminated as S joints of one speed in a row, the first column nearest to the child:
//! with columns `X_j` of X̄, `Y_j = I X_j`, `d_j = X_jᵀ Y_j`, then `I ← I − Y_j Y_jᵀ / d_j`. This is the LDLᵀ factorisation of `X̄ᵀ I X̄`, and
//! neither L nor an inverse is ever formed.

mod articulate;
mod chart;
mod directions;
mod motion_gradient;
mod pattern;
mod place;
mod power;
mod rotors;
mod second;
mod slopes;
mod vary;

pub(crate) use articulate::rounding;
pub use articulate::{Pivot, PivotFailure};
pub use chart::ChartDerivatives;
pub(crate) use chart::Field;
pub use motion_gradient::{Carrying, MotionGradient};
pub use place::Placement;
pub use power::EffortLaw;
pub(crate) use rotors::AtPort;
pub use rotors::RotorTerm;
pub(crate) use second::VirtualState;
pub use vary::Variation;

use crate::erased::nan;
use crate::scalar::Scalar;
use nalgebra::Vector6;

/// The steps of one joint.
pub(crate) struct Steps<'a, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    pub(crate) &'a J,
);

/// The motion of a joint's child frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<T> {
    /// Where it is.
    pub placement: Placement<T>,
    /// V.
    pub twist: Vector6<T>,
    /// V̇.
    pub rate: Vector6<T>,
}

impl<T: Scalar> Motion<T> {
    /// NaN.
    pub(crate) fn unknown() -> Self {
        Self {
            placement: Placement::unknown(),
            twist: Vector6::repeat(nan()),
            rate: Vector6::repeat(nan()),
        }
    }
}
