//! Joints behind one object-safe trait, so that a mechanism holds joints of any type.
//!
//! [`AnyJoint`] is [`Joint`] over slices, and one joint's share in the recursions; [`erase`] implements it for every joint. [`ExtendedJoint`] is what iterative refinement takes of a joint. Matrices are
//! stored column by column, and the K slices of a derivative in ϕ one after the other. Nothing here allocates.

mod adapter;
mod any_joint;
mod extended;
mod kernels;
mod slices;
mod stored;

pub use any_joint::AnyJoint;
pub use extended::ExtendedJoint;
pub(crate) use slices::{Store, nan};

use crate::joint::Joint;
use alloc::sync::Arc;

/// Sizes of a joint, or their sums over a mechanism.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layout {
    /// N: stored scalars of Q.
    pub configuration: usize,
    /// K: degrees of freedom, the size of v and of ϕ.
    pub freedoms: usize,
    /// S: speeds, the size of v̄ and of p̄.
    pub speeds: usize,
    /// C: nonholonomic constraints, the size of λ.
    pub constraints: usize,
}

/// A finite map of a joint has no value: a Newton iteration does not converge, or its arguments are not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the {map} of joint type `{joint}` cannot be found: Newton's method does not converge here, or the configuration is not \
     finite or of another size"
)]
pub struct FiniteMapError {
    /// Joint type.
    pub joint: &'static str,
    /// `local coordinates` or `projection`.
    pub map: &'static str,
}

/// A joint of any type, shared: what an entry of a registry builds.
pub type Shared = Arc<dyn AnyJoint>;

/// Puts a joint behind [`AnyJoint`].
pub fn erase<J, const N: usize, const K: usize, const S: usize, const C: usize>(joint: J) -> Shared
where
    J: Joint<N, K, S, C>,
{
    Arc::new((joint, Sizes::<N, K, S, C>))
}

/// The sizes of a joint as a type, beside which the pair `(J, Sizes)` is the adapter behind [`erase`].
///
/// A pair and not a struct around J: rustc puts the code of an `impl` for a pair beside the pair's first type. So each joint is compiled
/// on its own, and an edit of one spec leaves the others as they are.
#[derive(Debug)]
pub(crate) struct Sizes<const N: usize, const K: usize, const S: usize, const C: usize>;
