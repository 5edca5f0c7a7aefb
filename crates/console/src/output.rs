//! What goes wrong, and how it is reported: in plain words on stderr.

use crate::interrupt;
use crate::terminal::{self, Texts};
use hamel_diagnostics::Report;
use hamel_scene::Diagnostics;
use hamel_scene::text::{is_visible, visible};
use serde_json::Serializer;
use std::io;
use std::path::Path;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Mistakes in a scene file.
    #[error("{0}")]
    Scene(#[from] Diagnostics),
    /// Mistakes in a spec.
    #[error("{0}")]
    Spec(Box<hamel_codegen::diagnostic::Diagnostics>),
    /// Failures of several joints, each reported in full.
    #[error("{} joints were refused", .0.len())]
    Several(Vec<Failure>),
    /// A page that its template cannot show.
    #[error("the page cannot be rendered: {0}")]
    Page(String),
    /// A scene that cannot be compiled, with all its reasons.
    #[error("{0}")]
    Refused(String),
    /// Options that contradict each other or the scene.
    #[error("{0}")]
    Options(String),
    /// A scene that is refused before anything moves.
    #[error("the scene cannot start: {0}")]
    Start(#[from] hamel_scene::StartError),
    /// The simulation stopped before its end.
    #[error("the simulation stopped: {0}")]
    Simulation(String),
    /// The user ended the command before it was done; what was done by then.
    #[error("{0}")]
    Interrupted(String),
    /// A file or stdout cannot be written.
    #[error("cannot write {target}: {error}")]
    Write {
        /// The file, or `stdout`.
        target: String,
        /// What the system says.
        error: io::Error,
    },
}

impl Failure {
    /// The failure to write a file.
    pub fn write(path: &Path, error: io::Error) -> Self {
        Self::Write {
            target: path.display().to_string(),
            error,
        }
    }

    /// The failure to write to stdout.
    pub fn stdout(error: io::Error) -> Self {
        Self::Write {
            target: "stdout".into(),
            error,
        }
    }

    /// Everything that failed, ready to print.
    fn reports(&self) -> Box<dyn Iterator<Item = Report<'_>> + '_> {
        match self {
            Self::Several(failures) => Box::new(failures.iter().flat_map(Self::reports)),
            Self::Spec(diagnostics) => Box::new(diagnostics.reports()),
            Self::Scene(diagnostics) => Box::new(diagnostics.reports()),
            other => Box::new(std::iter::once(Report::bare(other.to_string()))),
        }
    }

    /// The exit code that tells the failure to the caller: 2 for the command line, 130 for an interrupt, 1 for everything else.
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Options(_) => 2,
            Self::Interrupted(_) => interrupt::EXIT_CODE,
            _ => 1,
        }
    }

    /// Whether the reader of stdout has gone, as `head` does when it has read enough: no failure of ours.
    pub fn is_broken_pipe(&self) -> bool {
        matches!(self, Self::Write { error, .. } if error.kind() == io::ErrorKind::BrokenPipe)
    }
}

/// Tells a failure on stderr, with colours on a terminal. If stderr is gone nobody is left to tell.
pub fn report(failure: &Failure) {
    match failure {
        Failure::Spec(_) | Failure::Several(_) => terminal::err_rendered(|colour| {
            let text = shown(colour, |colour| {
                hamel_diagnostics::render(failure.reports(), colour)
            });
            format!("{text}\n\n")
        }),
        Failure::Scene(diagnostics) => {
            terminal::err_rendered(|colour| diagnostics.render(colour));
        }
        Failure::Interrupted(done) => terminal::err(&format!("interrupted: {done}")),
        other => terminal::err(&format!("error: {other}")),
    }
}

/// What is rendered; without colours, where something in it would not be seen.
fn shown(colour: bool, render: impl Fn(bool) -> String) -> String {
    let plain = render(false);
    match colour && is_visible(&plain) {
        true => render(true),
        false => visible(&plain),
    }
}

/// Tells on stderr what is not done, each with its severity.
pub fn tell(notices: &[impl std::fmt::Display]) {
    for notice in notices {
        terminal::err(&notice.to_string());
    }
}

/// Prints text on stdout.
///
/// # Errors
/// A stdout that cannot be written.
pub fn print(text: &str) -> Result<(), Failure> {
    terminal::out(text).map_err(Failure::stdout)
}

/// Prints a value as one line of JSON on stdout.
///
/// # Errors
/// A stdout that cannot be written.
pub fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let mut text = Vec::new();
    let written = value.serialize(&mut Serializer::with_formatter(&mut text, Texts));
    written.map_err(|error| Failure::stdout(error.into()))?;
    text.push(b'\n');
    print(&String::from_utf8_lossy(&text))
}
