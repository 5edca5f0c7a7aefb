//! CSV files that grow as figures are measured, and are read again when the command goes on.

use super::row::{Build, Drift, Estimate, Row, Stability, Work};
use hamel_console::files::{Output, admit, new_file};
use hamel_console::interrupt;
use hamel_console::output::Failure;
use std::collections::HashMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Figures are written out no more often than this…
const SELDOM: Duration = Duration::from_secs(1);
/// …and so that it takes no more than this part of the time: a file is written as a whole.
const SHARE: u32 = 100;

/// More than the names of columns take, bytes.
const LONGEST: u64 = 1 << 12;

/// All that is measured.
#[derive(Debug)]
pub struct Stores {
    pub work: Store<Work>,
    pub estimates: Store<Estimate>,
    pub build: Store<Build>,
    pub stability: Store<Stability>,
    pub drift: Store<Drift>,
}

impl Stores {
    /// Writes what is not in the files yet.
    ///
    /// # Errors
    /// Files that cannot be written.
    pub fn save(&mut self) -> Result<(), Failure> {
        let saved = [
            self.work.save(),
            self.estimates.save(),
            self.build.save(),
            self.stability.save(),
            self.drift.save(),
        ];
        saved.into_iter().collect()
    }
}

/// The file of one kind of rows: those of all machines that it was measured on.
#[derive(Debug)]
pub struct Store<R> {
    output: Output,
    /// What the file is to hold.
    text: Vec<u8>,
    /// What this machine has measured, by its keys.
    measured: HashMap<String, R>,
    is_saved: bool,
    /// When the next rows are written out.
    next: Instant,
}

impl<R: Row> Store<R> {
    /// Opens the file in a folder; where there is none, the first rows make it. Rows of this machine and version count as measured; those of others stay
    /// as they are.
    ///
    /// # Errors
    /// A file that holds other than such rows.
    pub fn open(folder: &Path, machine: &str) -> Result<Self, Failure> {
        let text = text::<R>(folder)?;
        let rows = rows::<R>(folder, &text)?;
        let own = rows.into_iter().filter(|row| row.machine() == machine);
        Ok(Self {
            measured: own.map(|row| (row.key(), row)).collect(),
            output: output::<R>(folder)?,
            text,
            is_saved: true,
            next: Instant::now(),
        })
    }

    /// What this machine has measured of this key.
    pub fn find(&self, key: &str) -> Option<&R> {
        self.measured.get(key)
    }

    /// All that this machine has measured, in no order.
    pub fn measured(&self) -> impl Iterator<Item = &R> {
        self.measured.values()
    }

    /// Adds rows, which are in the file soon, and when [`Store::save`] returns.
    ///
    /// # Errors
    /// A file that cannot be written; an interrupt, after which nothing more is to be measured.
    pub fn add(&mut self, rows: &[R]) -> Result<(), Failure> {
        let written = append(&mut self.text, rows);
        written.map_err(|error| Failure::write(self.output.path(), error.into()))?;
        self.is_saved = false;
        let rows = rows.iter().map(|row| (row.key(), row.clone()));
        self.measured.extend(rows);
        if interrupt::is_requested() {
            return Err(Failure::Interrupted(String::from(
                "what was measured is in the files; called again, the command goes on from there",
            )));
        }
        match Instant::now() > self.next {
            true => self.save(),
            false => Ok(()),
        }
    }

    /// Writes what is not in the file yet.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn save(&mut self) -> Result<(), Failure> {
        if self.is_saved {
            return Ok(());
        }
        let start = Instant::now();
        self.output.write(&self.text)?;
        self.is_saved = true;
        self.next = Instant::now() + SELDOM.max(SHARE * start.elapsed());
        Ok(())
    }
}

/// Takes rows out of a file. The file as it was is kept beside it as `NAME.1.csv`, or with the next number that is free. The rows are measured again, and
/// that can be stopped and resumed like any measurement.
///
/// # Errors
/// Files that cannot be read or written.
pub fn set_aside<R: Row>(folder: &Path, is_old: impl Fn(&R) -> bool) -> Result<(), Failure> {
    let before = text::<R>(folder)?;
    let mut rows = rows::<R>(folder, &before)?;
    let count = rows.len();
    rows.retain(|row| !is_old(row));
    if rows.len() == count {
        return Ok(());
    }
    let path = path::<R>(folder);
    let mut copies = (1..).map(|number| path.with_extension(format!("{number}.csv")));
    let aside = copies.find(|copy| !copy.exists()).unwrap_or_default();
    // Also without a row: a file of no names would be nobody's.
    let mut rest = names::<R>();
    append(&mut rest, &rows).map_err(|error| Failure::write(&path, error.into()))?;
    new_file(&aside)?.write(before)?;
    output::<R>(folder)?.write(rest)
}

/// All rows of a file, without a last line that was not written to its end; none where it is not there.
///
/// # Errors
/// A file that holds other than such rows.
pub fn read<R: Row>(folder: &Path) -> Result<Vec<R>, Failure> {
    rows(folder, &text::<R>(folder)?)
}

/// Adds lines, under that of names where there is none yet.
fn append<R: Row>(text: &mut Vec<u8>, rows: &[R]) -> csv::Result<()> {
    let mut builder = csv::WriterBuilder::new();
    let mut writer = builder.has_headers(text.is_empty()).from_writer(text);
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    Ok(writer.flush()?)
}

/// The lines of a file that were written to their ends: versions before this one appended them, and could be stopped within.
///
/// # Errors
/// A file that cannot be read, or has other columns.
fn text<R: Row>(folder: &Path) -> Result<Vec<u8>, Failure> {
    let path = path::<R>(folder);
    if !path.exists() {
        return Ok(Vec::new());
    }
    if !path.is_file() {
        return Err(foreign(&path, &"it is not a regular file"));
    }
    let mut text = fs::read(&path).map_err(|error| Failure::write(&path, error))?;
    if !has_columns::<R>(&text) {
        return Err(foreign(&path, &"its columns are others"));
    }
    let end = text.iter().rposition(|byte| *byte == b'\n');
    text.truncate(end.map_or(0, |end| end + 1));
    Ok(text)
}

fn rows<R: Row>(folder: &Path, text: &[u8]) -> Result<Vec<R>, Failure> {
    let rows: csv::Result<Vec<R>> = csv::Reader::from_reader(text).deserialize().collect();
    rows.map_err(|error| foreign(&path::<R>(folder), &error))
}

/// Whether a file has the columns of these rows.
fn is_own<R: Row>(file: &File) -> bool {
    let mut begin = vec![];
    let read = file.take(LONGEST).read_to_end(&mut begin);
    read.is_ok() && has_columns::<R>(&begin)
}

/// Whether the first line has the names of these rows, or was stopped while they were written.
fn has_columns<R: Row>(text: &[u8]) -> bool {
    let names = names::<R>();
    text.starts_with(&names) || names.starts_with(text)
}

/// The line of names.
fn names<R: Row>() -> Vec<u8> {
    let mut text = vec![];
    let written = append(&mut text, &[R::default()]);
    let end = text.iter().position(|byte| *byte == b'\n');
    text.truncate(end.map_or(0, |end| end + 1));
    // A vector takes all that is written.
    debug_assert!(written.is_ok() && !text.is_empty());
    text
}

fn output<R: Row>(folder: &Path) -> Result<Output, Failure> {
    let path = path::<R>(folder);
    let admitted = admit([], [(&*path, is_own::<R> as _)], false)?.pop();
    admitted.ok_or_else(|| Failure::write(&path, std::io::ErrorKind::NotFound.into()))
}

/// A file that somebody else has written.
pub fn foreign(path: &Path, error: &dyn std::fmt::Display) -> Failure {
    Failure::Page(format!(
        "{}: {error}; move the file away, or name another folder",
        path.display()
    ))
}

fn path<R: Row>(folder: &Path) -> PathBuf {
    folder.join(R::FILE).with_extension("csv")
}
