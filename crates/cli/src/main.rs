//! The program `hamel`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(hamel_cli::run(std::env::args_os()))
}
