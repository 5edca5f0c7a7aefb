//! The bytes of a file, if it is one and not too large.

use std::io::{self, Read};
use std::path::Path;

/// Most bytes of a file.
const MOST: u64 = 256 << 20;

/// Reads a file. Devices and pipes, which may have no end, are none.
///
/// # Errors
/// What is no file or too large, and what the system says.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let size = match path.metadata()? {
        found if found.is_file() => found.len(),
        _ => return Err(io::Error::other("it is not a file")),
    };
    if size > MOST {
        let message = format!("{} MB, and at most {} are read", size >> 20, MOST >> 20);
        return Err(io::Error::other(message));
    }
    let mut bytes = Vec::new();
    std::fs::File::open(path)?
        .take(MOST)
        .read_to_end(&mut bytes)?;
    Ok(bytes)
}
