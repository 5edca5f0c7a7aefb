//! The trajectory as Parquet: the columns of the CSV, then energies and the joints' own state, all as doubles.

use super::csv::columns;
use super::plan::Plan;
use super::sample::Sample;
use crate::output::Failure;
use hamel::integrate::Step;
use hamel::mechanism::Kinematics;
use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::{ParquetError, Result as Written};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

/// Numbers kept in memory before they are written as one group of rows: 32 MB.
const MOST_NUMBERS: usize = 4_000_000;

/// A Parquet file being written.
pub struct Parquet {
    writer: SerializedFileWriter<File>,
    target: String,
    columns: Vec<Vec<f64>>,
}

impl Parquet {
    /// Creates the file that `plan` asks for, if it asks for one.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn create(plan: &Plan) -> Result<Option<Self>, Failure> {
        let Some(path) = &plan.parquet else {
            return Ok(None);
        };
        let target = path.display().to_string();
        let names = names(plan);
        let columns = vec![Vec::new(); names.len()];
        let writer = writer(path, plan, names).map_err(|error| refusal(&target, error))?;
        Ok(Some(Self {
            writer,
            target,
            columns,
        }))
    }

    /// Adds a row.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(
        &mut self,
        sample: &Sample<'_>,
        step: &Step<'_>,
        kinematics: &Kinematics,
    ) -> Result<(), Failure> {
        let energies = [kinematics.kinetic_energy(), kinematics.potential_energy()];
        let joints = step.configuration.iter().chain(step.speeds).copied();
        let row = sample.numbers().into_iter().chain(energies).chain(joints);
        for (column, number) in self.columns.iter_mut().zip(row) {
            column.push(number);
        }
        let rows = self.columns.first().map_or(0, Vec::len);
        if rows * self.columns.len() >= MOST_NUMBERS {
            return self.flush();
        }
        Ok(())
    }

    /// Writes what is still in memory, and the end of the file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(mut self) -> Result<(), Failure> {
        self.flush()?;
        let closed = self.writer.close();
        closed.map_or_else(|error| Err(refusal(&self.target, error)), |_| Ok(()))
    }

    fn flush(&mut self) -> Result<(), Failure> {
        let written = write_group(&mut self.writer, &mut self.columns);
        written.map_err(|error| refusal(&self.target, error))
    }
}

fn writer(path: &Path, plan: &Plan, names: Vec<String>) -> Written<SerializedFileWriter<File>> {
    let fields: Written<Vec<_>> = names.iter().map(|name| column(name)).collect();
    let schema = Type::group_type_builder("trajectory").with_fields(fields?);
    let told = [
        ("scene", plan.scene.name.clone()),
        ("form", plan.settings.form_name().to_owned()),
        ("method", plan.method()),
    ];
    let told = told.map(|(key, value)| KeyValue::new(key.to_owned(), value));
    // Samples hardly repeat: dictionaries would only be tried in vain.
    let properties = WriterProperties::builder()
        .set_dictionary_enabled(false)
        .set_key_value_metadata(Some(told.into()))
        .build();
    SerializedFileWriter::new(
        File::create(path)?,
        Arc::new(schema.build()?),
        Arc::new(properties),
    )
}

fn column(name: &str) -> Written<Arc<Type>> {
    let column = Type::primitive_type_builder(name, Physical::DOUBLE);
    Ok(Arc::new(
        column.with_repetition(Repetition::REQUIRED).build()?,
    ))
}

fn write_group(writer: &mut SerializedFileWriter<File>, columns: &mut [Vec<f64>]) -> Written<()> {
    let mut group = writer.next_row_group()?;
    for column in columns {
        if let Some(mut writer) = group.next_column()? {
            writer
                .typed::<DoubleType>()
                .write_batch(column, None, None)?;
            writer.close()?;
        }
        column.clear();
    }
    group.close()?;
    Ok(())
}

/// `t_s` and the other columns of the CSV, energies, `JOINT.q.NAME` for every stored scalar, `JOINT.v.NAME` for every speed.
fn names(plan: &Plan) -> Vec<String> {
    let bodies = plan.scene.mechanism.bodies();
    let mut names = columns(plan);
    names.extend(["kinetic_energy_J", "potential_energy_J"].map(String::from));
    for body in bodies {
        let scalars = body.joint().coordinates().iter();
        names.extend(scalars.map(|scalar| format!("{}.q.{scalar}", body.joint_name())));
    }
    for body in bodies {
        let speeds = body.joint().speeds().iter();
        names.extend(speeds.map(|speed| format!("{}.v.{speed}", body.joint_name())));
    }
    names
}

fn refusal(target: &str, error: ParquetError) -> Failure {
    Failure::Write {
        target: target.to_owned(),
        error: std::io::Error::other(error),
    }
}
