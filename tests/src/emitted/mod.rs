//! Compiled scenes as a user has them: what `hamel compile` writes, committed. The test `emitted` keeps them as they are written.

/// `tests/data/ball_chain.toml`: with loops over like links.
#[rustfmt::skip]
pub mod ball_chain;
/// `scenes/plate_cart_arm.toml`.
#[rustfmt::skip]
pub mod plate_cart_arm;
