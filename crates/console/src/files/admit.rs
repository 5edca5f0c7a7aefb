//! Which files a command may write: none that it reads, no file twice, none that other programs wrote.

use super::draft::Draft;
use super::place::followed;
use crate::output::Failure;
use same_file::Handle;
use std::fs::{self, File, Metadata};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Whether a file is one that this program wrote, so that it may be replaced by another of its kind.
pub type IsOwn = fn(&File) -> bool;

/// A file that may be written.
#[derive(Clone, Debug)]
pub struct Output {
    /// As the user names it; `stdout` where it is that.
    pub(super) named: PathBuf,
    pub(super) place: Place,
    /// Whether nothing may have the name yet.
    pub(super) is_new: bool,
    is_own: IsOwn,
    force: bool,
}

/// Where the bytes go.
#[derive(Clone, Debug)]
pub(super) enum Place {
    /// To a file, which is or will be there.
    File(PathBuf),
    /// To a pipe or a device.
    Stream,
    /// To stdout.
    Stdout,
}

/// The name of stdout where a file could be named; a file of this name is `./-`.
const STDOUT: &str = "-";

/// Whether a path names stdout.
pub fn is_stdout(path: &Path) -> bool {
    path == Path::new(STDOUT)
}

/// Files by which outputs are distinguished.
struct Known {
    /// What is done with it.
    why: &'static str,
    /// The file itself, which other names may lead to as well; absent where there is none yet.
    handle: Option<Handle>,
    /// Where it is; absent of devices.
    place: Option<PathBuf>,
}

/// Why a second output is not admitted to stdout.
const TWO_ON_STDOUT: &str =
    "`-` is stdout, and takes one output: name a file for the other, `./-` for a file of that name";

/// The files `written`, each with what knows those of its kind, of a command that reads the files `read`.
///
/// # Errors
/// A folder that is not there, or that is named as a file. All outputs that are read, by whatever name, link or hard link; that are another output, or where stdout goes;
/// that this program did not write or that are read-only, unless `force`. A second output that is stdout, `-`.
pub fn admit<'a>(
    read: impl IntoIterator<Item = &'a Path>,
    written: impl IntoIterator<Item = (&'a Path, IsOwn)>,
    force: bool,
) -> Result<Vec<Output>, Failure> {
    let mut known: Vec<Known> = stdout().into_iter().collect();
    let mut refused = vec![];
    for path in read {
        let file = Known::new(path, "is read by the same command");
        // What is printed would go to what is read.
        refused.extend(file.refusal(path, &known));
        known.push(file);
    }
    let mut outputs = vec![];
    for (path, is_own) in written {
        let output = Output::new(path, is_own, force)?;
        if output.is_stdout() {
            let is_second = outputs.iter().any(Output::is_stdout);
            refused.extend(is_second.then(|| TWO_ON_STDOUT.to_owned()));
            outputs.push(output);
            continue;
        }
        let file = Known::new(path, "is written by the same command");
        let refusal = file.refusal(path, &known);
        refused.extend(refusal.or_else(|| output.refusal()));
        known.push(file);
        outputs.push(output);
    }
    match refused.is_empty() {
        true => Ok(outputs),
        false => Err(Failure::Options(refused.join("\nerror: "))),
    }
}

/// A file that is to be made, and never replaced.
///
/// # Errors
/// A folder that is not there.
pub fn new_file(path: &Path) -> Result<Output, Failure> {
    let output = Output::new(path, |_| false, true)?;
    Ok(Output {
        is_new: true,
        ..output
    })
}

impl Output {
    fn new(path: &Path, is_own: IsOwn, force: bool) -> Result<Self, Failure> {
        let failed = |error| Failure::write(path, error);
        if is_stdout(path) {
            return Ok(Self {
                named: PathBuf::from("stdout"),
                place: Place::Stdout,
                is_new: false,
                is_own,
                force,
            });
        }
        let place = match fs::metadata(path) {
            Ok(found) if found.is_dir() => {
                return Err(failed(io::ErrorKind::IsADirectory.into()));
            }
            Ok(found) if !found.is_file() => Place::Stream,
            _ => Place::File(followed(path).map_err(failed)?),
        };
        Ok(Self {
            named: path.to_owned(),
            place,
            is_new: false,
            is_own,
            force,
        })
    }

    /// As the user names it; `stdout` where it is that.
    pub fn path(&self) -> &Path {
        &self.named
    }

    /// Whether it goes to stdout.
    pub const fn is_stdout(&self) -> bool {
        matches!(self.place, Place::Stdout)
    }

    /// Begins to write it.
    ///
    /// # Errors
    /// A folder that cannot be written.
    pub fn open(&self) -> Result<Draft, Failure> {
        Draft::open(self.clone()).map_err(|error| Failure::write(&self.named, error))
    }

    /// It with these bytes, still to be finished.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn draft(&self, bytes: impl AsRef<[u8]>) -> Result<Draft, Failure> {
        let mut draft = self.open()?;
        let written = draft.write_all(bytes.as_ref());
        written.map_err(|error| Failure::write(&self.named, error))?;
        Ok(draft)
    }

    /// Writes it.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
        self.draft(bytes)?.finish()
    }

    /// Why it must not be replaced.
    fn refusal(&self) -> Option<String> {
        let shown = self.named.display();
        if self.replaces_other() {
            return Some(format!(
                "{shown} exists and was edited, or was not written by this command: name another file, or replace it with --force"
            ));
        }
        let Place::File(place) = &self.place else {
            return None;
        };
        let is_readonly = fs::metadata(place).is_ok_and(|file| file.permissions().readonly());
        (is_readonly && !self.force)
            .then(|| format!("{shown} is read-only: name another file, or replace it with --force"))
    }

    /// Whether it has the name of a file that this program did not write. An empty file holds nothing that could be lost.
    pub(super) fn replaces_other(&self) -> bool {
        let Place::File(place) = &self.place else {
            return false;
        };
        let is_empty = match fs::metadata(place) {
            Ok(file) => file.len() == 0,
            // Of what is not there nothing is replaced.
            Err(error) if error.kind() == io::ErrorKind::NotFound => true,
            Err(_) => false,
        };
        let is_own = || File::open(place).is_ok_and(|file| (self.is_own)(&file));
        !self.force && !is_empty && !is_own()
    }
}

impl Known {
    fn new(path: &Path, why: &'static str) -> Self {
        let found = fs::metadata(path).ok();
        let is_file = found.as_ref().is_some_and(Metadata::is_file);
        let is_device = found.as_ref().is_some_and(is_device);
        Self {
            why,
            // To open a pipe is to wait for who writes it.
            handle: is_file.then(|| Handle::from_path(path).ok()).flatten(),
            // A terminal is read and written, and what goes to the null device is lost anyway.
            place: followed(path).ok().filter(|_| !is_device),
        }
    }

    /// Why it must not be, after those that are known.
    fn refusal(&self, path: &Path, known: &[Self]) -> Option<String> {
        let same = |other: &&Self| {
            let is_file = self.handle.is_some() && self.handle == other.handle;
            is_file || self.place.is_some() && self.place == other.place
        };
        let other = known.iter().find(same)?;
        let (shown, why) = (path.display(), other.why);
        Some(format!(
            "{shown} would be overwritten: it {why}; name another file for the output"
        ))
    }
}

#[cfg(unix)]
fn is_device(file: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    file.file_type().is_char_device() || file.file_type().is_block_device()
}

#[cfg(not(unix))]
fn is_device(_: &Metadata) -> bool {
    false
}

/// The file to which stdout goes, where that is one.
fn stdout() -> Option<Known> {
    let handle = Handle::stdout().ok()?;
    let is_file = handle.as_file().metadata().is_ok_and(|file| file.is_file());
    is_file.then_some(Known {
        why: "is where stdout goes",
        handle: Some(handle),
        place: None,
    })
}
