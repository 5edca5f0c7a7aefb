//! For build scripts: a scene as a module of equations in `OUT_DIR`.
//!
//! ```no_run
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     hamel_compiler::scene("arm.toml").specs("joints").compile()?;
//!     Ok(())
//! }
//! ```
//!
//! and in the crate `mod arm { include!(concat!(env!("OUT_DIR"), "/arm.rs")); }`. With [`Language::C99`] it is `arm.c` and `arm.h`, for the crate `cc`; with
//! [`Language::Cuda`] `arm.cu`.

use super::check;
use super::describe::Refused;
use super::emit;
use super::functions::{self, Kind, Loops, NotWritten, TooLong};
use super::model::Model;
use super::products::JointType;
use hamel_codegen::derived::Derived;
use hamel_codegen::emit::rust::WriteError;
use hamel_codegen::expr::budget::Exhausted;
use hamel_codegen::source;
use hamel_codegen::text::is_visible;
use hamel_scene::{Scene, SceneDescription, urdf};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// What a module is written in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Language {
    /// Functions generic over the runtime's scalars.
    #[default]
    Rust,
    /// C as of 1999, in doubles: a source that needs `<math.h>` alone, and a header.
    C99,
    /// CUDA C++, in doubles: a source that needs no header, with a kernel of many states for each function.
    Cuda,
}

impl Language {
    /// The ending of a module's file.
    pub const fn ending(self) -> &'static str {
        match self {
            Self::Rust => "rs",
            Self::C99 => "c",
            Self::Cuda => "cu",
        }
    }
}

/// Where a scene is said.
#[derive(Clone, Debug)]
enum Source {
    /// In a file.
    File(PathBuf),
    /// By the program itself, under a name.
    Described(String, Box<SceneDescription>),
}

impl Source {
    /// The file, or the name where there is none.
    fn path(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::Described(name, _) => Path::new(name),
        }
    }
}

/// Compiles a scene in a build script.
#[derive(Clone, Debug)]
pub struct Build {
    source: Source,
    name: Option<String>,
    language: Language,
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
    /// In C, its header: prototypes, sizes and layouts.
    pub header: Option<String>,
    /// Functions that it does not have, where nobody asked for them by name, and those that it does not have in lanes.
    pub left_out: Vec<TooLong>,
}

/// Why a scene is not compiled. `Debug` prints the same text as `Display`, because that is what a failing build script shows.
#[non_exhaustive]
pub enum Error {
    /// A file cannot be read or written, or `OUT_DIR` is not set.
    File(PathBuf, std::io::Error),
    /// Mistakes in the scene.
    Scene(Box<hamel_scene::Diagnostics>),
    /// Mistakes in a spec.
    Spec(Box<hamel_codegen::diagnostic::Diagnostics>),
    /// A joint type of which products of kernels take more work than a spec may.
    Work(String, Exhausted),
    /// What the scene has and the compiler does not write.
    Refused(Refused),
    /// A function that was asked for and would be too long.
    TooLong(TooLong),
    /// Emitted tokens that are no Rust.
    Write(WriteError),
    /// A fault in a template, which is part of this crate.
    Template(tera::Error),
    /// A name under which C cannot include a header.
    Name(String),
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(path, error) => write!(f, "{}: {error}", path.display()),
            Self::Scene(errors) => write!(f, "{errors}"),
            Self::Spec(errors) => write!(f, "{errors}"),
            Self::Work(joint, exhausted) => write!(f, "joint type `{joint}`: {exhausted}"),
            Self::Refused(refused) => write!(f, "{refused}"),
            Self::TooLong(long) => write!(f, "{long}"),
            Self::Write(error) => write!(f, "{error}"),
            Self::Template(error) => write!(f, "{error}"),
            Self::Name(name) => write!(
                f,
                "the module is named {name:?}, and C cannot include `{name}.h`: quotes, backslashes, ends of lines, bytes that are not UTF-8 and characters that are not seen must not be in a name"
            ),
        }
    }
}

impl std::fmt::Debug for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{self}")
    }
}

impl std::error::Error for Error {}

/// Compiles the scene file (TOML) or robot (URDF) at `path`, relative to the crate's manifest, with the functions of
/// [`Kind::BY_DEFAULT`] that are not too long.
pub fn scene(path: impl Into<PathBuf>) -> Build {
    Build::new(Source::File(path.into()))
}

/// As [`scene`], with a scene that the program has in its memory, and a name for it.
pub fn scene_of(name: impl Into<String>, description: SceneDescription) -> Build {
    Build::new(Source::Described(name.into(), Box::new(description)))
}

impl Build {
    fn new(source: Source) -> Self {
        Self {
            source,
            name: None,
            language: Language::default(),
            folders: vec![],
            texts: BTreeMap::new(),
            functions: None,
            floating_base: false,
            lanes: false,
        }
    }

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

    /// What the module is written in; without this Rust.
    #[must_use]
    pub fn language(mut self, language: Language) -> Self {
        self.language = language;
        self
    }

    /// The module's name, with which its files and, in C and CUDA, its functions and macros begin; without this the scene's file name.
    #[must_use]
    pub fn name(mut self, name: impl Into<String>) -> Self {
        self.name = Some(name.into());
        self
    }

    /// The functions to be written; without this those of [`Kind::BY_DEFAULT`] that are not too long.
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

    /// Lets forward and inverse dynamics, their derivatives, the mass matrix and its inverse take many states at a time, in SIMD lanes: in Rust behind
    /// `hamel_compiled::Batch`, compiled once for each level of instructions, which takes the Rust compiler its time; in C by functions
    /// `NAME_forward_dynamics_lanes` of eight states and `NAME_forward_dynamics_rows` of any number. In CUDA each function has a kernel of many states, with
    /// this or without.
    #[must_use]
    pub fn lanes(mut self) -> Self {
        self.lanes = true;
        self
    }

    /// Writes the module into `OUT_DIR`, under its name with the ending `.rs`, `.c` and `.h`, or `.cu`. Prints the instructions to cargo that make
    /// it run again when the scene or a spec changes.
    ///
    /// # Errors
    /// All mistakes of the scene; joint types without a spec; what the compiler does not write; files that cannot be read or written.
    pub fn compile(&self) -> Result<(), Error> {
        let path = self.source.path();
        let name = path.file_name().unwrap_or_default();
        let out = std::env::var_os("OUT_DIR")
            .map(PathBuf::from)
            .ok_or_else(|| {
                let reason = "it is not set: call this from a build script";
                Error::File("OUT_DIR".into(), std::io::Error::other(reason))
            })?;
        if let Source::File(path) = &self.source {
            println!("cargo::rerun-if-changed={}", path.display());
        }
        for folder in &self.folders {
            println!("cargo::rerun-if-changed={}", folder.display());
        }
        let module = self.module(&name.to_string_lossy())?;
        for left_out in module.left_out {
            println!("cargo::warning={}: {left_out}", path.display());
        }
        let target = out.join(format!("{}.{}", self.module_name(), self.language.ending()));
        if let Some(header) = &module.header {
            write(&target.with_extension("h"), header)?;
        }
        write(&target, &module.text)
    }

    fn module_name(&self) -> String {
        let stem = || self.source.path().file_stem().unwrap_or_default();
        let named = self.name.clone();
        named.unwrap_or_else(|| stem().to_string_lossy().into_owned())
    }

    /// The module as text; `label` names the scene in its first line.
    ///
    /// # Errors
    /// Those of [`Build::compile`].
    pub fn module(&self, label: &str) -> Result<Module, Error> {
        let model = self.model()?;
        let kinds = self.functions.as_deref().unwrap_or(&Kind::BY_DEFAULT);
        let (mut functions, mut left_out) = (vec![], vec![]);
        let mut reasons: Vec<String> = vec![];
        for &kind in kinds {
            match functions::compile(&model, kind, Loops::Long) {
                Ok(chosen) => {
                    let found = check::of_function(&model, &chosen.function).into_iter();
                    let new = found.filter(|reason| !reasons.contains(reason));
                    reasons.extend(new.collect::<Vec<_>>());
                    functions.push(chosen.function);
                }
                Err(NotWritten::TooLong(long)) if self.functions.is_none() => left_out.push(long),
                Err(NotWritten::TooLong(long)) => return Err(Error::TooLong(long)),
                Err(coupled) => reasons.push(coupled.to_string()),
            }
        }
        if !reasons.is_empty() {
            let scene = model.name;
            return Err(Error::Refused(Refused { scene, reasons }));
        }
        let lanes_asked = self.lanes && self.language != Language::Cuda;
        let mut lanes = vec![];
        for kind in kinds.iter().filter(|kind| lanes_asked && kind.is_batched()) {
            if functions
                .iter()
                .any(|function| function.name == kind.name())
            {
                let pairs = self.language == Language::Rust;
                match functions::compile_in_lanes(&model, *kind, pairs) {
                    Ok(function) => lanes.push(function),
                    Err(long) => left_out.push(long),
                }
            }
        }
        let (text, header) = self.texts(&model, (&functions, &lanes), label)?;
        Ok(Module {
            text,
            header,
            left_out,
        })
    }

    /// The module's text, and its header if it has one.
    fn texts(
        &self,
        model: &Model,
        (functions, lanes): (&[emit::Function], &[emit::Function]),
        label: &str,
    ) -> Result<(String, Option<String>), Error> {
        match self.language {
            Language::Rust => {
                let text = emit::module(model, functions, label, lanes);
                Ok((text.map_err(Error::Write)?, None))
            }
            Language::C99 => {
                let name = self.module_name();
                if name.contains(['"', '\\', '\n', '\t']) || !is_visible(&name) {
                    return Err(Error::Name(name));
                }
                let texts = emit::c99::module(model, (functions, lanes), label, &name);
                let texts = texts.map_err(Error::Template)?;
                Ok((texts.source, Some(texts.header)))
            }
            Language::Cuda => {
                let text = emit::c99::cuda(model, functions, label, &self.module_name());
                Ok((text.map_err(Error::Template)?, None))
            }
        }
    }

    /// What is compiled.
    ///
    /// # Errors
    /// Those of [`Build::compile`], except for writing.
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
                let joint = JointType::new(derived);
                let joint = joint.map_err(|error| Error::Work(kind.to_owned(), error))?;
                joints.insert(kind.to_owned(), Rc::new(joint));
            }
        }
        Model::new(&description, |kind| joints.get(kind).cloned()).map_err(Error::Refused)
    }

    fn description(&self) -> Result<SceneDescription, Error> {
        let failed = |errors| Error::Scene(Box::new(errors));
        let path = match &self.source {
            Source::File(path) => path,
            Source::Described(_, description) => return Ok((**description).clone()),
        };
        let (text, name) = (read(path)?, path.display().to_string());
        if urdf::is_robot(path, &text) {
            let options = urdf::Options {
                floating_base: self.floating_base,
                ..urdf::Options::default()
            };
            let text = urdf::completed(path, text).map_err(failed)?;
            let import = urdf::read(&text, &name, &options);
            return import.map(|import| import.scene).map_err(failed);
        }
        Scene::from_toml(&text, &name).map_err(failed)
    }

    /// A joint type, from the first place that has its spec.
    fn derive(&self, kind: &str) -> Result<Option<Derived>, Error> {
        let file = format!("{kind}.joint");
        let places = self.folders.iter().map(|folder| folder.join(&file));
        let place = places.into_iter().find(|path| path.exists());
        let text = match &place {
            Some(path) => Some(read(path)?),
            None => self.texts.get(kind).cloned(),
        };
        let folder = place.as_deref().and_then(Path::parent);
        let derive = |text: String| {
            hamel_codegen::derive_in(&text, &file, folder)
                .map_err(|errors| Error::Spec(Box::new(errors)))
        };
        text.map(derive).transpose()
    }
}

/// Writes a text where the file does not hold it yet.
fn write(path: &Path, text: &str) -> Result<(), Error> {
    if std::fs::read_to_string(path).is_ok_and(|known| known == text) {
        return Ok(());
    }
    std::fs::write(path, text).map_err(|error| Error::File(path.to_owned(), error))
}

fn read(path: &Path) -> Result<String, Error> {
    source::read(path).map_err(|error| Error::File(path.to_owned(), error))
}
