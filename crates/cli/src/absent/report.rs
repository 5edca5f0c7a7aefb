//! What stands for `hamel report` in a program that was built without it.

use hamel::registry::JointRegistry;
use hamel_console::output::Failure;
use std::ffi::OsString;

/// Report error against run time (not built into this program: needs `--features report`)
#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub struct Args {
    /// Whatever is said, so that the answer is about the feature.
    #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
    rest: Vec<OsString>,
}

/// Says what to build.
///
/// # Errors
/// Always.
pub fn run(_: &Args, _: &JointRegistry) -> Result<(), Failure> {
    Err(Failure::Options(String::from(
        "this program was built without `hamel report`: build it with the feature, `cargo run --release -p hamel-cli --features report -- report`",
    )))
}
