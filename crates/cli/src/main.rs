//! The program `hamel`.

use std::process::ExitCode;

fn main() -> ExitCode {
    hamel_cli::main()
}
