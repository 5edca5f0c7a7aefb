//! `sweep.json`: what was swept, by which a folder of results is known.

use super::args::{Equations, Format};
use hamel_console::output::Failure;
use hamel_sweep::level::Arithmetic;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Its name in the folder.
pub const NAME: &str = "sweep.json";

/// Version of the layout of folders.
const LAYOUT: u32 = 1;

/// Larger files are no manifests, bytes.
const LARGEST: u64 = 64 << 20;

/// Times of samples that a message repeats.
const MOST_TIMES: usize = 10;

/// What decides on the results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of the layout.
    pub hamel_sweep: u32,
    /// Version of the program.
    pub version: String,
    /// The processor's architecture.
    pub architecture: String,
    /// The level of instructions; folders of earlier versions do not tell it.
    #[serde(default)]
    pub level: String,
    /// Sum of the bits of mathematical functions at that level.
    #[serde(default)]
    pub functions: String,
    /// The scene file.
    pub scene: Input,
    /// The table.
    pub table: Input,
    /// Rows of the table.
    pub rows: u64,
    /// Rows of a part.
    pub block: u64,
    /// Format of the parts.
    pub format: String,
    /// Whether errors of motions are estimated.
    pub error_estimate: bool,
    /// By which equations rows move.
    #[serde(default = "tree")]
    pub equations: String,
    /// When states are reported besides the last one, s.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub samples: Vec<f64>,
    /// Which way the rows went that the last command moved; nothing before one has come to its end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moved: Option<Moved>,
}

/// What decides on the results besides scene and table.
pub struct Options<'a> {
    /// Format of the parts.
    pub format: Format,
    /// Whether errors of motions are estimated.
    pub error_estimate: bool,
    /// By which equations rows move.
    pub equations: Equations,
    /// When states are reported besides the last one, s.
    pub times: &'a [f64],
}

/// Which way rows went.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Moved {
    /// How many went side by side.
    pub lanes: u64,
    /// How many went by the tree, by reason.
    pub tree: BTreeMap<String, u64>,
}

/// By which they moved before there was a choice.
fn tree() -> String {
    Equations::Tree.name().to_owned()
}

/// A file that was read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// Its name.
    pub name: String,
    /// FNV-1a of its bytes, 64 bits; of a robot, of the scene that is made of it.
    pub sum: String,
    /// How many bytes.
    pub bytes: u64,
}

impl Manifest {
    /// What is to be swept.
    pub fn new([scene, table]: [Input; 2], rows: u64, block: u64, options: Options<'_>) -> Self {
        let Arithmetic { level, sum } = Arithmetic::own();
        Self {
            hamel_sweep: LAYOUT,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            architecture: std::env::consts::ARCH.to_owned(),
            level: level.to_owned(),
            functions: sum,
            scene,
            table,
            rows,
            block,
            format: options.format.name().to_owned(),
            error_estimate: options.error_estimate,
            equations: options.equations.name().to_owned(),
            samples: options.times.to_vec(),
            moved: None,
        }
    }

    /// That of a folder, if it has one.
    ///
    /// # Errors
    /// A file of its name that is none.
    pub fn read(folder: &Path) -> Result<Option<Self>, Failure> {
        let path = folder.join(NAME);
        let Ok(found) = path.metadata() else {
            return Ok(None);
        };
        let text = (found.is_file() && found.len() <= LARGEST)
            .then(|| std::fs::read(&path).ok())
            .flatten();
        let read = text.and_then(|text| serde_json::from_slice(&text).ok());
        match read {
            Some(manifest) => Ok(Some(manifest)),
            None => Err(Failure::Options(format!(
                "{} does not tell of a sweep: name another folder",
                path.display()
            ))),
        }
    }

    /// As the file has it.
    pub fn text(&self) -> String {
        let text = serde_json::to_string_pretty(self).unwrap_or_default();
        format!("{text}\n")
    }

    /// How this sweep differs from `other`, whose results are there; empty where both are one. A file of another name with the same bytes is the same.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let mut all = Vec::new();
        let mut note = |what: &str, then: &str, now: &str| {
            if then != now {
                all.push(format!("{what} was {then}, and is {now}"));
            }
        };
        let layout = |own: &Self| own.hamel_sweep.to_string();
        note("the layout of the folder", &layout(other), &layout(self));
        note("the program's version", &other.version, &self.version);
        note("the processor", &other.architecture, &self.architecture);
        let level = |own: &Self| match own.level.is_empty() {
            true => "not told".to_owned(),
            false => own.level.clone(),
        };
        note("the level of instructions", &level(other), &level(self));
        if self.level == other.level {
            let what = "the sum of mathematical functions of the C library";
            note(what, &other.functions, &self.functions);
        }
        note("the format", &other.format, &self.format);
        note("--equations", &other.equations, &self.equations);
        let block = |own: &Self| format!("{} rows", own.block);
        note("--block", &block(other), &block(self));
        let estimate = |own: &Self| match own.error_estimate {
            true => "there",
            false => "left out",
        };
        note("the error estimate", estimate(other), estimate(self));
        if self.samples != other.samples {
            let (then, now) = (told_times(&other.samples), told_times(&self.samples));
            all.push(format!("samples were {then}, and are {now}"));
        }
        for (what, then, now) in [
            ("the scene", &other.scene, &self.scene),
            ("the table", &other.table, &self.table),
        ] {
            if (&then.sum, then.bytes) != (&now.sum, now.bytes) {
                let (then, now) = (then.told(), now.told());
                all.push(format!("{what} was {then}, and is {now}"));
            }
        }
        all
    }
}

/// Times of samples, in few words.
fn told_times(times: &[f64]) -> String {
    match times {
        [] => "none".to_owned(),
        [first, .., last] if times.len() > MOST_TIMES => {
            format!("{} from {first} to {last} s", times.len())
        }
        few => format!("at {few:?} s"),
    }
}

impl Input {
    fn told(&self) -> String {
        let Self { name, sum, bytes } = self;
        format!("{name} of {bytes} bytes with the sum {sum}")
    }
}
