//! What tests of scenes with joints of this crate share.

use hamel::registry::JointRegistry;

/// The library's joints and those of this crate.
pub fn registry() -> JointRegistry {
    let mut registry = hamel_joints::registry();
    registry
        .extend(hamel_downstream::entries())
        .expect("distinct names");
    registry
}
