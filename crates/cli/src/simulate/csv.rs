//! The trajectory as CSV: one row a sample, units in the names of the columns.

use super::plan::Plan;
use super::sample::Sample;
use crate::cells::cell;
use crate::files::{Draft, Output};
use crate::output::Failure;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read};

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

/// How the header of a trajectory begins.
const FIRST: &str = "t_s,energy_J,";

/// Whether a file is a trajectory that was written before, of whatever scene: its columns are those of [`columns`], and no others.
pub fn is_own(mut file: &File) -> bool {
    let mut first = [0; FIRST.len()];
    if file.read_exact(&mut first).is_err() || first != *FIRST.as_bytes() {
        return false;
    }
    let mut reader = csv::Reader::from_reader(BufReader::new(file));
    let names = reader.headers();
    names.is_ok_and(|names| are_columns(&names.iter().collect::<Vec<_>>()))
}

/// Whether these are the columns of bodies, of frames and of efforts, one group after the other.
fn are_columns(mut names: &[&str]) -> bool {
    while let [first, ..] = names {
        let name = first.strip_suffix(COLUMNS[0]).unwrap_or_default();
        let of_group = |columns: &[&str]| {
            let named = names.iter().zip(columns);
            names.len() >= columns.len() && !name.is_empty() && { named }
                .all(|(found, column)| found.strip_prefix(name) == Some(column))
        };
        let count = if of_group(&COLUMNS) {
            COLUMNS.len()
        } else if of_group(&FRAME_COLUMNS) {
            FRAME_COLUMNS.len()
        } else if first.contains(".tau.") {
            1
        } else {
            return false;
        };
        names = &names[count..];
    }
    true
}

/// A CSV file being written.
pub struct Trajectory<'a> {
    writer: csv::Writer<BufWriter<Draft>>,
    output: &'a Output,
}

impl<'a> Trajectory<'a> {
    /// Begins the file that `plan` asks for, if it asks for one, with its header row.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn create(plan: &'a Plan) -> Result<Option<Self>, Failure> {
        let Some(output) = &plan.csv else {
            return Ok(None);
        };
        let writer = csv::Writer::from_writer(BufWriter::new(output.open()?));
        let mut trajectory = Self { writer, output };
        trajectory.record(columns(plan).iter().map(|name| cell(name)))?;
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

    /// Writes what is still in memory, and gives the file its name.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(self) -> Result<(), Failure> {
        let refuse = |error| Failure::write(self.output.path(), error);
        let buffer = self.writer.into_inner();
        let buffer = buffer.map_err(|error| refuse(error.into_error()))?;
        let draft = buffer.into_inner();
        draft.map_err(|error| refuse(error.into_error()))?.finish()
    }

    fn record(&mut self, fields: impl Iterator<Item = String>) -> Result<(), Failure> {
        let written = self.writer.write_record(fields);
        written.map_err(|error| Failure::write(self.output.path(), cause(error)))
    }
}

/// The failure to write that stands behind an error, with its kind: whether the reader has gone is asked later.
fn cause(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    }
}

#[cfg(test)]
mod tests {
    use super::is_own;
    use std::io::{Seek, Write};

    fn is_known(text: &str) -> bool {
        let mut file = tempfile::tempfile().expect("a temporary file");
        file.write_all(text.as_bytes()).expect("it is written");
        file.rewind().expect("it is read");
        is_own(&file)
    }

    #[test]
    fn a_trajectory_is_known_by_its_whole_header() {
        let body = super::COLUMNS
            .map(|column| format!("a.b.{column}"))
            .join(",");
        let frame = super::FRAME_COLUMNS
            .map(|column| format!("tip.{column}"))
            .join(",");
        for own in [
            format!("t_s,energy_J,{body}\n0.0,1.0\n"),
            format!("t_s,energy_J,{body},{body}\n"),
            format!("t_s,energy_J,{body},{frame},\"a,b.tau.q\",elbow.tau.x\n"),
        ] {
            assert!(is_known(&own), "{own}");
        }
        for foreign in [
            String::from("time,x\n0,1\n"),
            String::from("t_s,energy_J2\n"),
            String::from("t_s,energy_J,mine\n0,1,2\n"),
            format!("t_s,energy_J,{body},mine\n"),
            format!("t_s,energy_J,mine,{body}\n"),
            format!("t_s,energy_J,{}\n", &body[..body.len() - 1]),
        ] {
            assert!(!is_known(&foreign), "{foreign}");
        }
    }
}
