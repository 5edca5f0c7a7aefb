//! Files that are refused in pinned words.

use hamel_scene::robot::{Options, read};
use std::fs;
use std::path::{Path, PathBuf};

/// Every file of the folder with that ending, at least so many, is refused as is written beside it; `UPDATE_EXPECT=1` writes what is said.
///
/// # Panics
/// Where one is read, or refused in other words.
pub fn check(folder: &Path, ending: &str, least: usize) {
    let mut files: Vec<PathBuf> = fs::read_dir(folder)
        .expect("the corpus")
        .map(|entry| entry.expect("a file").path())
        .filter(|path| path.extension().is_some_and(|own| own == ending))
        .collect();
    files.sort();
    assert!(files.len() >= least, "{} files", files.len());
    let mut wrong = Vec::new();
    for path in files {
        let text = fs::read_to_string(&path).expect("a text");
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let said = match read(&text, &name, &Options::default()) {
            Ok(_) => String::from("it is read\n"),
            Err(errors) => errors.to_string(),
        };
        let expected = path.with_extension("expected");
        if std::env::var_os("UPDATE_EXPECT").is_some() {
            fs::write(&expected, &said).expect("a folder that can be written");
        }
        let wanted = fs::read_to_string(&expected).unwrap_or_default();
        if said != wanted || said == "it is read\n" {
            wrong.push(format!("{name}:\n{said}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
