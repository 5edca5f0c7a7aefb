//! Why generation failed, as a build script reports it.

use crate::diagnostic::Diagnostics;
use crate::emit::files::FileError;
use crate::emit::report::AccuracyError;
use crate::emit::rust::{RuntimeError, WriteError};
use crate::text::visible;
use std::fmt::{Debug, Display, Formatter};
use std::path::{Path, PathBuf};

/// Why generation failed. `Debug` prints the same text as `Display`, because that is what a failing `main` shows.
#[non_exhaustive]
pub enum BuildError {
    /// Specs with errors, all of them.
    Specs(Vec<Diagnostics>),
    /// Two specs whose joints have one name in Rust.
    Duplicate {
        /// The name of the type.
        type_name: String,
        /// The spec that has it first.
        first: String,
        /// The spec that has it again.
        second: String,
    },
    /// A file could not be read or written.
    File(FileError),
    /// Committed files are not what the specs say: a line for each, `stale: joints/ball.rs`.
    NotFresh(Vec<String>),
    /// Code could not be written.
    Unwritten(WriteError),
    /// A page could not be made.
    Page(tera::Error),
    /// The table of measured errors is none.
    Accuracy {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        error: AccuracyError,
    },
    /// The path of the runtime is none.
    Runtime(RuntimeError),
    /// There is no `OUT_DIR`: not called from a build script, and no folder was given.
    NoOutDir,
}

impl BuildError {
    pub(super) fn read(path: &Path, source: std::io::Error) -> Self {
        Self::File(FileError {
            action: "read",
            path: path.to_owned(),
            source,
        })
    }

    /// One line for each of the first errors, for cargo's own list, and how many more there are.
    pub fn lines(&self) -> Vec<String> {
        match self {
            Self::Specs(files) => {
                let errors = files.iter().flat_map(|file| {
                    let errors = file.errors.iter();
                    errors.map(|error| (&file.file, error))
                });
                hamel_diagnostics::first(errors, |(file, error)| {
                    one_line(&format!("{file}: {}: {}", error.code, error.message))
                })
            }
            Self::NotFresh(lines) => hamel_diagnostics::first(lines, String::clone),
            other => vec![one_line(&other.to_string())],
        }
    }
}

fn one_line(text: &str) -> String {
    visible(&text.split_whitespace().collect::<Vec<_>>().join(" "))
}

impl Display for BuildError {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Specs(files) => {
                let reports = files.iter().flat_map(Diagnostics::reports);
                f.write_str(&hamel_diagnostics::render(reports, false))
            }
            Self::Duplicate {
                type_name,
                first,
                second,
            } => {
                write!(
                    f,
                    "{first} and {second} both make the type `{type_name}`: rename one of the joints"
                )
            }
            Self::File(error) => write!(f, "{error}"),
            Self::NotFresh(lines) => {
                write!(
                    f,
                    "generated files differ from the specs; run `cargo build` and commit them:\n{}",
                    hamel_diagnostics::first(lines, String::clone).join("\n")
                )
            }
            Self::Unwritten(error) => write!(f, "{error}"),
            Self::Page(error) => write!(f, "cannot make a page: {error}"),
            Self::Accuracy { path, error } => write!(f, "{}: {error}", path.display()),
            Self::Runtime(error) => write!(f, "{error}"),
            Self::NoOutDir => f.write_str(
                "OUT_DIR is not set: call this from a build script, or give a folder with out_dir",
            ),
        }
    }
}

impl Debug for BuildError {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{self}")
    }
}

impl std::error::Error for BuildError {}

impl From<FileError> for BuildError {
    fn from(error: FileError) -> Self {
        Self::File(error)
    }
}

impl From<WriteError> for BuildError {
    fn from(error: WriteError) -> Self {
        Self::Unwritten(error)
    }
}

impl From<tera::Error> for BuildError {
    fn from(error: tera::Error) -> Self {
        Self::Page(error)
    }
}
