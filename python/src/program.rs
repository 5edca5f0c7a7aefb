//! The program `hamel`, which the wheel installs.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the program with a command line that begins with its name; its exit code.
#[pyfunction]
pub fn run_program(py: Python<'_>, command_line: Vec<OsString>) -> u8 {
    py.detach(|| hamel_cli::run(command_line))
}
