//! Joints of one's own, beside the library's: general Φ, declared manifolds, subgroups.

/// The joints that the build script generated.
pub mod joints {
    include!(concat!(env!("OUT_DIR"), "/joints.rs"));
}
