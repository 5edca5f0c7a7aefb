//! A folder of a test, and the program run in it.

use super::common::interruptible;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// A folder of its own, with a scene and a robot in it.
pub struct Place {
    folder: TempDir,
}

impl Place {
    pub fn new() -> Self {
        let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a folder");
        let place = Self { folder };
        place.take("scenes/heavy_top.toml", "top.toml");
        place.take("tests/data/urdf/panda7.urdf", "panda.urdf");
        place.take("joint-specs/ball.joint", "ball.joint");
        place
    }

    /// Copies a file of the repository.
    pub fn take(&self, file: &str, name: &str) {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        fs::copy(root.join(file), self.path(name)).expect("a file of the repository");
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).expect("a file");
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Names of all files, ascending.
    pub fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).expect("a folder");
        let names = entries.map(|entry| entry.expect("an entry").file_name());
        let mut names: Vec<String> = names
            .map(|name| name.to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    /// The program in this folder, with these words as arguments.
    pub fn command(&self, words: &str) -> Command {
        let mut command = interruptible();
        command.current_dir(self.folder.path());
        command.args(words.split_whitespace());
        command
    }

    pub fn run(&self, words: &str) -> Output {
        self.command(words).output().expect("the program starts")
    }

    /// Runs what succeeds.
    pub fn done(&self, words: &str) {
        let output = self.run(words);
        assert!(output.status.success(), "{words}: {}", said(&output));
    }

    /// Runs what is refused; what it says.
    pub fn refused(&self, words: &str, code: i32) -> String {
        let output = self.run(words);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(code), "{words}: {said}");
        said
    }
}

pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}
