//! A folder of results: parts that are written whole, and the manifest that says of what.

use super::args::Format;
use super::manifest::{Manifest, Moved, NAME};
use super::table::{self, Part};
use hamel_console::files::{IsOwn, Lock, admit, first_line, new_file};
use hamel_console::output::Failure;
use hamel_lanes::Ways;
use hamel_sweep::{Block, Outcome, Row};
use std::fs;
use std::path::{Path, PathBuf};

/// A folder that this command writes.
pub struct Folder {
    path: PathBuf,
    _lock: Lock,
    /// What it holds.
    pub manifest: Manifest,
    format: Format,
    /// Whether it was there before, with results of the same sweep.
    pub is_resumed: bool,
}

impl Folder {
    /// The folder `path` for what `manifest` tells: made, or resumed. `is_block_open` leaves the rows of a part to one that is there.
    ///
    /// # Errors
    /// A folder that holds another sweep, or files that are none; one that another command writes, or that cannot be written.
    pub fn open(
        path: &Path,
        mut manifest: Manifest,
        format: Format,
        is_block_open: bool,
    ) -> Result<Self, Failure> {
        fs::create_dir_all(path).map_err(|error| Failure::write(path, error))?;
        let found = Manifest::read(path)?;
        if found.is_none() {
            check_empty(path)?;
        }
        let lock = Lock::of(path, "hamel sweep")?;
        if let Some(found) = &found {
            if is_block_open {
                manifest.block = found.block;
            }
            manifest.moved.clone_from(&found.moved);
            let differences = manifest.differences(found);
            if !differences.is_empty() {
                return Err(Failure::Options(format!(
                    "{} holds the results of another sweep, and stays as it is: name another folder\n  {}",
                    path.display(),
                    differences.join("\n  ")
                )));
            }
        }
        let is_resumed = found.is_some();
        if !is_resumed {
            new_file(&path.join(NAME))?.write(manifest.text())?;
        }
        Ok(Self {
            path: path.to_owned(),
            _lock: lock,
            manifest,
            format,
            is_resumed,
        })
    }

    /// Tells in the manifest which way the rows went that this command moved.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn tell(&mut self, ways: Ways) -> Result<(), Failure> {
        let Ways { lanes, tree } = ways;
        self.manifest.moved = Some(Moved { lanes, tree });
        let path = self.path.join(NAME);
        let own: IsOwn = |file| first_line(file) == "{";
        match &*admit([], [(&*path, own)], false)? {
            [output] => output.write(self.manifest.text()),
            _ => Ok(()),
        }
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Format of the parts.
    pub const fn format(&self) -> Format {
        self.format
    }

    /// How many parts there will be.
    pub const fn parts(&self) -> u64 {
        self.manifest.rows.div_ceil(self.manifest.block)
    }

    /// The file of a part, from 0; its name counts from 1.
    pub fn part(&self, number: u64) -> PathBuf {
        let ending = self.format.name();
        self.path.join(format!("part-{:06}.{ending}", number + 1))
    }

    /// Rows of a part.
    pub fn rows_of(&self, number: u64) -> u64 {
        let first = number * self.manifest.block;
        self.manifest.block.min(self.manifest.rows - first)
    }

    /// Writes the part that is the block.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, names: &[String], block: &Block, rows: &[Row]) -> Result<(), Failure> {
        let path = self.part(block.first / self.manifest.block);
        let part = Part {
            first: block.first,
            rows,
        };
        table::write_part(&path, self.format, names, &part)
    }

    /// Shows all rows that are there, in their order.
    ///
    /// # Errors
    /// A part that cannot be read, or does not hold its rows.
    pub fn read(
        &self,
        columns: usize,
        see: &mut dyn FnMut(u64, &Outcome, &[f64]),
    ) -> Result<(), Failure> {
        for number in 0..self.parts() {
            let path = self.part(number);
            let mut expected = number * self.manifest.block;
            let end = expected + self.rows_of(number);
            let mut fits = true;
            table::read_part(&path, self.format, columns, &mut |row, outcome, numbers| {
                expected += 1;
                match outcome.parse() {
                    Ok(outcome) if row == expected => see(row, &outcome, numbers),
                    _ => fits = false,
                }
            })?;
            if !fits || expected != end {
                return Err(table::unreadable(
                    &path,
                    &"it does not hold the rows of this part: remove it, and the same command computes it again",
                ));
            }
        }
        Ok(())
    }
}

/// A folder without a manifest is new: nothing stands in it.
fn check_empty(path: &Path) -> Result<(), Failure> {
    let entries = fs::read_dir(path).map_err(|error| Failure::write(path, error))?;
    let names = entries.filter_map(|entry| Some(entry.ok()?.file_name().into_string().ok()));
    // What a command leaves that was killed before it began.
    let other = names
        .map(Option::unwrap_or_default)
        .find(|name| !name.starts_with(".hamel"));
    match other {
        None => Ok(()),
        Some(name) => Err(Failure::Options(format!(
            "{} holds {name} and no {NAME}: name a folder of its own for the results",
            path.display()
        ))),
    }
}
