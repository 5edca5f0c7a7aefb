//! Joints of one's own, beside the library's: general Φ, declared manifolds, subgroups.

use hamel::registry::{JointEntry, JointRegistry};

/// The joints that the build script generated.
pub mod joints {
    include!(concat!(env!("OUT_DIR"), "/joints.rs"));
}

/// Joints with curves. Differences across a knot are off by a jump: of a cubic curve by that of its third derivative, times the distance.
pub const WITH_KNOTS: [&str; 3] = ["cam_circle", "measured_rocker", "valley"];

/// Joints that random trees leave out: random parameters and displacements do not put these platforms together, one has more degrees of freedom than trees of them need, and one is a plain
/// hinge. They have the law suite, most of them the test by Gauss's principle, with parameters of their own.
const ALONE: [&str; 7] = [
    "delta",
    "five_bar_left",
    "five_bar_rods",
    "fixed_axis",
    "rollers",
    "stewart",
    "three_rrr",
];

// An entry is a constant: what it builds is compiled wherever it is named. By the functions below it is compiled once, and not again with the tests.

/// All joints of [`joints`].
pub fn entries() -> Vec<JointEntry> {
    joints::ENTRIES.to_vec()
}

/// The joints of which random trees are made.
pub fn of_trees() -> impl Iterator<Item = JointEntry> {
    let entries = entries().into_iter();
    entries.filter(|entry| !ALONE.contains(&entry.name))
}

/// All joints of [`mod@held_out`].
pub fn held_out() -> JointRegistry {
    let mut registry = JointRegistry::new();
    for entry in held_out::ENTRIES {
        // Names are names of modules, hence distinct.
        let _ = registry.insert(*entry);
    }
    registry
}

/// All joints of [`mod@names`].
pub fn names() -> Vec<JointEntry> {
    names::ENTRIES.to_vec()
}

/// Joints unlike those of the library, which the generator's own tests derive.
pub mod held_out {
    include!(concat!(env!("OUT_DIR"), "/held_out/joints.rs"));
}

/// Joints whose names and parameters are called like what emitted files use.
#[allow(
    clippy::too_many_arguments,
    unused_imports,
    reason = "one joint has every name as a parameter, the names of imports among them"
)]
pub mod names {
    include!(concat!(env!("OUT_DIR"), "/names/joints.rs"));
}

/// Joints with odd names, and with texts that look like code, markup and instructions: what is emitted of them gives no warning of the compiler, nor of
/// its documentation.
#[deny(warnings)]
pub mod odd {
    include!(concat!(env!("OUT_DIR"), "/odd/joints.rs"));
}
