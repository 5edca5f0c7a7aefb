//! A file being written beside its name.

use super::Unfinished;
use super::admit::{Output, Place};
use crate::output::Failure;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Write};
use std::path::Path;
use tempfile::NamedTempFile;

/// A file being written. It takes its name by [`Draft::finish`]; dropped before, it is gone, and what has the name is as it was.
#[derive(Debug)]
pub struct Draft {
    output: Output,
    file: Sink,
}

/// What takes the bytes.
#[derive(Debug)]
enum Sink {
    /// A file in the folder of its name.
    Beside(Unfinished<NamedTempFile>),
    /// A pipe or a device, which has no other name.
    Straight(File),
    Stdout(io::Stdout),
}

impl Draft {
    pub(super) fn open(output: Output) -> io::Result<Self> {
        let file = match &output.place {
            Place::Stdout => Sink::Stdout(io::stdout()),
            Place::Stream => Sink::Straight(OpenOptions::new().write(true).open(&output.named)?),
            Place::File(place) => {
                let folder = place.parent().unwrap_or(Path::new("."));
                Sink::Beside(Unfinished::new(|| beside(folder))?)
            }
        };
        Ok(Self { output, file })
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// A file that cannot be written; one of another program that has the name since it was admitted: what was written then stays under the name that the
    /// error tells.
    pub fn finish(mut self) -> Result<(), Failure> {
        let written = self.flush();
        let Self { output, file } = self;
        let failed = |error| Failure::write(&output.named, error);
        written.map_err(failed)?;
        match (file, &output.place) {
            (Sink::Beside(file), Place::File(place)) => name(file, place, &output).map_err(failed),
            _ => Ok(()),
        }
    }

    fn sink(&mut self) -> io::Result<&mut dyn Write> {
        match &mut self.file {
            Sink::Straight(file) => Ok(file),
            Sink::Stdout(stdout) => Ok(stdout),
            Sink::Beside(file) => match file.get_mut() {
                Some(file) => Ok(file.as_file_mut()),
                None => Err(io::ErrorKind::NotFound.into()),
            },
        }
    }
}

/// With the permissions that a new file has.
fn beside(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".hamel-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

fn name(file: Unfinished<NamedTempFile>, place: &Path, output: &Output) -> io::Result<()> {
    file.end(|file| {
        sync(file.as_file())?;
        if let Ok(before) = fs::metadata(place) {
            take_over(file.as_file(), &before);
        }
        let foreign = output.replaces_other();
        let named = match (output.is_new, foreign) {
            (true, _) => file.persist_noclobber(place).map_err(|failed| failed.error),
            (false, false) => file.persist(place).map_err(|failed| failed.error),
            (false, true) => {
                let (_, kept) = file.keep().map_err(|failed| failed.error)?;
                let kept = kept.display();
                return Err(io::Error::other(format!(
                    "another program has written it meanwhile; what was to be written is in {kept}"
                )));
            }
        };
        named.map(drop)
    })
}

/// To the disk, where the file system knows that.
fn sync(file: &File) -> io::Result<()> {
    use io::ErrorKind::{InvalidInput, Unsupported};
    match file.sync_all() {
        Err(error) if matches!(error.kind(), InvalidInput | Unsupported) => Ok(()),
        synced => synced,
    }
}

/// Gives a file the owner and the permissions of the one that it replaces; what cannot be given is that of a new one.
fn take_over(file: &File, before: &Metadata) {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        drop(fchown(file, Some(before.uid()), Some(before.gid())));
    }
    drop(file.set_permissions(before.permissions()));
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.sink()?.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.sink()?.flush()
    }
}
