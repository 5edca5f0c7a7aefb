//! Tables of rows, and parts of results, in either format.

use super::args::Format;
use super::{csv, parquet};
use fnv::FnvHasher;
use hamel_console::files::new_file;
use hamel_console::output::Failure;
use hamel_sweep::{Cells, Row};
use std::fmt::Display;
use std::fs::File;
use std::hash::Hasher;
use std::io::Read;
use std::path::{Path, PathBuf};

/// A table being read.
pub struct Table {
    path: PathBuf,
    reader: Reader,
}

enum Reader {
    Csv(csv::Table),
    Parquet(parquet::Table),
}

/// Results of rows that follow each other.
#[derive(Clone, Copy)]
pub struct Part<'a> {
    /// Place of the first row, from 0.
    pub first: u64,
    pub rows: &'a [Row],
}

impl Table {
    /// Opens a table; its format is determined by the ending of its name.
    ///
    /// # Errors
    /// A file that cannot be read, or has no such ending; columns that hold no numbers.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let reader = match format(path)? {
            Format::Csv => Reader::Csv(csv::Table::open(path)?),
            Format::Parquet => Reader::Parquet(parquet::Table::open(path)?),
        };
        let path = path.to_owned();
        Ok(Self { path, reader })
    }

    /// Names of its columns.
    pub fn names(&self) -> &[String] {
        match &self.reader {
            Reader::Csv(table) => table.names(),
            Reader::Parquet(table) => table.names(),
        }
    }

    /// How many rows are left.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn count(self) -> Result<u64, Failure> {
        match self.reader {
            Reader::Csv(table) => table.count(&self.path),
            Reader::Parquet(table) => Ok(table.count()),
        }
    }

    /// The next rows, as many as there are up to `count`.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn rows(&mut self, count: u64) -> Result<Vec<Cells>, Failure> {
        let count = usize::try_from(count).unwrap_or(usize::MAX);
        match &mut self.reader {
            Reader::Csv(table) => table.rows(count, &self.path),
            Reader::Parquet(table) => table.rows(count, &self.path),
        }
    }
}

/// The format that a name tells.
///
/// # Errors
/// A name that tells none.
pub fn format(path: &Path) -> Result<Format, Failure> {
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    match ending.to_str() {
        Some("csv") => Ok(Format::Csv),
        Some("parquet" | "pq") => Ok(Format::Parquet),
        _ => Err(Failure::Options(format!(
            "{} is no table: its name must end in .csv or .parquet",
            path.display()
        ))),
    }
}

/// Writes a part of the results under a name that nothing has.
///
/// # Errors
/// A file that cannot be written.
pub fn write_part(
    path: &Path,
    format: Format,
    names: &[String],
    part: &Part<'_>,
) -> Result<(), Failure> {
    let draft = new_file(path)?.open()?;
    let written = match format {
        Format::Csv => csv::write_part(draft, names, part),
        Format::Parquet => parquet::write_part(draft, names, part),
    };
    written
        .map_err(|error| Failure::write(path, error))?
        .finish()
}

/// Shows the rows of a part: number from 1, outcome and results.
///
/// # Errors
/// A file that cannot be read, or is no part of these results.
pub fn read_part(
    path: &Path,
    format: Format,
    columns: usize,
    see: &mut dyn FnMut(u64, &str, &[f64]),
) -> Result<(), Failure> {
    match format {
        Format::Csv => csv::read_part(path, columns, see),
        Format::Parquet => parquet::read_part(path, columns, see),
    }
}

/// The sum of a file's bytes, and how many there are.
///
/// # Errors
/// A file that cannot be read.
pub fn sum_of(path: &Path) -> Result<(String, u64), Failure> {
    let failed = |error| unreadable(path, &error);
    let mut file = File::open(path).map_err(failed)?;
    let mut hasher = FnvHasher::default();
    let (mut count, mut bytes) = (0, vec![0; 1 << 16]);
    loop {
        let read = file.read(&mut bytes).map_err(failed)?;
        if read == 0 {
            return Ok((format!("{:016x}", hasher.finish()), count));
        }
        count += read as u64;
        hasher.write(&bytes[..read]);
    }
}

/// The failure to read a table.
pub fn unreadable(path: &Path, why: &dyn Display) -> Failure {
    Failure::Refused(format!("cannot read {}: {why}", path.display()))
}
