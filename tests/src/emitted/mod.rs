//! Compiled scenes as a user has them: modules that the build script writes, and two short ones that are committed to be read. The test `dynamics emitted`
//! keeps those as they are written.

/// `tests/data/scenes/ball_chain.toml`: with loops over like links.
pub mod ball_chain {
    include!(concat!(env!("OUT_DIR"), "/ball_chain.rs"));
}
/// Both forms of `data/scenes/geodesic_springs.toml`: logarithms of rotations.
pub mod geodesic_springs {
    include!(concat!(env!("OUT_DIR"), "/geodesic_springs.rs"));
}
/// `tests/data/scenes/pendulum.toml`: one joint in general position.
#[rustfmt::skip]
pub mod pendulum;
/// All functions of `scenes/plate_cart_arm.toml`, with lanes.
pub mod plate_cart_arm {
    include!(concat!(env!("OUT_DIR"), "/plate_cart_arm.rs"));
}
/// Both forms of `scenes/snakeboard.toml`: constraints that couple joints, and a prescribed motion.
#[rustfmt::skip]
pub mod snakeboard;
