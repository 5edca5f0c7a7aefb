//! Kernels allocate nothing, hold no unsafe code, and build where there is neither standard library nor allocator.

use hamel::scalar::{Dual, F64x4};
use std::path::Path;
use std::process::Command;

#[path = "../../no_std/src/kernels.rs"]
mod kernels;

fn allocations(work: impl FnOnce()) -> u64 {
    allocation_counter::measure(work).count_total
}

#[test]
fn kernels_allocate_nothing() {
    // The counter counts.
    assert!(allocations(|| drop(std::hint::black_box(vec![1]))) > 0);
    let displacement = std::hint::black_box(0.3);
    assert_eq!(
        allocations(|| _ = std::hint::black_box(kernels::of_library(displacement))),
        0
    );
    assert_eq!(
        allocations(|| _ = std::hint::black_box(kernels::of_library(displacement as f32))),
        0
    );
    assert_eq!(
        allocations(|| _ = std::hint::black_box(kernels::of_library(Dual::variable(displacement)))),
        0
    );
    assert_eq!(
        allocations(|| _ = std::hint::black_box(kernels::of_library(F64x4::new([displacement; 4])))),
        0
    );
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
