//! Generates the joints of `joints`, and the equations of `arm.toml`.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    hamel_codegen::Build::new().specs("joints").compile()?;
    hamel_compiler::scene("arm.toml")
        .library(hamel::joints::specs())
        .lanes()
        .compile()?;
    Ok(())
}
