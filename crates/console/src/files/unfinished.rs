//! What is removed when the program ends early: files that are not whole yet, and folders for temporary files.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::TempDir;

/// Who makes, finishes or removes one of these holds the lock while he does, so that none is forgotten.
static PATHS: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// A temporary file or folder, which its destructor removes, and an interrupt too.
#[derive(Debug)]
pub struct Unfinished<T: AsRef<Path>> {
    /// There until it ends.
    made: Option<T>,
    path: PathBuf,
}

impl<T: AsRef<Path>> Unfinished<T> {
    /// What `make` makes.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn new(make: impl FnOnce() -> io::Result<T>) -> io::Result<Self> {
        let mut paths = paths();
        let made = make()?;
        let path = made.as_ref().to_owned();
        paths.insert(path.clone());
        Ok(Self {
            made: Some(made),
            path,
        })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// It, unless it has ended.
    pub fn get_mut(&mut self) -> Option<&mut T> {
        self.made.as_mut()
    }

    /// Ends by `end`, which the file or folder may outlive.
    pub fn end<R>(mut self, end: impl FnOnce(T) -> io::Result<R>) -> io::Result<R> {
        let mut paths = paths();
        let made = self.made.take();
        let ended = made.map_or_else(|| Err(io::ErrorKind::NotFound.into()), end);
        paths.remove(&self.path);
        ended
    }
}

impl<T: AsRef<Path>> Drop for Unfinished<T> {
    fn drop(&mut self) {
        if let Some(made) = self.made.take() {
            let mut paths = paths();
            drop(made);
            paths.remove(&self.path);
        }
    }
}

/// A folder for temporary files that its owner alone can enter.
///
/// # Errors
/// A folder that cannot be made.
pub fn private_folder() -> io::Result<Unfinished<TempDir>> {
    Unfinished::new(|| {
        let mut builder = tempfile::Builder::new();
        builder.prefix("hamel-");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // Nobody else may at any time; what the umask takes from the owner is given back.
            let owner = std::fs::Permissions::from_mode(0o700);
            let folder = builder.permissions(owner.clone()).tempdir()?;
            std::fs::set_permissions(folder.path(), owner)?;
            Ok(folder)
        }
        #[cfg(not(unix))]
        builder.tempdir()
    })
}

/// Removes all that is unfinished, and lets nothing be finished any more: the program is to end.
pub fn remove_unfinished() {
    let paths = paths();
    for path in paths.iter() {
        // What cannot be removed stays; there is nobody left to tell.
        drop(match path.is_dir() {
            true => std::fs::remove_dir_all(path),
            false => std::fs::remove_file(path),
        });
    }
    std::mem::forget(paths);
}

fn paths() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    PATHS.lock().unwrap_or_else(PoisonError::into_inner)
}
