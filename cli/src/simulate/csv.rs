//! The trajectory as CSV: one row a sample, units in the names of the columns.

use super::plan::Plan;
use super::sample::Sample;
use crate::output::Failure;
use std::fs::File;
use std::io::BufWriter;

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

/// Endings of a named frame's columns.
const FRAME_COLUMNS: [&str; 7] = ["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"];

/// Names of the columns: of time, energy, twelve for each body, seven for each named frame, and one for each freedom where there is a controller.
/// [`Sample::numbers`] has the numbers under them.
pub fn columns(plan: &Plan) -> Vec<String> {
    let mechanism = &plan.scene.mechanism;
    let mut names = ["t_s", "energy_J"].map(String::from).to_vec();
    for body in mechanism.bodies() {
        names.extend(COLUMNS.map(|column| format!("{}.{column}", body.name())));
    }
    for frame in mechanism.frames() {
        names.extend(FRAME_COLUMNS.map(|column| format!("{}.{column}", frame.name)));
    }
    let controlled = mechanism.bodies().iter().filter(|_| plan.control.is_some());
    for body in controlled {
        let freedoms = body.joint().freedoms().iter();
        names.extend(freedoms.map(|freedom| format!("{}.tau.{freedom}", body.joint_name())));
    }
    names
}

/// A CSV file being written.
pub struct Trajectory {
    writer: csv::Writer<BufWriter<File>>,
    target: String,
}

impl Trajectory {
    /// Creates the file that `plan` asks for, if it asks for one, with its header row.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn create(plan: &Plan) -> Result<Option<Self>, Failure> {
        let Some(path) = &plan.csv else {
            return Ok(None);
        };
        let target = path.display().to_string();
        let file = File::create(path).map_err(|error| Failure::Write {
            target: target.clone(),
            error,
        })?;
        let writer = csv::Writer::from_writer(BufWriter::new(file));
        let mut trajectory = Self { writer, target };
        trajectory.record(columns(plan).into_iter())?;
        Ok(Some(trajectory))
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
