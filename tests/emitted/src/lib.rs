//! Compiled scenes as a user has them: modules that the build script writes, and two short ones that are committed to be read. The test `dynamics emitted`
//! keeps those as they are written.

/// Both forms of `tests/data/urdf/loops/ankle.urdf`: two loops with rods, which six relations close.
pub mod ankle {
    include!(concat!(env!("OUT_DIR"), "/ankle.rs"));
}
/// `tests/data/scenes/ball_chain.toml`: with loops over like links.
pub mod ball_chain {
    include!(concat!(env!("OUT_DIR"), "/ball_chain.rs"));
}
/// Derivatives and M̄⁻¹ of `scenes/report/chain_8.toml`: loops over pairs of joints.
pub mod chain_8 {
    include!(concat!(env!("OUT_DIR"), "/chain_8.rs"));
}
/// Both forms of `scenes/report/crank_rocker.toml`: a loop.
pub mod crank_rocker {
    include!(concat!(env!("OUT_DIR"), "/crank_rocker.rs"));
}
/// `tests/data/scenes/double_pendulum.toml`, with lanes: rows of a sweep beside it.
pub mod double_pendulum {
    include!(concat!(env!("OUT_DIR"), "/double_pendulum.rs"));
}
/// Both forms of `scenes/report/geared_pendulum.toml`: a gear on a base that moves.
pub mod geared_pendulum {
    include!(concat!(env!("OUT_DIR"), "/geared_pendulum.rs"));
}
/// Both forms of `data/scenes/geodesic_springs.toml`: logarithms of rotations.
pub mod geodesic_springs {
    include!(concat!(env!("OUT_DIR"), "/geodesic_springs.rs"));
}
/// Both forms of `scenes/humanoid.toml`: loops between hinges.
pub mod humanoid {
    include!(concat!(env!("OUT_DIR"), "/humanoid.rs"));
}
/// `tests/data/scenes/linkages.toml`, with lanes: loops within joints, and rotors at their ports.
pub mod linkages {
    include!(concat!(env!("OUT_DIR"), "/linkages.rs"));
}
/// `tests/data/scenes/loops.toml`, with lanes: loops that `[[loop]]` closes.
pub mod loops {
    include!(concat!(env!("OUT_DIR"), "/loops.rs"));
}
/// `tests/data/scenes/pendulum.toml`: one joint in general position.
#[rustfmt::skip]
pub mod pendulum;
/// All functions of `scenes/plate_cart_arm.toml`, with lanes.
pub mod plate_cart_arm {
    include!(concat!(env!("OUT_DIR"), "/plate_cart_arm.rs"));
}
/// Both forms of `scenes/report/slider_crank_offset.toml`: a loop with a slide.
pub mod slider_crank_offset {
    include!(concat!(env!("OUT_DIR"), "/slider_crank_offset.rs"));
}
/// Both forms of `scenes/snakeboard.toml`: constraints that couple joints, and a prescribed motion.
#[rustfmt::skip]
pub mod snakeboard;
/// Derivatives and M̄ of `tests/data/scenes/walker.toml`, with lanes: pairs of joints in lanes.
pub mod walker {
    include!(concat!(env!("OUT_DIR"), "/walker.rs"));
}
