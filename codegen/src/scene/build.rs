//! For build scripts: a scene as a module of equations in `OUT_DIR`.
//!
//! ```no_run
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     hamel_codegen::scene("arm.toml").specs("joints").compile()?;
//!     Ok(())
//! }
//! ```
//!
//! and in the crate `mod arm { include!(concat!(env!("OUT_DIR"), "/arm.rs")); }`.

use super::describe::Refused;
use super::emit;
use super::functions::{self, Kind, Loops, TooLong};
use super::model::Model;
use crate::derived::Derived;
use crate::emit::rust::WriteError;
use hamel_scene::{Scene, SceneDescription, urdf};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Compiles a scene in a build script.
#[derive(Clone, Debug)]
pub struct Build {
    scene: PathBuf,
    folders: Vec<PathBuf>,
    texts: BTreeMap<String, String>,
    functions: Option<Vec<Kind>>,
    floating_base: bool,
    lanes: bool,
}

/// A module of equations.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Module {
    /// Its text.
    pub text: String,
    /// Functions that it does not have, where nobody asked for them by name.
    pub left_out: Vec<TooLong>,
}

/// Why a scene is not compiled.
#[derive(Debug)]
pub enum Error {
    /// A file cannot be read or written, or `OUT_DIR` is not set.
    File(PathBuf, std::io::Error),
    /// Mistakes in the scene.
    Scene(Box<hamel_scene::Diagnostics>),
    /// Mistakes in a spec.
    Spec(Box<crate::diagnostic::Diagnostics>),
    /// What the scene has and the compiler does not write.
    Refused(Refused),
    /// A function that was asked for and would be too long.
    TooLong(TooLong),
    /// Emitted tokens that are no Rust.
    Write(WriteError),
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(path, error) => write!(f, "{}: {error}", path.display()),
            Self::Scene(errors) => write!(f, "{errors}"),
            Self::Spec(errors) => write!(f, "{errors}"),
            Self::Refused(refused) => write!(f, "{refused}"),
            Self::TooLong(long) => write!(f, "{long}"),
            Self::Write(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for Error {}

/// Compiles the scene file (TOML) or robot (URDF) at `path`, relative to the crate's manifest, with all functions that are not too long.
pub fn scene(path: impl Into<PathBuf>) -> Build {
    Build {
        scene: path.into(),
        folders: vec![],
        texts: BTreeMap::new(),
        functions: None,
        floating_base: false,
        lanes: false,
    }
}

impl Build {
    /// A folder of specs in which joint types are looked up, relative to the crate's manifest.
    #[must_use]
    pub fn specs(mut self, folder: impl Into<PathBuf>) -> Self {
        self.folders.push(folder.into());
        self
    }

    /// Names and texts of specs in which joint types are looked up: those of the library are `hamel_joints::specs()`.
    #[must_use]
    pub fn library<'a>(mut self, specs: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        let owned = specs
            .into_iter()
            .map(|(name, text)| (name.to_owned(), text.to_owned()));
        self.texts.extend(owned);
        self
    }

    /// The functions to be written; without this all that are not too long.
    #[must_use]
    pub fn functions(mut self, functions: impl IntoIterator<Item = Kind>) -> Self {
        self.functions = Some(functions.into_iter().collect());
        self
    }

    /// Lets the root link of a robot in URDF move freely.
    #[must_use]
    pub fn floating_base(mut self) -> Self {
        self.floating_base = true;
        self
    }

    /// Lets forward and inverse dynamics take many states at a time (`hamel::compiled::Batch`), in SIMD lanes. They are compiled once for each level of
    /// instructions, which takes the Rust compiler its time.
    #[must_use]
    pub fn lanes(mut self) -> Self {
        self.lanes = true;
        self
    }

    /// Writes the module into `OUT_DIR`, under the scene's file name with the ending `.rs`. Prints the instructions to cargo that make
    /// it run again when the scene or a spec changes.
    ///
    /// # Errors
    /// All mistakes of the scene; joint types without a spec; what the compiler does not write; files that cannot be read or written.
    pub fn compile(&self) -> Result<(), Error> {
        let name = self.scene.file_name().unwrap_or_default();
        let out = std::env::var_os("OUT_DIR")
            .map(PathBuf::from)
            .ok_or_else(|| {
                let reason = "it is not set: call this from a build script";
                Error::File("OUT_DIR".into(), std::io::Error::other(reason))
            })?;
        println!("cargo::rerun-if-changed={}", self.scene.display());
        for folder in &self.folders {
            println!("cargo::rerun-if-changed={}", folder.display());
        }
        let Module { text, left_out } = self.module(&name.to_string_lossy())?;
        for left_out in left_out {
            println!("cargo::warning={}: {left_out}", self.scene.display());
        }
        let target = out.join(name).with_extension("rs");
        if std::fs::read_to_string(&target).is_ok_and(|known| known == text) {
            return Ok(());
        }
        std::fs::write(&target, text).map_err(|error| Error::File(target, error))
    }

    /// The module as text; `label` names the scene in its first line.
    ///
    /// # Errors
    /// Those of [`Build::compile`].
    pub fn module(&self, label: &str) -> Result<Module, Error> {
        let model = self.model()?;
        let kinds = self.functions.as_deref().unwrap_or(&Kind::ALL);
        let (mut functions, mut left_out) = (vec![], vec![]);
        for &kind in kinds {
            match functions::compile(&model, kind, self.loops(kind)) {
                Ok(chosen) => functions.push(chosen.function),
                Err(long) if self.functions.is_none() => left_out.push(long),
                Err(long) => return Err(Error::TooLong(long)),
            }
        }
        let text = emit::module(&model, &functions, label, self.lanes).map_err(Error::Write)?;
        Ok(Module { text, left_out })
    }

    /// A loop over states must be the innermost one to become SIMD code.
    fn loops(&self, kind: Kind) -> Loops {
        match self.lanes && kind.is_batched() {
            true => Loops::Never,
            false => Loops::Long,
        }
    }

    /// What is compiled.
    ///
    /// # Errors
    /// Those of [`Build::compile`], but for writing.
    pub fn model(&self) -> Result<Model, Error> {
        let description = self.description()?;
        let kinds: std::collections::BTreeSet<&str> = description
            .bodies
            .iter()
            .map(|body| body.joint.kind.value.as_str())
            .collect();
        let mut joints = BTreeMap::new();
        for kind in kinds {
            if let Some(derived) = self.derive(kind)? {
                joints.insert(kind.to_owned(), Rc::new(derived));
            }
        }
        Model::new(&description, |kind| joints.get(kind).cloned()).map_err(Error::Refused)
    }

    fn description(&self) -> Result<SceneDescription, Error> {
        let failed = |errors| Error::Scene(Box::new(errors));
        let ending = self.scene.extension().unwrap_or_default();
        if ending.eq_ignore_ascii_case("urdf") {
            let options = urdf::Options {
                floating_base: self.floating_base,
                ..urdf::Options::default()
            };
            return urdf::load(&self.scene, &options)
                .map(|import| import.scene)
                .map_err(failed);
        }
        let text = read(&self.scene)?;
        Scene::from_toml(&text, &self.scene.display().to_string()).map_err(failed)
    }

    /// A joint type, from the first place that has its spec.
    fn derive(&self, kind: &str) -> Result<Option<Derived>, Error> {
        let file = format!("{kind}.joint");
        let places = self.folders.iter().map(|folder| folder.join(&file));
        let text = match places.into_iter().find(|path| path.exists()) {
            Some(path) => Some(read(&path)?),
            None => self.texts.get(kind).cloned(),
        };
        let derive = |text: String| {
            crate::derive(&text, &file).map_err(|errors| Error::Spec(Box::new(errors)))
        };
        text.map(derive).transpose()
    }
}

fn read(path: &Path) -> Result<String, Error> {
    std::fs::read_to_string(path).map_err(|error| Error::File(path.to_owned(), error))
}
