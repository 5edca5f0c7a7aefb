//! The program, run in the root of the repository.
#![allow(dead_code, reason = "each test file uses its own part of this module")]

use std::path::Path;
use std::process::{Command, Output};

/// What comes of these arguments.
pub fn hamel(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hamel"));
    command.current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."));
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

/// The program as a command that an interrupt reaches: a shell that starts commands in the background lets them ignore it.
pub fn interruptible() -> Command {
    let program = env!("CARGO_BIN_EXE_hamel");
    let default = "--default-signal=INT,TERM,HUP";
    let has_option = Command::new("env").args([default, "true"]).output();
    if !has_option.is_ok_and(|output| output.status.success()) {
        return Command::new(program);
    }
    let mut command = Command::new("env");
    command.args([default, program]);
    command
}
