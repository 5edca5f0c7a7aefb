//! The C compiler of the machine.

use super::Error;
use super::child::{self, Ended};
use hamel_compiler::Module;
use std::ffi::OsString;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// The variable that names a compiler, as for `make`: options may follow its name.
const VARIABLE: &str = "CC";

/// The variable that says how long a compiler may take, s.
const LIMIT: &str = "HAMEL_CC_SECONDS";

/// How long it may take where that is not set: functions that would take minutes are not written in the first place.
const DEFAULT_LIMIT: Duration = Duration::from_secs(300);

/// How long it may take to tell its version.
const LIMIT_OF_ANSWER: Duration = Duration::from_secs(10);

/// What is looked for on the PATH where the variable names none.
const NAMES: [&str; 3] = ["cc", "gcc", "clang"];

/// For a library of code that runs on any machine of the kind, where each operation is rounded by itself.
const OPTIONS: [&str; 5] = ["-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared"];

/// A compiler that can be run.
#[derive(Clone, Debug)]
pub struct Compiler {
    program: OsString,
    /// Options of its own, named with it.
    options: Vec<String>,
    /// How long it may take.
    limit: Duration,
}

impl fmt::Display for Compiler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", Path::new(&self.program).display())
    }
}

impl Compiler {
    /// The one that `CC` names, else the first of `cc`, `gcc` and `clang` that can be run. The search ends when `is_ended` says so.
    ///
    /// # Errors
    /// There is none; the message says what was looked for. A time limit that is none; a search that was ended.
    pub fn find(is_ended: &dyn Fn() -> bool) -> Result<Self, Error> {
        let limit = limit()?;
        let named = std::env::var(VARIABLE).unwrap_or_default();
        let mut words = named.split_whitespace();
        if let Some(program) = words.next() {
            let named = Self {
                program: program.into(),
                options: words.map(str::to_owned).collect(),
                limit,
            };
            return match named.answers(is_ended)? {
                Ok(()) => Ok(named),
                Err(error) => Err(Error::NoCompiler(format!(
                    "compiled equations need a C compiler, and `{program}`, which the variable {VARIABLE} names, cannot be run: {error}"
                ))),
            };
        }
        for name in NAMES {
            let known = Self {
                program: name.into(),
                options: vec![],
                limit,
            };
            if known.answers(is_ended)?.is_ok() {
                return Ok(known);
            }
        }
        let names = NAMES.map(|name| format!("`{name}`")).join(", ");
        Err(Error::NoCompiler(format!(
            "compiled equations need a C compiler, and none of {names} can be run: install one, or name it in the variable {VARIABLE}"
        )))
    }

    /// Whether it can be run.
    fn answers(&self, is_ended: &dyn Fn() -> bool) -> Result<io::Result<()>, Error> {
        let mut command = Command::new(&self.program);
        command.args(&self.options).arg("--version");
        let limit = LIMIT_OF_ANSWER.min(self.limit);
        match child::run(&mut command, None, limit, is_ended) {
            Ok(Ended::Unwanted) => Err(Error::Ended),
            Ok(Ended::Late) => Ok(Err(io::Error::other(format!(
                "it does not tell its version within {} s",
                limit.as_secs_f64()
            )))),
            Ok(Ended::Itself(_)) => Ok(Ok(())),
            Err(error) => Ok(Err(error)),
        }
    }

    /// The module as a library in `folder`.
    ///
    /// # Errors
    /// A folder that cannot be written; a compiler that fails, with what it says, that takes too long or that was ended.
    pub(crate) fn build(
        &self,
        folder: &Path,
        name: &str,
        module: &Module,
        is_ended: &dyn Fn() -> bool,
    ) -> Result<PathBuf, Error> {
        let source = folder.join(format!("{name}.c"));
        let library = folder.join(format!("{name}{}", std::env::consts::DLL_SUFFIX));
        std::fs::write(&source, &module.text).map_err(Error::Folder)?;
        let header = module.header.as_deref().unwrap_or_default();
        std::fs::write(source.with_extension("h"), header).map_err(Error::Folder)?;
        let said = folder.join("said");
        let mut command = Command::new(&self.program);
        command
            .args(&self.options)
            .args(OPTIONS)
            .arg(&source)
            .arg("-o")
            .arg(&library)
            .arg("-lm");
        let failed = |said: &str| Error::Failed {
            compiler: self.to_string(),
            said: said.trim_end().to_owned(),
        };
        match child::run(&mut command, Some(&said), self.limit, is_ended) {
            Ok(Ended::Itself(status)) if status.success() => Ok(library),
            Ok(Ended::Itself(_)) => {
                let said = std::fs::read(said).map_err(Error::Folder)?;
                Err(failed(&String::from_utf8_lossy(&said)))
            }
            Ok(Ended::Late) => Err(failed(&format!(
                "it took more than {} s, and was ended; the variable {LIMIT} sets another limit",
                self.limit.as_secs_f64()
            ))),
            Ok(Ended::Unwanted) => Err(Error::Ended),
            Err(error) => Err(failed(&error.to_string())),
        }
    }
}

/// The time limit.
fn limit() -> Result<Duration, Error> {
    let Some(text) = std::env::var_os(LIMIT) else {
        return Ok(DEFAULT_LIMIT);
    };
    let text = text.to_string_lossy();
    let seconds = text.parse().ok().filter(|seconds| *seconds > 0.0);
    let limit = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    limit.ok_or_else(|| {
        Error::NoCompiler(format!(
            "the variable {LIMIT} is {text:?}; it must be a number of seconds above 0"
        ))
    })
}
