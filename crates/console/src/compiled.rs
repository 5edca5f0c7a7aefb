//! Compiled equations in a program: an interrupt ends the compiler, and nothing that it wrote is left behind.

use crate::files::private_folder;
use crate::interrupt::{self, Heed};
use crate::output::Failure;
use hamel_compiler::Build;
use hamel_compiler::functions::Kind;
use hamel_native::{Compiler, Equations, Error, Source};
use hamel_scene::Scene;

/// The C compiler of the machine.
///
/// # Errors
/// There is none; the message says what was looked for. A time limit that is none; an interrupt.
pub fn compiler() -> Result<Compiler, Failure> {
    let _heed = Heed::begin();
    Ok(Compiler::find(&interrupt::is_requested)?)
}

/// The functions `kinds` of `scene`, which is that of `build`, in C by a compiler.
///
/// # Errors
/// A scene that the scene compiler refuses; a compiler that fails; a folder for temporary files that cannot be written; equations that are not those of the
/// mechanism; an interrupt.
pub fn compiled(
    build: Build,
    label: &str,
    kinds: &[Kind],
    compiler: &Compiler,
    scene: &Scene,
) -> Result<Equations, Failure> {
    let source = Source::new(build, label, kinds)?;
    // A library that is loaded needs its file no more.
    let folder = private_folder().map_err(Error::Folder)?;
    let _heed = Heed::begin();
    let start = (&scene.mechanism, &*scene.configuration);
    Ok(source.load(compiler, folder.path(), start, &interrupt::is_requested)?)
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error {
            Error::NoCompiler(why) => Self::Options(why),
            Error::Ended => Self::Interrupted(String::from(
                "the C compiler was ended; files are as they were",
            )),
            Error::Folder(error) => Self::Write {
                target: format!("into {}", std::env::temp_dir().display()),
                error,
            },
            refused => Self::Refused(refused.to_string()),
        }
    }
}
