//! Generates this crate's joints from `joints/*.joint`.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    hamel_codegen::Build::new().specs("joints").compile()?;
    Ok(())
}
