//! Every scene in `scenes/` and every example of the format's description loads; every file of `corpus/scenes-bad` is refused
//! with exactly the message that stands beside it.
//!
//! A new case is a new file. `UPDATE_EXPECT=1 cargo test` accepts the messages as they are.

use hamel_scene::Scene;
use hamel_tests::refusals::{self, files};
use hamel_tests::scenes::difference;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

/// What a fragment of the format's description needs to be a scene.
const HEADER: &str = "hamel = 1\ngravity = [0.0, 0.0, -9.81]\n";
const BODY: &str = "[[body]]\nname = \"link\"\nparent = \"world\"\nmass = 1.0\njoint = { type = \"revolute\" }\n\
                    inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]\n";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn refusal(text: &str, name: &str) -> Option<String> {
    let scene = Scene::parse(text, name, &hamel_tests::corpus_registry());
    scene.err().map(|diagnostics| diagnostics.to_string())
}

#[test]
fn broken_scenes_are_refused_with_their_messages() -> Result<(), Box<dyn Error>> {
    let folder = root().join("tests/corpus/scenes-bad");
    let count = refusals::check(&folder, "toml", refusal)?;
    assert!(count >= 100, "the corpus has {count} files");
    Ok(())
}

#[test]
fn every_scene_loads_at_home_on_its_manifolds() -> Result<(), Box<dyn Error>> {
    let scenes = files(&root().join("scenes"), "toml")?;
    assert!(scenes.len() >= 3);
    for path in scenes {
        let scene = Scene::load(&path, &hamel_joints::registry())?;
        scene.mechanism.check_configuration(&scene.configuration)?;
        scene.mechanism.check_speeds("speeds", &scene.speeds)?;
        let stem = path
            .file_stem()
            .map(|stem| stem.to_string_lossy().into_owned());
        assert_eq!(Some(&scene.name), stem.as_ref());
        assert!(!scene.description.is_empty());
    }
    Ok(())
}

#[test]
fn examples_of_the_description_load() -> Result<(), Box<dyn Error>> {
    for example in examples()? {
        Scene::parse(&example, "example.toml", &hamel_joints::registry())
            .map_err(|error| format!("in a document:\n{error}"))?;
    }
    Ok(())
}

/// The examples of the description, each a whole scene.
fn examples() -> Result<Vec<String>, Box<dyn Error>> {
    let text = fs::read_to_string(root().join("scenes/README.md"))?;
    let examples = text
        .split("```toml\n")
        .skip(1)
        .filter_map(|rest| rest.split("```").next());
    let examples: Vec<String> = examples.map(completed).collect();
    assert!(
        examples.len() >= 6,
        "the description has {} examples",
        examples.len()
    );
    Ok(examples)
}

/// A fragment of the description with what it needs to be a scene.
fn completed(example: &str) -> String {
    match example.split_once('\n') {
        Some(("[[body]]", _)) => format!("{HEADER}{example}"),
        Some(("[simulation]", _)) => format!("{HEADER}{BODY}{example}"),
        _ => example.to_owned(),
    }
}

/// What is read of a written scene says all that the scene says.
#[test]
fn scenes_come_through_their_own_text() -> Result<(), Box<dyn Error>> {
    let mut texts = examples()?;
    for path in files(&root().join("scenes"), "toml")? {
        texts.push(fs::read_to_string(path)?);
    }
    for text in texts {
        let description = Scene::from_toml(&text, "scene.toml")?;
        let written = description.to_toml(&[], |_| Vec::new());
        let again = Scene::from_toml(&written, "written.toml")?;
        assert_eq!(difference(&again, &description), None, "{written}");
    }
    Ok(())
}

#[test]
fn files_that_cannot_be_read_are_refused() -> Result<(), Box<dyn Error>> {
    let registry = hamel_joints::registry();
    let folder = tempdir()?;
    let bytes = folder.join("bytes.toml");
    fs::write(&bytes, b"hamel = 1\nname = \"\xff\"\n")?;
    for (path, reason) in [
        (
            &bytes,
            "its line 2 is not UTF-8: byte 18 of the file is 0xff",
        ),
        (&folder, "cannot read"),
        (&folder.join("absent.toml"), "cannot read"),
    ] {
        let error = Scene::load(path, &registry)
            .err()
            .ok_or("refused")?
            .to_string();
        assert!(error.contains(reason), "{error}");
    }
    Ok(())
}

/// A folder of this test's own, below the one that cargo keeps for tests.
fn tempdir() -> std::io::Result<PathBuf> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("scene_files");
    fs::create_dir_all(&folder)?;
    Ok(folder)
}
