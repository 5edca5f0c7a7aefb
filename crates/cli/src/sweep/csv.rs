//! Tables and results as CSV.

use super::table::{Part, unreadable};
use csv::{ByteRecord, Reader, ReaderBuilder, Writer};
use hamel_console::cells::cell;
use hamel_console::files::Draft;
use hamel_console::output::Failure;
use hamel_scene::text::visible_line;
use hamel_sweep::Cells;
use std::fs::File;
use std::io;
use std::path::Path;

/// Longest cell that a message repeats, characters.
const LONGEST: usize = 40;

/// A table being read.
pub struct Table {
    reader: Reader<File>,
    names: Vec<String>,
    record: ByteRecord,
}

impl Table {
    /// Opens a table.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let file = File::open(path).map_err(|error| unreadable(path, &error))?;
        let mut reader = ReaderBuilder::new().flexible(true).from_reader(file);
        let header = reader.byte_headers();
        let header = header.map_err(|error| unreadable(path, &error))?;
        let names = header
            .iter()
            .map(|name| String::from_utf8_lossy(name).trim().to_owned());
        Ok(Self {
            names: names.collect(),
            reader,
            record: ByteRecord::new(),
        })
    }

    /// Names of the columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Rows to the end.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn count(mut self, path: &Path) -> Result<u64, Failure> {
        let mut count = 0;
        while self.record(path)? {
            count += 1;
        }
        Ok(count)
    }

    fn record(&mut self, path: &Path) -> Result<bool, Failure> {
        let read = self.reader.read_byte_record(&mut self.record);
        read.map_err(|error| unreadable(path, &error))
    }

    /// The next rows, as many as there are.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn rows(&mut self, count: usize, path: &Path) -> Result<Vec<Cells>, Failure> {
        let mut rows = Vec::new();
        while rows.len() < count && self.record(path)? {
            rows.push(self.cells());
        }
        Ok(rows)
    }

    fn cells(&self) -> Cells {
        let numbers = self.record.iter().zip(&self.names).map(|(cell, name)| {
            let text = String::from_utf8_lossy(cell);
            let text = text.trim();
            text.parse::<f64>().map_err(|_| match text.is_empty() {
                true => format!("column `{name}`: the cell is empty"),
                false => {
                    let mut shown: String = text.chars().take(LONGEST).collect();
                    if shown.len() < text.len() {
                        shown.push('…');
                    }
                    let shown = visible_line(&shown);
                    format!("column `{name}`: the cell `{shown}` is no number")
                }
            })
        });
        let numbers: Result<Vec<f64>, String> = numbers.collect();
        let (found, wanted) = (self.record.len(), self.names.len());
        match numbers {
            Ok(_) if found != wanted => Cells {
                fault: Some(format!(
                    "the row has {found} cells, and the table {wanted} columns"
                )),
                ..Cells::default()
            },
            Ok(numbers) => Cells::from(numbers),
            Err(fault) => Cells {
                numbers: Vec::new(),
                fault: Some(fault),
            },
        }
    }
}

/// Writes a part of the results.
///
/// # Errors
/// A file that cannot be written.
pub fn write_part(draft: Draft, names: &[String], part: &Part<'_>) -> io::Result<Draft> {
    let mut writer = Writer::from_writer(io::BufWriter::new(draft));
    let fixed = ["row", "outcome"].map(str::to_owned);
    let header = fixed.into_iter().chain(names.iter().map(|name| cell(name)));
    writer.write_record(header)?;
    for (row, result) in (part.first + 1..).zip(part.rows) {
        let numbers = result.numbers.iter().map(|number| format!("{number:?}"));
        let fixed = [row.to_string(), cell(&result.outcome.to_string())];
        writer.write_record(fixed.into_iter().chain(numbers))?;
    }
    let buffer = writer.into_inner().map_err(|error| error.into_error())?;
    buffer.into_inner().map_err(|error| error.into_error())
}

/// Shows rows of a part: number, outcome and results.
///
/// # Errors
/// A file that cannot be read, or is no part of results with so many columns.
pub fn read_part(
    path: &Path,
    columns: usize,
    see: &mut dyn FnMut(u64, &str, &[f64]),
) -> Result<(), Failure> {
    let file = File::open(path).map_err(|error| unreadable(path, &error))?;
    let mut reader = Reader::from_reader(file);
    let mut numbers = Vec::with_capacity(columns);
    for record in reader.records() {
        let record = record.map_err(|error| unreadable(path, &error))?;
        let mut cells = record.iter();
        let row = cells.next().and_then(|row| row.parse().ok());
        let outcome = cells.next();
        numbers.clear();
        numbers.extend(cells.map_while(|cell| cell.parse::<f64>().ok()));
        match (row, outcome) {
            (Some(row), Some(outcome)) if numbers.len() == columns => see(row, outcome, &numbers),
            _ => return Err(unreadable(path, &"it is no part of these results")),
        }
    }
    Ok(())
}

/// Writes a small table of texts.
///
/// # Errors
/// A file that cannot be written.
pub fn write_texts(draft: Draft, rows: impl Iterator<Item = Vec<String>>) -> io::Result<Draft> {
    let mut writer = Writer::from_writer(draft);
    for row in rows {
        writer.write_record(row.iter().map(|text| cell(text)))?;
    }
    writer.into_inner().map_err(|error| error.into_error())
}
