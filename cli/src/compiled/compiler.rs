//! The C compiler of the machine.

use super::temporary;
use crate::output::Failure;
use hamel_codegen::scene::Module;
use std::ffi::OsString;
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The variable that names a compiler, as for `make`: options may follow its name.
const VARIABLE: &str = "CC";

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
}

impl fmt::Display for Compiler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", Path::new(&self.program).display())
    }
}

impl Compiler {
    /// The one that `CC` names, else the first of `cc`, `gcc` and `clang` that can be run.
    ///
    /// # Errors
    /// There is none; the message says what was looked for.
    pub fn find() -> Result<Self, Failure> {
        let named = std::env::var(VARIABLE).unwrap_or_default();
        let mut words = named.split_whitespace();
        if let Some(program) = words.next() {
            let named = Self {
                program: program.into(),
                options: words.map(str::to_owned).collect(),
            };
            return named.answers().map(|()| named.clone()).map_err(|error| {
                Failure::Options(format!(
                    "compiled equations need a C compiler, and `{program}`, which the variable {VARIABLE} names, cannot be run: {error}"
                ))
            });
        }
        let known = NAMES.iter().map(|&name| Self {
            program: name.into(),
            options: vec![],
        });
        let mut there = known.filter(|compiler| compiler.answers().is_ok());
        there.next().ok_or_else(|| {
            let names = NAMES.map(|name| format!("`{name}`")).join(", ");
            Failure::Options(format!(
                "compiled equations need a C compiler, and none of {names} can be run: install one, or name it in the variable {VARIABLE}"
            ))
        })
    }

    fn answers(&self) -> std::io::Result<()> {
        let mut command = Command::new(&self.program);
        command.args(&self.options).arg("--version");
        command.output().map(|_| ())
    }

    /// The module as a library in `folder`.
    ///
    /// # Errors
    /// A folder that cannot be written; a compiler that fails, with what it says.
    pub fn build(&self, folder: &Path, name: &str, module: &Module) -> Result<PathBuf, Failure> {
        let source = folder.join(format!("{name}.c"));
        let library = folder.join(format!("{name}{}", std::env::consts::DLL_SUFFIX));
        std::fs::write(&source, &module.text).map_err(temporary)?;
        let header = module.header.as_deref().unwrap_or_default();
        std::fs::write(source.with_extension("h"), header).map_err(temporary)?;
        let output = Command::new(&self.program)
            .args(&self.options)
            .args(OPTIONS)
            .arg(&source)
            .arg("-o")
            .arg(&library)
            .arg("-lm")
            .output();
        let failed = |said: &str| {
            Failure::Refused(format!(
                "the C compiler {self} failed:\n{}",
                said.trim_end()
            ))
        };
        let output = output.map_err(|error| failed(&error.to_string()))?;
        match output.status.success() {
            true => Ok(library),
            false => Err(failed(&String::from_utf8_lossy(&output.stderr))),
        }
    }
}
