//! A child process that ends: by itself, at a time limit, or when its caller wants no more.

use std::fs::File;
use std::io;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Time between two looks at the child.
const LOOK: Duration = Duration::from_millis(5);

/// What came of a child.
#[derive(Debug)]
pub enum Ended {
    /// It ended by itself.
    Itself(ExitStatus),
    /// It was ended at the time limit.
    Late,
    /// It was ended since its caller wanted no more.
    Unwanted,
}

/// Runs a command without input, with all that it starts, for as long as `limit` and until `is_ended`; what it says on stderr goes to the file `said`, if
/// anywhere.
///
/// # Errors
/// A program that cannot be started, a file that cannot be written.
pub fn run(
    command: &mut Command,
    said: Option<&Path>,
    limit: Duration,
    is_ended: &dyn Fn() -> bool,
) -> io::Result<Ended> {
    // To a file, not through a pipe, which what it leaves behind could hold open.
    let stderr = match said {
        Some(path) => Stdio::from(File::create(path)?),
        None => Stdio::null(),
    };
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(stderr);
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    let start = Instant::now();
    let mut child = command.spawn()?;
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Ended::Itself(status));
        }
        let is_late = start.elapsed() > limit;
        if is_late || is_ended() {
            end(&mut child)?;
            return Ok(match is_late {
                true => Ended::Late,
                false => Ended::Unwanted,
            });
        }
        std::thread::sleep(LOOK);
    }
}

/// Ends the child with all that it has started.
fn end(child: &mut Child) -> io::Result<()> {
    #[cfg(unix)]
    {
        use nix::sys::signal::{Signal, killpg};
        use nix::unistd::Pid;
        // The group has the number of the child, which is ours until it is waited for; what is gone needs no end.
        if let Ok(group) = i32::try_from(child.id()) {
            let _ = killpg(Pid::from_raw(group), Signal::SIGKILL);
        }
    }
    #[cfg(not(unix))]
    child.kill()?;
    child.wait().map(drop)
}
