//! Compiled scenes as a user has them: what `hamel compile` writes, committed. The test `emitted` keeps them as they are written.

/// `scenes/plate_cart_arm.toml`.
#[rustfmt::skip]
pub mod plate_cart_arm;
