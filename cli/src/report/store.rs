//! CSV files that grow as figures are measured, and are read again when the command goes on.

use super::row::Row;
use crate::output::Failure;
use std::collections::HashSet;
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The file of one kind of rows: those of all machines that it was measured on.
#[derive(Debug)]
pub struct Store<R> {
    path: PathBuf,
    rows: Vec<R>,
    /// Keys of what this machine has measured and is not to measure anew.
    measured: HashSet<String>,
    machine: String,
}

impl<R: Row> Store<R> {
    /// Opens the file in a folder; where there is none, the first rows make it. Rows of this machine and version count as measured, unless all is wanted
    /// anew; those of others stay as they are.
    ///
    /// # Errors
    /// A file that holds other than such rows.
    pub fn open(folder: &Path, machine: &str, fresh: bool) -> Result<Self, Failure> {
        let rows = read::<R>(folder)?;
        let path = path::<R>(folder);
        mend(&path).map_err(|error| failure(&path, error))?;
        let own = rows.iter().filter(|row| row.machine() == machine && !fresh);
        Ok(Self {
            measured: own.map(Row::key).collect(),
            path,
            machine: machine.into(),
            rows,
        })
    }

    /// Whether this machine has rows of this key.
    pub fn has(&self, key: &str) -> bool {
        self.measured.contains(key)
    }

    /// Adds rows, which are in the file when this returns, in place of those of this machine that have their keys.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn add(&mut self, rows: &[R]) -> Result<(), Failure> {
        let keys: HashSet<String> = rows.iter().map(Row::key).collect();
        let count = self.rows.len();
        let machine = &self.machine;
        self.rows
            .retain(|row| row.machine() != machine || !keys.contains(&row.key()));
        let replaces = self.rows.len() < count;
        self.rows.extend_from_slice(rows);
        self.measured.extend(keys);
        let written = match replaces {
            true => self.rewrite(),
            false => append(&self.path, rows),
        };
        written.map_err(|error| failure(&self.path, error.into()))
    }

    /// All rows to a new file, which then takes the place of the old one: a run that is stopped loses neither.
    fn rewrite(&self) -> csv::Result<()> {
        let whole = self.path.with_extension("new.csv");
        write(csv::Writer::from_path(&whole)?, &self.rows)?;
        Ok(fs::rename(&whole, &self.path)?)
    }
}

/// In one piece, so that what is stopped leaves a whole curve or none, as far as the system allows.
fn append<R: Row>(path: &Path, rows: &[R]) -> csv::Result<()> {
    let mut file = OpenOptions::new().create(true).append(true).open(path)?;
    let is_empty = file.metadata()?.len() == 0;
    let mut text = Vec::new();
    let mut builder = csv::WriterBuilder::new();
    write(builder.has_headers(is_empty).from_writer(&mut text), rows)?;
    Ok(file.write_all(&text)?)
}

fn write<R: Row>(mut writer: csv::Writer<impl Write>, rows: &[R]) -> csv::Result<()> {
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    Ok(writer.flush()?)
}

/// Cuts off a last line that was not written to its end.
fn mend(path: &Path) -> std::io::Result<()> {
    if !path.exists() {
        return Ok(());
    }
    let text = fs::read(path)?;
    match whole(&text).len() {
        length if length < text.len() => {
            let file = OpenOptions::new().write(true).open(path)?;
            file.set_len(length as u64)
        }
        _ => Ok(()),
    }
}

/// The lines that were written to their ends.
fn whole(text: &[u8]) -> &[u8] {
    let end = text.iter().rposition(|byte| *byte == b'\n');
    &text[..end.map_or(0, |end| end + 1)]
}

/// All rows of a file, without a last line that was not written to its end; none where it is not there.
///
/// # Errors
/// A file that holds other than such rows.
pub fn read<R: Row>(folder: &Path) -> Result<Vec<R>, Failure> {
    let path = path::<R>(folder);
    if !path.exists() {
        return Ok(Vec::new());
    }
    let text = fs::read(&path).map_err(|error| failure(&path, error))?;
    let rows: csv::Result<Vec<R>> = csv::Reader::from_reader(whole(&text))
        .deserialize()
        .collect();
    rows.map_err(|error| {
        Failure::Page(format!(
            "{}: {error}; move the file away, or name another folder",
            path.display()
        ))
    })
}

fn path<R: Row>(folder: &Path) -> PathBuf {
    folder.join(R::FILE).with_extension("csv")
}

fn failure(path: &Path, error: std::io::Error) -> Failure {
    Failure::Write {
        target: path.display().to_string(),
        error,
    }
}
