//! The trajectory as Parquet: every column as doubles.

use super::accuracy::Accuracy;
use super::columns::Columns;
use super::plan::Plan;
use hamel_console::files::{Draft, Output};
use hamel_console::output::Failure;
use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::{ParquetError, Result as Written};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::FileReader;
use parquet::file::serialized_reader::SerializedFileReader;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::fs::File;
use std::sync::Arc;

/// Numbers kept in memory before they are written as one group of rows: 32 MB.
const MOST_NUMBERS: usize = 4_000_000;

/// Name of the table.
const TABLE: &str = "trajectory";

/// What files tell of their run.
const TOLD: [&str; 3] = ["scene", "form", "method"];

/// The key under which files tell the units and meanings of their columns, as JSON.
const COLUMNS: &str = "columns";

/// The key under which they tell the error of the motion, as `--json` does.
const ERROR: &str = "error";

/// Whether a file is a trajectory that was written before.
pub fn is_own(file: &File) -> bool {
    let reader = file.try_clone().ok().map(SerializedFileReader::new);
    let Some(Ok(reader)) = reader else {
        return false;
    };
    let told = reader.metadata().file_metadata();
    let keys = told.key_value_metadata().into_iter().flatten();
    let keys: Vec<&str> = keys.map(|entry| entry.key.as_str()).collect();
    told.schema().name() == TABLE && TOLD.iter().all(|key| keys.contains(key))
}

/// A Parquet file being written.
pub struct Parquet<'a> {
    writer: SerializedFileWriter<Draft>,
    output: &'a Output,
    columns: Vec<Vec<f64>>,
}

impl<'a> Parquet<'a> {
    /// Begins the file that `plan` asks for, if it asks for one.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn create(plan: &'a Plan, columns: &Columns<'_>) -> Result<Option<Self>, Failure> {
        let Some(output) = &plan.parquet else {
            return Ok(None);
        };
        let writer = writer(output.open()?, plan, columns);
        let writer = writer.map_err(|error| refusal(output, error))?;
        Ok(Some(Self {
            writer,
            output,
            columns: vec![Vec::new(); columns.list().len()],
        }))
    }

    /// Adds a row.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&mut self, row: &[f64]) -> Result<(), Failure> {
        for (column, &number) in self.columns.iter_mut().zip(row) {
            column.push(number);
        }
        let rows = self.columns.first().map_or(0, Vec::len);
        if rows * self.columns.len() >= MOST_NUMBERS {
            return self.flush();
        }
        Ok(())
    }

    /// Writes what is still in memory, and the end of the file with the error of the motion, and gives it its name.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(mut self, accuracy: Option<&Accuracy>) -> Result<(), Failure> {
        self.flush()?;
        if let Some(accuracy) = accuracy {
            let error = serde_json::to_string(accuracy);
            let error = error
                .map_err(|error| refusal(self.output, ParquetError::External(Box::new(error))))?;
            let entry = KeyValue::new(ERROR.to_owned(), error);
            self.writer.append_key_value_metadata(entry);
        }
        let draft = self.writer.into_inner();
        draft.map_err(|error| refusal(self.output, error))?.finish()
    }

    fn flush(&mut self) -> Result<(), Failure> {
        let written = write_group(&mut self.writer, &mut self.columns);
        written.map_err(|error| refusal(self.output, error))
    }
}

fn writer(file: Draft, plan: &Plan, columns: &Columns<'_>) -> Written<SerializedFileWriter<Draft>> {
    let fields: Written<Vec<_>> = columns.names().map(column).collect();
    let schema = Type::group_type_builder(TABLE).with_fields(fields?);
    let values = [
        plan.scene.name.clone(),
        plan.settings.form_name().to_owned(),
        plan.method(),
    ];
    let told = TOLD.into_iter().zip(values);
    let told = told.map(|(key, value)| KeyValue::new(key.to_owned(), value));
    let meanings = serde_json::to_string(columns.list());
    let meanings = meanings.map_err(|error| ParquetError::External(Box::new(error)))?;
    let told = told.chain([KeyValue::new(COLUMNS.to_owned(), meanings)]);
    // Samples hardly repeat: dictionaries would only be tried in vain.
    let properties = WriterProperties::builder()
        .set_dictionary_enabled(false)
        .set_key_value_metadata(Some(told.collect()))
        .build();
    SerializedFileWriter::new(file, Arc::new(schema.build()?), Arc::new(properties))
}

fn column(name: &str) -> Written<Arc<Type>> {
    let column = Type::primitive_type_builder(name, Physical::DOUBLE);
    Ok(Arc::new(
        column.with_repetition(Repetition::REQUIRED).build()?,
    ))
}

fn write_group(writer: &mut SerializedFileWriter<Draft>, columns: &mut [Vec<f64>]) -> Written<()> {
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

fn refusal(output: &Output, error: ParquetError) -> Failure {
    Failure::write(output.path(), std::io::Error::other(error))
}
