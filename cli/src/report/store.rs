//! CSV files that grow as figures are measured, and are read again when the command goes on.

use super::row::Row;
use crate::output::Failure;
use std::collections::HashSet;
use std::fs::{self, File, OpenOptions};
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

/// The file of one kind of rows.
#[derive(Debug)]
pub struct Store<R> {
    path: PathBuf,
    writer: csv::Writer<File>,
    measured: HashSet<String>,
    kind: PhantomData<R>,
}

impl<R: Row> Store<R> {
    /// Opens the file in a folder, or makes it. Rows of this machine and version count as measured, unless all is wanted anew; where others are
    /// left out, the file as it was stays beside the new one, with `before` in its name.
    ///
    /// # Errors
    /// A file that cannot be written, or holds other than such rows.
    pub fn open(folder: &Path, machine: &str, fresh: bool) -> Result<Self, Failure> {
        let path = path::<R>(folder);
        let all = match fresh {
            true => Vec::new(),
            false => read::<R>(folder)?,
        };
        let count = all.len();
        let kept: Vec<R> = all
            .into_iter()
            .filter(|row| row.machine() == machine)
            .collect();
        let failed = |error| failure(&path, error);
        if path.exists() && (fresh || kept.len() < count) {
            fs::rename(&path, path.with_extension("before.csv")).map_err(failed)?;
            // A run that stops between these two leaves nothing half written.
            let whole = path.with_extension("new.csv");
            let mut writer =
                csv::Writer::from_path(&whole).map_err(|error| failed(error.into()))?;
            for row in &kept {
                writer
                    .serialize(row)
                    .map_err(|error| failed(error.into()))?;
            }
            writer.flush().map_err(failed)?;
            fs::rename(&whole, &path).map_err(failed)?;
        }
        let file = OpenOptions::new().create(true).append(true).open(&path);
        let file = file.map_err(failed)?;
        let is_empty = file.metadata().map_err(failed)?.len() == 0;
        let writer = csv::WriterBuilder::new()
            .has_headers(is_empty)
            .from_writer(file);
        Ok(Self {
            writer,
            measured: kept.iter().map(Row::key).collect(),
            path,
            kind: PhantomData,
        })
    }

    /// Whether the file has rows of this key.
    pub fn has(&self, key: &str) -> bool {
        self.measured.contains(key)
    }

    /// Adds rows, which are in the file when this returns.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn add(&mut self, rows: &[R]) -> Result<(), Failure> {
        for row in rows {
            let written = self.writer.serialize(row);
            written.map_err(|error| failure(&self.path, error.into()))?;
            self.measured.insert(row.key());
        }
        self.writer
            .flush()
            .map_err(|error| failure(&self.path, error))
    }
}

/// All rows of a file; none where it is not there.
///
/// # Errors
/// A file that holds other than such rows.
pub fn read<R: Row>(folder: &Path) -> Result<Vec<R>, Failure> {
    let path = path::<R>(folder);
    if !path.exists() {
        return Ok(Vec::new());
    }
    let reader = csv::Reader::from_path(&path);
    let rows = reader.and_then(|mut reader| reader.deserialize().collect());
    rows.map_err(|error| {
        Failure::Page(format!(
            "{}: {error}; `--fresh` measures everything anew",
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
