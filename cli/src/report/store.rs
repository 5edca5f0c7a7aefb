//! CSV files that grow as figures are measured, and are read again when the command goes on.

use super::row::Row;
use crate::output::Failure;
use std::collections::HashMap;
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The file of one kind of rows: those of all machines that it was measured on.
#[derive(Debug)]
pub struct Store<R> {
    path: PathBuf,
    /// What this machine has measured, by its keys.
    measured: HashMap<String, R>,
}

impl<R: Row> Store<R> {
    /// Opens the file in a folder; where there is none, the first rows make it. Rows of this machine and version count as measured; those of others stay
    /// as they are.
    ///
    /// # Errors
    /// A file that holds other than such rows.
    pub fn open(folder: &Path, machine: &str) -> Result<Self, Failure> {
        let rows = read::<R>(folder)?;
        let path = path::<R>(folder);
        mend(&path).map_err(|error| failure(&path, error))?;
        let own = rows.into_iter().filter(|row| row.machine() == machine);
        Ok(Self {
            measured: own.map(|row| (row.key(), row)).collect(),
            path,
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

    /// Adds rows, which are in the file when this returns.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn add(&mut self, rows: &[R]) -> Result<(), Failure> {
        append(&self.path, rows).map_err(|error| failure(&self.path, error.into()))?;
        let rows = rows.iter().map(|row| (row.key(), row.clone()));
        self.measured.extend(rows);
        Ok(())
    }
}

/// Takes rows out of a file, which is kept as it was beside it as `NAME.1.csv`, or with the next number that is free: what takes their place can be stopped and
/// gone on with as if they had never been.
///
/// # Errors
/// Files that cannot be read or written.
pub fn set_aside<R: Row>(folder: &Path, is_old: impl Fn(&R) -> bool) -> Result<(), Failure> {
    let mut rows = read::<R>(folder)?;
    let count = rows.len();
    rows.retain(|row| !is_old(row));
    if rows.len() == count {
        return Ok(());
    }
    let path = path::<R>(folder);
    let mut copies = (1..).map(|number| path.with_extension(format!("{number}.csv")));
    let aside = copies.find(|copy| !copy.exists()).unwrap_or_default();
    let rest = path.with_extension("new.csv");
    let moved = || -> csv::Result<()> {
        write(csv::Writer::from_path(&rest)?, &rows)?;
        fs::copy(&path, &aside)?;
        Ok(fs::rename(&rest, &path)?)
    };
    moved().map_err(|error| failure(&path, error.into()))
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
