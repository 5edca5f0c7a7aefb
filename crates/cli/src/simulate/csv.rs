//! The trajectory as CSV: one row per sample, units in the names of the columns.

use super::columns::{Columns, are_columns};
use super::plan::Plan;
use hamel_console::cells::cell;
use hamel_console::files::{Draft, Output};
use hamel_console::output::Failure;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read};

/// How the header of a trajectory begins.
const FIRST: &str = "t_s,energy_J,";

/// Whether a file is a trajectory that was written before, of whatever scene: its columns are those of [`Columns`], and no others.
pub fn is_own(mut file: &File) -> bool {
    let mut first = [0; FIRST.len()];
    if file.read_exact(&mut first).is_err() || first != *FIRST.as_bytes() {
        return false;
    }
    let mut reader = csv::Reader::from_reader(BufReader::new(file));
    let Ok(rest) = reader.headers() else {
        return false;
    };
    let names = FIRST.split_terminator(',').chain(rest);
    are_columns(&names.collect::<Vec<_>>())
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
    pub fn create(plan: &'a Plan, columns: &Columns<'_>) -> Result<Option<Self>, Failure> {
        let Some(output) = &plan.csv else {
            return Ok(None);
        };
        let writer = csv::Writer::from_writer(BufWriter::new(output.open()?));
        let mut trajectory = Self { writer, output };
        trajectory.record(columns.names().map(cell))?;
        Ok(Some(trajectory))
    }

    /// Adds a row.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&mut self, row: &[f64]) -> Result<(), Failure> {
        // The shortest digits that read back as the same number.
        self.record(row.iter().map(|number| format!("{number:?}")))
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
        let of = |owner: &str, ends: &str| {
            let names = ends.split(' ').map(|end| format!("{owner}{end}"));
            names.collect::<Vec<_>>().join(",")
        };
        let body = of(
            "a.b.",
            "x_m y_m z_m qx qy qz qw vx_m_per_s vy_m_per_s vz_m_per_s wx_rad_per_s wy_rad_per_s wz_rad_per_s",
        );
        let frame = of("tip.", "x_m y_m z_m qx qy qz qw");
        let older = of(
            "a.b.",
            "x_m y_m z_m rx_rad ry_rad rz_rad vx_m_per_s vy_m_per_s vz_m_per_s wx_rad_per_s wy_rad_per_s wz_rad_per_s",
        );
        let older_frame = of("tip.", "x_m y_m z_m qw qx qy qz");
        let head = "t_s,energy_J,kinetic_energy_J,potential_energy_J";
        for own in [
            format!("{head},{body}\n0.0,1.0\n"),
            format!("{head},{body},{body}\n"),
            format!("{head},{body},{frame},\"a,b.q.x_m\",elbow.v.x_m_per_s,elbow.tau.x_N\n"),
            format!("t_s,energy_J,{older},{older}\n0.0,1.0\n"),
            format!("t_s,energy_J,{older},{older_frame},elbow.tau.x\n"),
        ] {
            assert!(is_known(&own), "{own}");
        }
        for foreign in [
            String::from("time,x\n0,1\n"),
            String::from("t_s,energy_J2\n"),
            String::from("t_s,energy_J,mine\n0,1,2\n"),
            format!("{head},{body},mine\n"),
            format!("{head},mine,{body}\n"),
            format!("{head},{}\n", of("", "x_m y_m z_m qx qy qz qw")),
            format!("{head},{}\n", &body[..body.len() - 1]),
        ] {
            assert!(!is_known(&foreign), "{foreign}");
        }
    }
}
