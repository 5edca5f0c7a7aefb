//! Keeps `src/joints`, `pages` and `JOINTS.md` what the specs in `joint-specs` say, in this workspace alone.

use std::env;
use std::path::{Path, PathBuf};

fn main() -> Result<(), hamel_codegen::BuildError> {
    println!("cargo::rerun-if-changed=build.rs");
    if !in_own_workspace() {
        return Ok(());
    }
    hamel_codegen::Build::new()
        .specs("../joint-specs")
        .runtime("hamel_runtime")
        .accuracy("kernel_accuracy.csv")
        .library("src/joints", "pages")
        .compile()
}

/// Whether the specs are at hand to be worked on: not in a packaged or vendored copy, nor in a checkout made by cargo.
fn in_own_workspace() -> bool {
    let beside = Path::new("..");
    let is_checkout = match (env::var_os("CARGO_MANIFEST_DIR"), cargo_home()) {
        (Some(manifest), Some(home)) => Path::new(&manifest).starts_with(home),
        _ => false,
    };
    beside.join("joint-specs").is_dir() && beside.join("Cargo.toml").is_file() && !is_checkout
}

/// Where cargo keeps its checkouts.
fn cargo_home() -> Option<PathBuf> {
    let home = || {
        Some(
            PathBuf::from(env::var_os("HOME").or_else(|| env::var_os("USERPROFILE"))?)
                .join(".cargo"),
        )
    };
    env::var_os("CARGO_HOME").map(PathBuf::from).or_else(home)
}
