//! What generation costs, apart from run time: each joint of the library derived and written out once.

use super::watch::Watch;
use hamel_codegen::emit::rust;
use hamel_console::output::Failure;
use serde::Serialize;

/// The cost of one joint.
#[derive(Clone, Debug, Serialize)]
pub struct Cost {
    pub joint: String,
    /// Parsing, expansion and proofs, ms.
    pub derive_ms: String,
    /// Writing of its Rust, ms.
    pub emit_ms: String,
    /// Lines of its spec and of its Rust.
    pub spec_lines: usize,
    pub rust_lines: usize,
    /// Size of its Rust, kB.
    pub rust_kb: String,
}

/// Of every joint of the library.
///
/// # Errors
/// A spec that is refused.
pub fn costs() -> Result<Vec<Cost>, Failure> {
    let costs = hamel_joints::specs().map(|(name, text)| {
        let file = format!("{name}.joint");
        let start = Watch::start();
        let derived =
            hamel_codegen::derive(text, &file).map_err(|errors| Failure::Spec(Box::new(errors)))?;
        let derive = start.seconds();
        let start = Watch::start();
        let code = rust::file(&derived, &file, &rust::Runtime::default())
            .map_err(|error| Failure::Page(error.to_string()))?;
        let milliseconds = |seconds: f64| format!("{:.1}", 1e3 * seconds);
        Ok(Cost {
            joint: name.into(),
            derive_ms: milliseconds(derive),
            emit_ms: milliseconds(start.seconds()),
            spec_lines: text.lines().count(),
            rust_lines: code.lines().count(),
            rust_kb: format!("{:.1}", code.len() as f64 / 1e3),
        })
    });
    costs.collect()
}
