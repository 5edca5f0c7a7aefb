//! Folders of broken files, each beside the whole message with which it is refused.
//!
//! A new case is a new file. `UPDATE_EXPECT=1 cargo test` accepts the messages as they are.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

/// The files of a folder with that ending, in the order of their names.
///
/// # Errors
/// A folder that cannot be read.
pub fn files(folder: &Path, ending: &str) -> std::io::Result<Vec<PathBuf>> {
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

/// Compares what `refuse` says of the text and the name of each file with the `.expected` beside it; `None` means accepted.
/// Returns how many files there are.
///
/// # Errors
/// A file that cannot be read.
///
/// # Panics
/// Where a file is accepted, another message comes, or an expected message has lost its file.
pub fn check(
    folder: &Path,
    ending: &str,
    refuse: impl Fn(&str, &str) -> Option<String>,
) -> Result<usize, Box<dyn Error>> {
    let update = std::env::var_os("UPDATE_EXPECT").is_some();
    let broken = files(folder, ending)?;
    let mut differing = Vec::new();
    for path in &broken {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let message = refuse(&fs::read_to_string(path)?, &name);
        let message = message.unwrap_or_else(|| panic!("{} is not refused", path.display()));
        let expected = path.with_extension("expected");
        if update {
            fs::write(&expected, &message)?;
        } else if fs::read_to_string(&expected).ok().as_ref() != Some(&message) {
            differing.push(format!("{}:\n{message}", path.display()));
        }
    }
    let differing = differing.join("\n");
    assert!(
        differing.is_empty(),
        "other messages than expected:\n{differing}"
    );
    for expected in files(folder, "expected")? {
        let file = expected.with_extension(ending);
        assert!(file.exists(), "{} is gone", file.display());
    }
    Ok(broken.len())
}
