//! Kernels allocate nothing, hold no unsafe code, and build where there is neither standard library nor allocator.

use std::path::Path;
use std::process::Command;

#[path = "../../no_std/src/kernels.rs"]
mod kernels;

fn allocations(work: impl FnOnce()) -> u64 {
    allocation_counter::measure(work).count_total
}

/// In doubles: kernels are one code for all scalars, none of which owns memory.
#[test]
fn kernels_allocate_nothing() {
    // The counter counts.
    assert!(allocations(|| drop(std::hint::black_box(vec![1]))) > 0);
    let displacement = std::hint::black_box(0.3);
    let evaluate = || _ = std::hint::black_box(kernels::of_library(displacement));
    assert_eq!(allocations(evaluate), 0);
}

/// The crates that hold kernels forbid unsafe code; the compiler refuses it then, in generated files as in others.
#[test]
fn unsafe_code_is_forbidden() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for file in ["generated/src/lib.rs", "runtime/src/lib.rs"] {
        let text = std::fs::read_to_string(root.join(file)).expect("a crate of the workspace");
        assert!(text.contains("\n#![forbid(unsafe_code)]\n"), "{file}");
    }
}

#[test]
#[ignore = "compiles the library anew"]
fn the_library_builds_without_std_and_allocator() {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("no_std/Cargo.toml");
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("no_std");
    let mut cargo = Command::new(env!("CARGO"));
    cargo
        .args(["build", "--locked", "--manifest-path"])
        .arg(manifest);
    let status = cargo
        .env("CARGO_TARGET_DIR", target)
        .status()
        .expect("cargo runs");
    assert!(status.success());
}
