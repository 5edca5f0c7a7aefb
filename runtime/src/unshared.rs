//! Joints of any type where there is no allocator: they cannot be shared. Their types and kernels serve as they are.
//!
//! Stands for the module `erased` of the feature `alloc`, so that generated entries of a registry mean something: building a
//! joint then checks its parameters and keeps nothing.

use crate::joint::Joint;

/// What an entry of a registry builds: nothing, without an allocator.
pub type Shared = ();

/// Drops a joint that cannot be shared.
pub fn erase<J, const N: usize, const K: usize, const S: usize, const C: usize>(_: J) -> Shared
where
    J: Joint<N, K, S, C>,
{
}
