//! The joint library of Hamel.
//!
//! Each module of [`joints`] is generated from a spec file and holds one joint: its type, its kernels as an
//! implementation of [`hamel_runtime::joint::Joint`], the claims that were proved of it, and its registry entry.
//! [`registry`] hands all of them to a scene loader by name; [`for_each_joint!`] hands their types to a macro, so that a test
//! suite covers a new spec by itself. Nothing under `src/joints` is written by hand.
#![no_std]
#![forbid(unsafe_code)]

#[rustfmt::skip]
pub mod joints;

pub use joints::*;

#[cfg(feature = "alloc")]
use hamel_runtime::registry::JointRegistry;

/// The largest error of each kernel against its definition in 256 bits, in units of the last place, as CSV with a line of names.
pub const KERNEL_ACCURACY: &str = include_str!("../kernel_accuracy.csv");

/// A registry of every joint of the library.
#[cfg(feature = "alloc")]
pub fn registry() -> JointRegistry {
    let mut registry = JointRegistry::new();
    for entry in ENTRIES {
        // Names are names of modules, hence distinct.
        let _ = registry.insert(*entry);
    }
    registry
}

/// Name and text of every spec of the library, in alphabetic order.
pub fn specs() -> impl Iterator<Item = (&'static str, &'static str)> {
    SPECS.iter().copied()
}

/// The text of the spec called `name`.
pub fn spec(name: &str) -> Option<&'static str> {
    specs()
        .find(|(candidate, _)| *candidate == name)
        .map(|(_, text)| text)
}
