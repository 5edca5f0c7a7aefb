//! Texts of files.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// The largest file that is read, in bytes: a spec is much smaller, and its reader says by how much another is too large.
const LARGEST_FILE: u64 = 16 << 20;

/// The text of a file.
///
/// # Errors
/// A file that cannot be read; one that is not UTF-8, with the line where it stops being so.
pub fn read(path: &Path) -> io::Result<String> {
    let mut bytes = vec![];
    File::open(path)?
        .take(LARGEST_FILE + 1)
        .read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LARGEST_FILE {
        let message = format!("it is larger than {} MiB", LARGEST_FILE >> 20);
        return Err(io::Error::new(ErrorKind::InvalidData, message));
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let bytes = error.as_bytes();
        let line = 1 + bytes[..valid].iter().filter(|byte| **byte == b'\n').count();
        let byte = bytes[valid];
        let message =
            format!("its line {line} is not UTF-8: byte {valid} of the file is {byte:#04x}");
        io::Error::new(ErrorKind::InvalidData, message)
    })
}
