//! A folder that one command writes at a time.

use crate::output::Failure;
use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::Path;

/// The file that is locked. It stays: without it two commands could lock one file each.
const NAME: &str = ".hamel.lock";

/// A folder that no other command writes while this stands, or until the program ends in whatever way.
#[derive(Debug)]
pub struct Lock {
    _file: File,
}

impl Lock {
    /// Locks a folder for the command of this name.
    ///
    /// # Errors
    /// A folder that another command writes, or that cannot be written.
    pub fn of(folder: &Path, command: &str) -> Result<Self, Failure> {
        let path = folder.join(NAME);
        let failed = |error| Failure::write(&path, error);
        // To open a pipe would wait for its reader.
        if path.metadata().is_ok_and(|known| !known.is_file()) {
            return Err(failed(io::Error::other("it is not a regular file")));
        }
        let mut options = OpenOptions::new();
        let file = options.create(true).append(true).open(&path);
        let file = file.map_err(failed)?;
        match file.try_lock() {
            Ok(()) => Ok(Self { _file: file }),
            Err(TryLockError::Error(error)) => Err(failed(error)),
            Err(TryLockError::WouldBlock) => Err(Failure::Options(format!(
                "{} is being written by another `{command}`: wait until it is done, or name another folder",
                folder.display()
            ))),
        }
    }
}
