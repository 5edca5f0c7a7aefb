//! Compiled scenes as a user has them: what `hamel compile` writes, committed. The test `emitted` keeps them as they are written.

/// Both forms of `scenes/report/ball_spring.toml`: a logarithm of rotations.
#[rustfmt::skip]
pub mod ball_spring;
/// `scenes/plate_cart_arm.toml`.
#[rustfmt::skip]
pub mod plate_cart_arm;
