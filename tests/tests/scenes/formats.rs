//! Files of earlier versions of the two text formats are read as they were.
//!
//! `tests/data/formats/N` holds files of version N. They are never edited. A program that reads a version no longer refuses its files by a message that names
//! the command that rewrites them; this test then holds that message.

use hamel_codegen::spec;
use hamel_scene::Scene;
use hamel_tests::refusals::files;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

fn folder(version: u32) -> PathBuf {
    let formats = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/formats");
    formats.join(version.to_string())
}

#[test]
fn scenes_of_version_1_are_read() -> Result<(), Box<dyn Error>> {
    let scenes = files(&folder(1), "toml")?;
    assert_eq!(scenes.len(), 3);
    for path in scenes {
        Scene::load(&path, &hamel_joints::registry())?;
    }
    Ok(())
}

#[test]
fn specs_of_version_1_are_read() -> Result<(), Box<dyn Error>> {
    let specs = files(&folder(1), "joint")?;
    assert_eq!(specs.len(), 7);
    for path in specs {
        spec::parse(&fs::read_to_string(&path)?, &path.to_string_lossy())?;
    }
    Ok(())
}
