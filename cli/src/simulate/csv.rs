//! The trajectory as CSV: one row a sample, units in the names of the columns.

use super::sample::Sample;
use crate::output::Failure;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// Endings of a body's columns; each stands after the body's name and a point.
const COLUMNS: [&str; 12] = [
    "x_m",
    "y_m",
    "z_m",
    "rx_rad",
    "ry_rad",
    "rz_rad",
    "vx_m_per_s",
    "vy_m_per_s",
    "vz_m_per_s",
    "wx_rad_per_s",
    "wy_rad_per_s",
    "wz_rad_per_s",
];

/// Names of the columns: of time, energy, and twelve for each body. [`Sample::numbers`] has the numbers under them.
pub fn columns<'a>(bodies: impl Iterator<Item = &'a str>) -> Vec<String> {
    let columns = bodies.flat_map(|body| COLUMNS.map(|column| format!("{body}.{column}")));
    let head = ["t_s", "energy_J"].map(String::from).into_iter();
    head.chain(columns).collect()
}

/// A CSV file being written.
pub struct Trajectory {
    writer: csv::Writer<BufWriter<File>>,
    target: String,
}

impl Trajectory {
    /// Creates the file `path` with its header row.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn create<'a>(path: &Path, bodies: impl Iterator<Item = &'a str>) -> Result<Self, Failure> {
        let target = path.display().to_string();
        let file = File::create(path).map_err(|error| Failure::Write {
            target: target.clone(),
            error,
        })?;
        let writer = csv::Writer::from_writer(BufWriter::new(file));
        let mut trajectory = Self { writer, target };
        trajectory.record(columns(bodies).into_iter())?;
        Ok(trajectory)
    }

    /// Adds a row.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&mut self, sample: &Sample<'_>) -> Result<(), Failure> {
        // The shortest digits that read back as the same number.
        let numbers = sample.numbers().into_iter();
        self.record(numbers.map(|number| format!("{number:?}")))
    }

    /// Writes what is still in memory.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(mut self) -> Result<(), Failure> {
        let flushed = self.writer.flush();
        flushed.map_err(|error| self.refuse(error))
    }

    fn record(&mut self, fields: impl Iterator<Item = String>) -> Result<(), Failure> {
        let written = self.writer.write_record(fields);
        written.map_err(|error| self.refuse(error.into()))
    }

    fn refuse(&self, error: std::io::Error) -> Failure {
        Failure::Write {
            target: self.target.clone(),
            error,
        }
    }
}
