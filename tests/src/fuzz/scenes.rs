//! The scene loader as a target: scene files, and robots in URDF.

use super::corpus::Corpus;
use super::target::{Outcome, guarded, shown};
use crate::refusals::files;
use crate::scenes::difference;
use hamel::registry::JointRegistry;
use hamel_scene::urdf::{self, Options};
use hamel_scene::{Control, Diagnostics, Scene, SceneDescription};
use std::path::{Path, PathBuf};

/// Right and wrong files, as many of the ones as of the others: most mutations make a right one wrong.
fn balanced(right: Vec<String>, wrong: Vec<String>) -> Corpus {
    let count = wrong.len().max(right.len());
    let mut texts: Vec<String> = right.iter().cycle().take(count).cloned().collect();
    texts.extend(wrong);
    Corpus::of(texts, '\n')
}

/// The scenes of the repository, right or wrong, and the examples of the format's description.
///
/// # Panics
/// Where a folder of the repository cannot be read.
pub fn scenes() -> Corpus {
    let root = root();
    let mut right = texts(&root.join("scenes"), "toml");
    let page = std::fs::read_to_string(root.join("scenes/README.md")).expect("the description");
    let examples = page.split("```toml\n").skip(1);
    right.extend(examples.filter_map(|rest| Some(rest.split("```").next()?.to_owned())));
    balanced(right, texts(&root.join("tests/corpus/scenes-bad"), "toml"))
}

/// The controllers of the repository that stand in files of their own.
///
/// # Panics
/// Where a folder of the repository cannot be read.
pub fn controllers() -> Corpus {
    let folders = ["scenes/controllers", "tests/fuzz/seeds/controller"];
    let texts = folders
        .iter()
        .flat_map(|folder| texts(&root().join(folder), "toml"));
    Corpus::of(texts.collect(), '\n')
}

/// The robots of the repository, right or wrong; of the right ones the small.
///
/// # Panics
/// Where a folder of the repository cannot be read.
pub fn robots() -> Corpus {
    /// Real robots are mostly repetition, and would take most of the time.
    const LARGEST: usize = 6000;
    let root = root().join("tests");
    let mut right = texts(&root.join("data/urdf"), "urdf");
    right.retain(|text| text.len() <= LARGEST);
    balanced(right, texts(&root.join("corpus/urdf-bad"), "urdf"))
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn texts(folder: &Path, ending: &str) -> Vec<String> {
    let paths = files(folder, ending).unwrap_or_else(|error| panic!("{folder:?}: {error}"));
    // Bytes that are no UTF-8 never reach the reader.
    paths
        .iter()
        .map(|path| String::from_utf8_lossy(&std::fs::read(path).expect("a file")).into_owned())
        .collect()
}

/// Loads a scene; what is accepted must also come through its own text.
pub fn scene(text: &str, registry: &JointRegistry) -> Outcome {
    guarded(|| {
        match Scene::parse(text, "input.toml", registry) {
            Ok(_) => {}
            Err(errors) => return refused(text, &errors),
        }
        match Scene::from_toml(text, "input.toml") {
            Ok(description) => again(
                &description.to_toml(&[], |_| Vec::new()),
                &description,
                registry,
            ),
            Err(_) => Outcome::Broken("accepted as a whole, refused as a text".into()),
        }
    })
}

/// Loads a robot, with a fixed base and with a floating one; what is accepted must also come through as a scene.
pub fn robot(text: &str, registry: &JointRegistry) -> Outcome {
    guarded(|| {
        let mut last = Outcome::Accepted;
        for floating_base in [false, true] {
            let options = Options {
                floating_base,
                ..Options::default()
            };
            last = match urdf::read(text, "input.urdf", &options) {
                Ok(import) => again(&import.to_toml(), &import.scene, registry),
                Err(errors) => refused(text, &errors),
            };
            if matches!(last, Outcome::Broken(_)) {
                break;
            }
        }
        last
    })
}

/// Reads a controller for `scene`.
pub fn controller(text: &str, scene: &Scene) -> Outcome {
    guarded(|| match Control::parse(text, "input.toml", scene) {
        Ok(_) => Outcome::Accepted,
        Err(errors) => refused(text, &errors),
    })
}

/// Reads what was written for `wanted`.
fn again(text: &str, wanted: &SceneDescription, registry: &JointRegistry) -> Outcome {
    let found = match Scene::from_toml(text, "written.toml") {
        Ok(found) => found,
        Err(errors) => return Outcome::Broken(format!("what is written is refused:\n{errors}")),
    };
    // What overflows in the description does so in both.
    if wanted.build(registry).is_ok() != found.build(registry).is_ok() {
        return Outcome::Broken("what is written builds otherwise".into());
    }
    match difference(&found, wanted) {
        None => Outcome::Accepted,
        Some(what) => Outcome::Broken(format!("what is written says something else: {what}")),
    }
}

fn refused(text: &str, errors: &Diagnostics) -> Outcome {
    let spans = || errors.errors().iter().filter_map(|error| error.span());
    let misplaced = spans().find(|span| text.get((*span).clone()).is_none());
    match (errors.errors().is_empty(), misplaced) {
        (true, _) => Outcome::Broken("refused without an error".into()),
        (_, Some(span)) => Outcome::Broken(format!("an error outside the text: {span:?}")),
        _ => shown(errors.reports()),
    }
}
