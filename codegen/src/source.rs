//! Texts of files.

use std::io::{self, ErrorKind};
use std::path::Path;

/// The text of a file.
///
/// # Errors
/// A file that cannot be read; one that is not UTF-8, with the line where it stops being so.
pub fn read(path: &Path) -> io::Result<String> {
    String::from_utf8(std::fs::read(path)?).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let bytes = error.as_bytes();
        let line = 1 + bytes[..valid].iter().filter(|byte| **byte == b'\n').count();
        let byte = bytes[valid];
        let message =
            format!("its line {line} is not UTF-8: byte {valid} of the file is {byte:#04x}");
        io::Error::new(ErrorKind::InvalidData, message)
    })
}
