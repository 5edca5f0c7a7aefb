//! For build scripts: from a folder of specs to Rust, into `OUT_DIR` or into a crate's own sources.
//!
//! A downstream crate has a folder `joints` of `.joint` files and this build script:
//!
//! ```no_run
//! fn main() -> Result<(), hamel_codegen::BuildError> {
//!     hamel_codegen::Build::new().specs("joints").compile()
//! }
//! ```
//!
//! and includes the result: `mod joints { include!(concat!(env!("OUT_DIR"), "/joints.rs")); }`.

mod error;
mod library;
mod parallel;
#[cfg(test)]
mod tests;

pub use error::BuildError;

use crate::derive_in;
use crate::derived::Derived;
use crate::emit::files::Files;
use crate::emit::report::Accuracy;
use crate::emit::rust::{Index, Runtime, index};
use crate::source;
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The variable that makes a build check the committed files instead of writing them: `HAMEL_GENERATE=check`.
pub const GENERATE_VARIABLE: &str = "HAMEL_GENERATE";

/// Generates joints from a folder of specs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Build {
    specs: PathBuf,
    accuracy: Option<PathBuf>,
    runtime: String,
    target: Target,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Target {
    /// One file `joints.rs` in this folder, or in `OUT_DIR`.
    Single(Option<PathBuf>),
    /// One file a joint with an index `mod.rs`, and a page a joint.
    Library { modules: PathBuf, pages: PathBuf },
}

impl Default for Build {
    fn default() -> Self {
        Self::new()
    }
}

impl Build {
    /// Reads specs from `joints` and writes `joints.rs` into `OUT_DIR`.
    pub fn new() -> Self {
        Self {
            specs: "joints".into(),
            accuracy: None,
            runtime: "::hamel".into(),
            target: Target::Single(None),
        }
    }

    /// The folder of specs, relative to the crate's manifest.
    #[must_use]
    pub fn specs(mut self, folder: impl Into<PathBuf>) -> Self {
        self.specs = folder.into();
        self
    }

    /// The folder for `joints.rs`, instead of `OUT_DIR`.
    #[must_use]
    pub fn out_dir(mut self, folder: impl Into<PathBuf>) -> Self {
        self.target = Target::Single(Some(folder.into()));
        self
    }

    /// A table of measured errors for the pages of [`Build::library`], relative to the crate's manifest: comma-separated
    /// `joint,kernel,type,worst ulp,points`, with this header. Where the file is absent, pages do without.
    #[must_use]
    pub fn accuracy(mut self, file: impl Into<PathBuf>) -> Self {
        self.accuracy = Some(file.into());
        self
    }

    /// The path of the runtime in the emitted code, `::hamel` unless set: `hamel_runtime` in a crate that depends on the runtime alone, or a module
    /// that re-exports it.
    #[must_use]
    pub fn runtime(mut self, path: impl Into<String>) -> Self {
        self.runtime = path.into();
        self
    }

    /// Writes one file per joint and an index into `modules`, one page and one drawing per joint into `pages`, and an overview
    /// `JOINTS.md` beside the folder of pages: for sources that are committed. With `HAMEL_GENERATE=check` it writes nothing, and stale, missing and surplus files are an error.
    #[must_use]
    pub fn library(mut self, modules: impl Into<PathBuf>, pages: impl Into<PathBuf>) -> Self {
        self.target = Target::Library {
            modules: modules.into(),
            pages: pages.into(),
        };
        self
    }

    /// Generates. Prints the instructions to cargo that make it run again when a spec changes, appears or goes.
    ///
    /// # Errors
    /// When a spec is wrong (all errors of all specs at once), a file cannot be read or written, or, while checking, when the
    /// committed files are not what the specs say. The errors have then been reported to cargo too.
    pub fn compile(&self) -> Result<(), BuildError> {
        let checks = std::env::var_os(GENERATE_VARIABLE).is_some_and(|value| value == "check");
        let result = self.generate(checks);
        if let Err(error) = &result {
            error
                .lines()
                .iter()
                .for_each(|line| println!("cargo::error={line}"));
        }
        result
    }

    /// Writes, or where `check` says so only compares a library with what is there.
    fn generate(&self, check: bool) -> Result<(), BuildError> {
        watch(&self.specs);
        let runtime = self.runtime.parse().map_err(BuildError::Runtime)?;
        let joints = self.derive_all()?;
        match &self.target {
            Target::Single(folder) => self.write_single(joints, folder.as_deref(), &runtime),
            Target::Library { modules, pages } => {
                println!("cargo::rerun-if-env-changed={GENERATE_VARIABLE}");
                let accuracy = self.read_accuracy()?;
                library::generate(
                    joints,
                    &self.label(),
                    (modules, pages),
                    &accuracy,
                    &runtime,
                    check,
                )
            }
        }
    }

    fn read_accuracy(&self) -> Result<Accuracy, BuildError> {
        let Some(path) = &self.accuracy else {
            return Ok(Accuracy::default());
        };
        // A file that does not exist would make cargo build again each time: its folder is watched until it does.
        let existing = path.ancestors().find(|path| path.exists());
        existing.into_iter().for_each(watch);
        match source::read(path) {
            Ok(text) => Accuracy::parse(&text).map_err(|error| BuildError::Accuracy {
                path: path.clone(),
                error,
            }),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Accuracy::default()),
            Err(error) => Err(BuildError::read(path, error)),
        }
    }

    /// The folder of specs as files name it: its last component, without the path to it.
    fn label(&self) -> String {
        self.specs
            .file_name()
            .unwrap_or_else(|| OsStr::new("joints"))
            .to_string_lossy()
            .into_owned()
    }

    /// Every spec of the folder, in the order of file names, derived; all errors at once.
    fn derive_all(&self) -> Result<Vec<(String, Derived)>, BuildError> {
        let mut sources = vec![];
        for path in spec_files(&self.specs)? {
            watch(&path);
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let label = format!("{}/{name}", self.label());
            let source = source::read(&path).map_err(|error| BuildError::read(&path, error))?;
            sources.push((label, source));
        }
        let length = |(_, source): &(String, String)| source.len();
        let derived = parallel::map(sources, length, |(label, source)| {
            Ok((
                label.clone(),
                derive_in(&source, &label, Some(&self.specs))?,
            ))
        });
        let (mut joints, mut errors) = (vec![], vec![]);
        for result in derived {
            match result {
                Ok(joint) => {
                    self.watch_knots(&joint.1);
                    joints.push(joint);
                }
                Err(diagnostics) => errors.push(diagnostics),
            }
        }
        match errors.is_empty() {
            true => reject_duplicates(joints),
            false => Err(BuildError::Specs(errors)),
        }
    }

    /// Asks cargo to run the build script again when a file with knots changes.
    fn watch_knots(&self, joint: &Derived) {
        let files = joint
            .spec
            .curves
            .iter()
            .filter_map(|curve| curve.file.as_ref());
        files.for_each(|file| watch(&self.specs.join(&file.name)));
    }

    fn write_single(
        &self,
        joints: Vec<(String, Derived)>,
        folder: Option<&Path>,
        runtime: &Runtime,
    ) -> Result<(), BuildError> {
        let out_dir = || {
            std::env::var_os("OUT_DIR")
                .map(PathBuf::from)
                .ok_or(BuildError::NoOutDir)
        };
        let folder = folder.map_or_else(out_dir, |folder| Ok(folder.to_owned()))?;
        let joints: Vec<Derived> = joints.into_iter().map(|(_, joint)| joint).collect();
        let mut files = Files::default();
        files.insert(
            "joints.rs",
            index(&joints, &self.label(), Index::Nested, runtime)?,
        );
        files.write(&folder)?;
        Ok(())
    }
}

/// Asks cargo to run the build script again when the file or folder changes.
fn watch(path: &Path) {
    let shown = path.display().to_string();
    // A second line would be an instruction of its own.
    if !shown.contains(['\n', '\r']) {
        println!("cargo::rerun-if-changed={shown}");
    }
}

/// The `.joint` files of a folder, sorted by name.
fn spec_files(folder: &Path) -> Result<Vec<PathBuf>, BuildError> {
    let failed = |source| BuildError::read(folder, source);
    let mut paths = vec![];
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.extension() == Some(OsStr::new("joint")) && path.is_file() {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

/// Two specs must not become one module or one type.
fn reject_duplicates(joints: Vec<(String, Derived)>) -> Result<Vec<(String, Derived)>, BuildError> {
    let mut seen: BTreeMap<String, &str> = BTreeMap::new();
    for (label, joint) in &joints {
        let type_name = crate::emit::type_name(&joint.spec.name.value);
        if let Some(first) = seen.insert(type_name.clone(), label) {
            let (first, second) = (first.to_owned(), label.clone());
            return Err(BuildError::Duplicate {
                type_name,
                first,
                second,
            });
        }
    }
    Ok(joints)
}
