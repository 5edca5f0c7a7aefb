//! Why there are no compiled equations.

use super::library::LoadError;
use hamel::compiled::CompiledError;
use std::io;

/// Why there are no compiled equations.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The machine has no C compiler that can be run, or what a variable says of it cannot be.
    #[error("{0}")]
    NoCompiler(String),
    /// The scene compiler refuses the scene.
    #[error("{0}")]
    Scene(hamel_compiler::Error),
    /// The C compiler fails.
    #[error("the C compiler {compiler} failed:\n{said}")]
    Failed {
        /// Its name.
        compiler: String,
        /// What it says.
        said: String,
    },
    /// The C compiler was ended, since its caller wants no more.
    #[error("the C compiler was ended")]
    Ended,
    /// The library cannot be loaded.
    #[error("the compiled scene cannot be loaded: {0}")]
    Load(#[from] LoadError),
    /// The library is not of the mechanism.
    #[error("{}", of_mechanism(.0))]
    Mechanism(#[from] CompiledError),
    /// The folder cannot be written.
    #[error("cannot write: {0}")]
    Folder(#[source] io::Error),
}

/// They were compiled of the same scene a moment ago, so that nobody can compile it again.
fn of_mechanism(cause: &CompiledError) -> String {
    match cause {
        CompiledError::NoValue { .. } => cause.to_string(),
        _ => format!(
            "compiled equations disagree with those of the tree, a fault of Hamel or of the C compiler: please report the scene; without compiled equations it is simulated by the tree ({cause})"
        ),
    }
}
