//! Where a file is that a user names.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Symbolic links that are followed, as many as Linux follows.
const MOST_LINKS: usize = 40;

/// The path at which the file `path` is, or would be made: symbolic links are followed, also one that leads to nothing yet, so that a link stays a link.
///
/// # Errors
/// A folder that is not there; a path that names no file; links in a circle.
pub fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&path) {
            // An absolute target takes the place of the folder.
            Ok(target) => path = folder(&path).join(target),
            Err(_) => {
                let name = path.file_name().ok_or_else(|| {
                    let kind = io::ErrorKind::InvalidInput;
                    io::Error::new(kind, "the path names no file")
                })?;
                return Ok(folder(&path).canonicalize()?.join(name));
            }
        }
    }
    Err(io::Error::other("symbolic links lead in a circle"))
}

/// The folder in which a path ends.
fn folder(path: &Path) -> &Path {
    let parent = path.parent();
    let parent = parent.filter(|parent| !parent.as_os_str().is_empty());
    parent.unwrap_or(Path::new("."))
}
