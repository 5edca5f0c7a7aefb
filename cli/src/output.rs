//! What goes wrong, and how it is told: in plain words on stderr.

use hamel_scene::Diagnostics;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Mistakes in a scene file.
    #[error("{0}")]
    Scene(#[from] Diagnostics),
    /// Mistakes in a spec.
    #[error("{0}")]
    Spec(Box<hamel_codegen::diagnostic::Diagnostics>),
    /// Failures of several joints, each told in full.
    #[error("{} joints were refused", .0.len())]
    Several(Vec<Failure>),
    /// A page that its template cannot show.
    #[error("the page cannot be rendered: {0}")]
    Page(String),
    /// A scene that cannot be compiled, told in full.
    #[error("{0}")]
    Refused(String),
    /// Options that contradict each other or the scene.
    #[error("{0}")]
    Options(String),
    /// The simulation stopped before its end.
    #[error("the simulation stopped: {0}")]
    Simulation(String),
    /// A file or stdout cannot be written.
    #[error("cannot write {target}: {error}")]
    Write {
        /// The file, or `stdout`.
        target: String,
        /// What the system says.
        error: io::Error,
    },
}

/// Refuses files to be written that are those to be read, or each other.
///
/// # Errors
/// The first of `written` that is met again, by its name.
pub fn refuse_overwriting<'a>(
    read: impl IntoIterator<Item = &'a PathBuf>,
    written: impl IntoIterator<Item = &'a Path>,
) -> Result<(), Failure> {
    // A file that is not there yet has no canonical path, but its folder has.
    let place = |path: &Path| {
        path.canonicalize().unwrap_or_else(|_| {
            let parent = path
                .parent()
                .filter(|parent| !parent.as_os_str().is_empty());
            let folder = parent.unwrap_or(Path::new(".")).canonicalize();
            folder
                .unwrap_or_default()
                .join(path.file_name().unwrap_or_default())
        })
    };
    let mut known: Vec<(PathBuf, &str)> = read
        .into_iter()
        .map(|path| (place(path), "is read"))
        .collect();
    for path in written {
        let own = place(path);
        if let Some((_, why)) = known.iter().find(|(other, _)| *other == own) {
            let shown = path.display();
            return Err(Failure::Options(format!(
                "{shown} would be overwritten: it {why} by the same command; name another file for the output"
            )));
        }
        known.push((own, "is written"));
    }
    Ok(())
}

impl Failure {
    /// The failure to write to stdout.
    pub fn stdout(error: io::Error) -> Self {
        Self::Write {
            target: "stdout".into(),
            error,
        }
    }

    /// The exit code that tells the failure to the caller: 2 for the command line, 1 for everything else.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Options(_) => ExitCode::from(2),
            _ => ExitCode::FAILURE,
        }
    }

    /// Whether the reader of stdout has gone, as `head` does when it has read enough: no failure of ours.
    pub fn is_broken_pipe(&self) -> bool {
        matches!(self, Self::Write { error, .. } if error.kind() == io::ErrorKind::BrokenPipe)
    }
}

/// Tells a failure on stderr, with colours on a terminal. If stderr is gone nobody is left to tell.
pub fn report(failure: &Failure) {
    if let Failure::Several(failures) = failure {
        return failures.iter().for_each(report);
    }
    let mut stderr = io::stderr().lock();
    let told = match failure {
        Failure::Spec(diagnostics) => {
            let text = match colour(&stderr) {
                true => diagnostics.render_coloured(),
                false => diagnostics.render(),
            };
            writeln!(stderr, "{text}\n")
        }
        Failure::Scene(diagnostics) => {
            let colour = colour(&stderr);
            write!(stderr, "{}", diagnostics.render(colour))
        }
        other => writeln!(stderr, "error: {other}"),
    };
    drop(told);
}

/// Tells on stderr what is not done. If stderr is gone nobody is left to tell.
pub fn tell(notices: &[impl std::fmt::Display]) {
    let mut stderr = io::stderr().lock();
    for notice in notices {
        drop(writeln!(stderr, "note: {notice}"));
    }
}

fn colour(stderr: &impl IsTerminal) -> bool {
    stderr.is_terminal() && std::env::var_os("NO_COLOR").is_none()
}

/// Prints text on stdout.
///
/// # Errors
/// A stdout that cannot be written.
pub fn print(text: &str) -> Result<(), Failure> {
    io::stdout()
        .lock()
        .write_all(text.as_bytes())
        .map_err(Failure::stdout)
}

/// Prints a value as one line of JSON on stdout.
///
/// # Errors
/// A stdout that cannot be written.
pub fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let mut text = serde_json::to_string(value).map_err(|error| Failure::stdout(error.into()))?;
    text.push('\n');
    print(&text)
}
