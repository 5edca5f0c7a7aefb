//! Every scene in `scenes/` and every example of the format's description loads; every file of `corpus/scenes-bad` is refused
//! with exactly the message that stands beside it.
//!
//! A new case is a new file. `UPDATE_EXPECT=1 cargo test` accepts the messages as they are.

use hamel_scene::Scene;
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

fn files(folder: &Path, ending: &str) -> std::io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|found| found == ending) {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

fn refusal(path: &Path) -> Result<String, Box<dyn Error>> {
    let name = path
        .file_name()
        .ok_or("a file has a name")?
        .to_string_lossy();
    let text = fs::read_to_string(path)?;
    match Scene::parse(&text, &name, &hamel_tests::paper_registry()) {
        Ok(_) => Ok(String::from("accepted\n")),
        Err(diagnostics) => Ok(diagnostics.to_string()),
    }
}

#[test]
fn broken_scenes_are_refused_with_their_messages() -> Result<(), Box<dyn Error>> {
    let folder = root().join("tests/corpus/scenes-bad");
    let update = std::env::var_os("UPDATE_EXPECT").is_some();
    let scenes = files(&folder, "toml")?;
    assert!(scenes.len() >= 25, "the corpus has {} files", scenes.len());
    let mut differing = Vec::new();
    for path in &scenes {
        let message = refusal(path)?;
        assert_ne!(message, "accepted\n", "{} is not refused", path.display());
        let expected = path.with_extension("expected");
        if update {
            fs::write(&expected, &message)?;
        } else if fs::read_to_string(&expected).ok().as_ref() != Some(&message) {
            differing.push(format!("{}:\n{message}", path.display()));
        }
    }
    assert!(
        differing.is_empty(),
        "other messages than expected:\n{}",
        differing.join("\n")
    );
    Ok(())
}

#[test]
fn every_expected_message_has_its_scene() -> Result<(), Box<dyn Error>> {
    for expected in files(&root().join("tests/corpus/scenes-bad"), "expected")? {
        assert!(
            expected.with_extension("toml").exists(),
            "{}",
            expected.display()
        );
    }
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
    let text = fs::read_to_string(root().join("scenes/README.md"))?;
    let examples = text
        .split("```toml\n")
        .skip(1)
        .filter_map(|rest| rest.split("```").next());
    let mut count = 0;
    for example in examples {
        let whole = match example.split_once('\n') {
            Some(("[[body]]", _)) => format!("{HEADER}{example}"),
            Some(("[simulation]", _)) => format!("{HEADER}{BODY}{example}"),
            _ => example.to_owned(),
        };
        Scene::parse(&whole, "scenes/README.md", &hamel_joints::registry())
            .map_err(|error| format!("in scenes/README.md:\n{error}"))?;
        count += 1;
    }
    assert!(count >= 4, "the description has {count} examples");
    Ok(())
}

#[test]
fn files_that_cannot_be_read_are_refused() -> Result<(), Box<dyn Error>> {
    let registry = hamel_joints::registry();
    let folder = tempdir()?;
    let bytes = folder.join("bytes.toml");
    fs::write(&bytes, b"hamel = 1\nname = \"\xff\"\n")?;
    for (path, reason) in [
        (&bytes, "byte 18 is not UTF-8"),
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
