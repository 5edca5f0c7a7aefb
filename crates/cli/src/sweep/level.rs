//! `--level`: the process computes at that level of instructions.
//!
//! The C library chooses its functions when a process starts. For a lower level than that of the machine the program starts itself anew, with what hides the others from it.

use hamel_console::output::Failure;
use hamel_sweep::level::{LEVELS, VARIABLE, environment, level};
use std::ffi::{OsStr, OsString};

/// Returns in a process that computes at the level.
///
/// # Errors
/// A level that the machine does not have, or that the program cannot start itself anew at.
pub fn ensure(wanted: &str) -> Result<(), Failure> {
    let own = level();
    if own == wanted {
        return Ok(());
    }
    let refused = |why: &str| {
        let told = format!("--level is {wanted}, and this process computes at {own}: {why}");
        Err(Failure::Options(told))
    };
    match environment(wanted) {
        _ if !LEVELS.contains(&own) => refused("such processors have that one alone"),
        None if std::env::var_os(VARIABLE).is_some() => refused(&format!(
            "{VARIABLE} hides it, or the machine does not have it"
        )),
        None => refused("the machine does not have it"),
        Some(hidden) => refused(&start_anew(hidden)),
    }
}

/// What the variable says, and this.
fn with(mut value: OsString, hidden: &str) -> OsString {
    if !value.is_empty() {
        value.push(":");
    }
    value.push(hidden);
    value
}

/// Does not return where it succeeds; else tells why.
#[cfg(unix)]
fn start_anew(hidden: &str) -> String {
    use std::os::unix::process::CommandExt;
    let program = match std::env::current_exe() {
        Ok(program) => program,
        Err(error) => return error.to_string(),
    };
    let value = with(std::env::var_os(VARIABLE).unwrap_or_default(), hidden);
    let mut arguments = std::env::args_os();
    let name = arguments.next();
    let name = name.as_deref().unwrap_or(OsStr::new("hamel"));
    let mut anew = std::process::Command::new(program);
    let error = anew.arg0(name).args(arguments).env(VARIABLE, value).exec();
    format!("the program cannot be started anew: {error}")
}

/// Elsewhere the process stays as it is.
#[cfg(not(unix))]
fn start_anew(hidden: &str) -> String {
    let value = with(OsString::new(), hidden);
    format!(
        "start the program with {VARIABLE}={} in its environment",
        value.display()
    )
}
