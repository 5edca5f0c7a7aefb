//! The JSON of `rustdoc` for every crate of the workspace.

use std::env;
use std::error::Error;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Holds the program that this one stands in for, when cargo calls it.
const VARIABLE: &str = "HAMEL_API_RUSTDOC";
const FLAGS: &str = "-Z unstable-options --output-format json --cap-lints allow";

/// The `rustdoc` to stand in for, where cargo calls this program in its place.
pub fn asked() -> Option<OsString> {
    env::var_os(VARIABLE)
}

/// Calls `rustdoc` with the arguments of this program, as a compiler that may use what is unstable.
pub fn run(program: &OsString) -> ExitCode {
    let mut command = Command::new(program);
    command.args(env::args_os().skip(1));
    match command.env("RUSTC_BOOTSTRAP", "1").status() {
        Ok(status) if status.success() => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{}: {error}", program.display());
            ExitCode::FAILURE
        }
    }
}

/// The folder with `NAME.json` for each crate. All crates of the workspace together, with the features that they ask of each other: what `cargo doc --workspace`
/// has compiled is then not compiled again.
pub fn json(root: &Path) -> Result<PathBuf, Box<dyn Error>> {
    let target = root.join("target");
    let rustdoc = env::var_os("RUSTDOC").unwrap_or_else(|| "rustdoc".into());
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(root).args([
        "doc",
        "--workspace",
        "--no-deps",
        "--locked",
        "--quiet",
        "--target-dir",
    ]);
    cargo.arg(&target);
    cargo
        .env("RUSTDOCFLAGS", FLAGS)
        .env("RUSTDOC", env::current_exe()?)
        .env(VARIABLE, rustdoc);
    match cargo.status()?.success() {
        true => Ok(target.join("doc")),
        false => Err("cargo cannot document the workspace".into()),
    }
}
