//! Compiles the scenes of this crate, as a user's build script does. The two short modules that are committed are written by the test
//! `dynamics emitted`.

use hamel_compiler::functions::Kind;
use hamel_compiler::{Build, Error, scene};

fn main() -> Result<(), Error> {
    println!("cargo::rerun-if-changed=build.rs");
    compiled("../../scenes/plate_cart_arm.toml", Kind::ALL)
        .lanes()
        .compile()?;
    compiled(
        "../data/scenes/geodesic_springs.toml",
        [
            Kind::ForwardDynamics,
            Kind::MomentumRates,
            Kind::Hamiltonian,
        ],
    )
    .compile()?;
    compiled(
        "../data/scenes/double_pendulum.toml",
        [Kind::ForwardDynamics],
    )
    .lanes()
    .compile()?;
    for linkage in ["crank_rocker", "geared_pendulum", "slider_crank_offset"] {
        let scene = format!("../../scenes/report/{linkage}.toml");
        compiled(
            &scene,
            [
                Kind::ForwardDynamics,
                Kind::MomentumRates,
                Kind::Hamiltonian,
            ],
        )
        .compile()?;
    }
    compiled(
        "../../scenes/humanoid.toml",
        [Kind::ForwardDynamics, Kind::MomentumRates],
    )
    .compile()?;
    compiled(
        "../data/scenes/loops.toml",
        [
            Kind::ForwardDynamics,
            Kind::InverseDynamics,
            Kind::MomentumRates,
            Kind::Hamiltonian,
            Kind::ForwardDerivatives,
        ],
    )
    .lanes()
    .compile()?;
    compiled(
        "../data/scenes/linkages.toml",
        [Kind::ForwardDynamics, Kind::InverseDynamics],
    )
    .lanes()
    .compile()?;
    compiled(
        "../data/scenes/walker.toml",
        [Kind::ForwardDerivatives, Kind::MassMatrix],
    )
    .lanes()
    .compile()?;
    compiled(
        "../data/urdf/loops/ankle.urdf",
        [
            Kind::ForwardDynamics,
            Kind::MomentumRates,
            Kind::Hamiltonian,
        ],
    )
    .compile()?;
    compiled(
        "../../scenes/report/chain_8.toml",
        [Kind::ForwardDerivatives, Kind::InverseMassMatrix],
    )
    .compile()?;
    compiled(
        "../data/scenes/ball_chain.toml",
        [Kind::ForwardDynamics, Kind::InverseDynamics],
    )
    .compile()
}

fn compiled(path: &str, functions: impl IntoIterator<Item = Kind>) -> Build {
    scene(path).specs("../../joint-specs").functions(functions)
}
