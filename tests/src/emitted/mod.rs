//! Compiled scenes as a user has them: what `hamel compile` writes, committed. The test `emitted` keeps them as they are written.

/// `tests/data/scenes/ball_chain.toml`: with loops over like links.
#[rustfmt::skip]
pub mod ball_chain;
/// Both forms of `data/scenes/geodesic_springs.toml`: logarithms of rotations.
#[rustfmt::skip]
pub mod geodesic_springs;
/// `tests/data/scenes/pendulum.toml`: one joint in general position.
#[rustfmt::skip]
pub mod pendulum;
/// `scenes/plate_cart_arm.toml`.
#[rustfmt::skip]
pub mod plate_cart_arm;
/// Both forms of `scenes/snakeboard.toml`: constraints that couple joints, and a prescribed motion.
#[rustfmt::skip]
pub mod snakeboard;
