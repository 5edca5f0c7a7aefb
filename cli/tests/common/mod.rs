//! The program, run in the root of the repository.

use std::path::Path;
use std::process::{Command, Output};

/// What comes of these arguments.
pub fn hamel(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hamel"));
    command.current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."));
    command
        .args(arguments)
        .output()
        .expect("the program starts")
}

/// What it prints where it succeeds.
pub fn stdout(arguments: &[&str]) -> String {
    let output = hamel(arguments);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {stderr}");
    String::from_utf8(output.stdout).expect("text")
}
