//! Compiles the scene whose functions of many states run under AddressSanitizer.

fn main() -> Result<(), hamel_compiler::Error> {
    println!("cargo::rerun-if-changed=build.rs");
    hamel_compiler::scene("../../scenes/plate_cart_arm.toml")
        .specs("../../joint-specs")
        .functions([
            hamel_compiler::functions::Kind::ForwardDynamics,
            hamel_compiler::functions::Kind::InverseDynamics,
        ])
        .lanes()
        .compile()
}
