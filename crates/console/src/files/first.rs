//! The beginning of a file, by which commands know what they have written.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};

/// Lines by which files are known are shorter, bytes.
const LONGEST: u64 = 1 << 16;

/// The first line of a file without its end; empty where that is no text.
pub fn first_line(file: &File) -> String {
    let mut line = String::new();
    let read = BufReader::new(file.take(LONGEST)).read_line(&mut line);
    match read {
        Ok(_) => line.trim_end().to_owned(),
        Err(_) => String::new(),
    }
}
