//! What a CSV file does not tell of itself: the run, its error, units and meanings of the columns, in a file `NAME.csv-metadata.json` beside it.
//!
//! The layout is that of the W3C recommendation *Metadata Vocabulary for Tabular Data* (2015).

use super::accuracy::Accuracy;
use super::columns::Columns;
use super::plan::Plan;
use hamel_console::files::{Draft, Output, is_stdout};
use hamel_console::output::Failure;
use serde_json::{Value, json};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

/// The vocabulary.
const CONTEXT: &str = "http://www.w3.org/ns/csvw";

/// What wrote the file.
const PROGRAM: &str = "hamel simulate";

/// Files that are larger are not read to see whose they are, bytes.
const LARGEST: u64 = 64 << 20;

/// Whether a file tells of a trajectory that was written before.
pub fn is_own(file: &File) -> bool {
    let found: Result<Value, _> = serde_json::from_reader(BufReader::new(file).take(LARGEST));
    found.is_ok_and(|found| found["@context"] == CONTEXT && found["notes"][0]["program"] == PROGRAM)
}

/// Where that of a CSV file is; `None` beside stdout, a pipe or a device.
pub fn path(csv: &Path) -> Option<PathBuf> {
    let is_file = !is_stdout(csv) && csv.metadata().map_or(true, |found| found.is_file());
    is_file.then(|| {
        let mut name = csv.as_os_str().to_owned();
        name.push("-metadata.json");
        name.into()
    })
}

/// A metadata file that is to be written.
pub struct Metadata<'a> {
    plan: &'a Plan,
    columns: &'a Columns<'a>,
    output: &'a Output,
    draft: Draft,
}

impl<'a> Metadata<'a> {
    /// Begins the file that goes with the CSV file of `plan`, if there is one.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn create(plan: &'a Plan, columns: &'a Columns<'a>) -> Result<Option<Self>, Failure> {
        let Some(output) = &plan.metadata else {
            return Ok(None);
        };
        Ok(Some(Self {
            plan,
            columns,
            output,
            draft: output.open()?,
        }))
    }

    /// Writes it, and gives it its name.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(mut self, accuracy: Option<&Accuracy>) -> Result<(), Failure> {
        let refuse = |error| Failure::write(self.output.path(), std::io::Error::other(error));
        let found = self.found(accuracy);
        let written = serde_json::to_writer_pretty(&mut self.draft, &found);
        written.map_err(refuse)?;
        self.draft.finish()
    }

    fn found(&self, accuracy: Option<&Accuracy>) -> Value {
        let Plan {
            scene, settings, ..
        } = self.plan;
        let csv = self
            .plan
            .csv
            .as_ref()
            .and_then(|csv| csv.path().file_name());
        let columns = self.columns.list().iter().map(|column| {
            json!({
                "titles": column.name,
                "datatype": "double",
                "dc:description": column.meaning,
                "schema:unitText": column.unit,
            })
        });
        json!({
            "@context": CONTEXT,
            "url": csv.map(|name| name.to_string_lossy()),
            "dc:title": scene.name,
            "notes": [{
                "program": PROGRAM,
                "form": settings.form_name(),
                "method": self.plan.method(),
                "reason": self.plan.reason,
                "arithmetic": settings.arithmetic.name(),
                "arithmetic_reason": self.plan.arithmetic_reason,
                "accuracy": self.plan.request,
                "error": accuracy,
            }],
            "tableSchema": { "columns": columns.collect::<Vec<_>>() },
        })
    }
}
